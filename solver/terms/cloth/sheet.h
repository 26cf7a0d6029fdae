// What follows from a cloth's mesh alone: who lies beside whom, and which way its warp runs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"

#include <array>
#include <vector>

namespace sinew::solver {

/// Per triangle and corner: the vertex of its neighbour across the edge that lies across from the corner; -1: the edge
/// is free. Edges must not have more than two triangles.
std::vector<std::array<int, 3>> across_from(const std::vector<Triangle>& triangles);

/// A unit vector in the plane of each triangle: `direction`, projected onto it. Where that is square to the triangle,
/// the next axis of space is projected in its place (x, y, z and round). Zero for triangles without area.
Points warp_directions(const Points& points, const std::vector<Triangle>& triangles, const Vec3& direction);

} // namespace sinew::solver
