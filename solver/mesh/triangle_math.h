// Closest point on one triangle and solid angle of one triangle.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

namespace sinew::solver {

struct TrianglePoint {
    Vec3 point, barycentric;
};

/// Closest point of the triangle with corners `c` to p. Corners and edges are computed in the order of the
/// corners' numbers `id`, so that triangles which share them find the same point to the last bit. Degenerate
/// triangles count as their edges.
TrianglePoint closest_on_triangle(const Vec3& p, const std::array<Vec3, 3>& c, const Triangle& id);

/// Signed solid angle [sr] under which the triangle is seen from p; positive from behind (inside an outward
/// oriented surface), 4 pi summed over a closed surface around p. Van Oosterom & Strackee 1983. 0 in the
/// triangle's plane.
double solid_angle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

} // namespace sinew::solver
