// Triangles of a mesh that cross or overlap each other, exactly.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/mesh_check.h"

namespace sinew::solver {

/// Pairs of triangles (by number, the lower first) that have more in common than the corners and edges that
/// they share; vertices at the same place count as shared. Triangles without area and pairs with three common
/// corners are left to check_mesh. By exact predicates: no tolerance. Indices must be in range.
Flaw self_intersections(const Points& points, const std::vector<Triangle>& triangles);

/// All that check_mesh finds, and crossing_triangles. Throws Error FE203 (index), FE202 (not finite).
MeshCheck inspect_mesh(const Points& points, const std::vector<Triangle>& triangles);

} // namespace sinew::solver
