// Triangles of a mesh that cross or overlap each other, exactly.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/mesh_check.h"

#include <cstddef>
#include <functional>
#include <limits>

namespace sinew::solver {

/// Pairs of triangles (by number, the lower first) that have more in common than the corners and edges that
/// they share; vertices at the same place count as shared. Triangles without area and pairs with three common
/// corners are left to check_mesh. By exact predicates: no tolerance. Indices must be in range.
/// \param stop true throws Stopped
/// \param most_pairs of triangles whose boxes overlap are looked at; where there are more the flaw is not whole
Flaw self_intersections(const Points& points, const std::vector<Triangle>& triangles,
                        const std::function<bool()>& stop = {},
                        std::size_t most_pairs = std::numeric_limits<std::size_t>::max());

/// All that check_mesh finds, crossing_triangles (whole but for fans of thousands of triangles around one corner) and
/// encloses. Throws Error FE203 (index), FE202 (not finite).
MeshCheck inspect_mesh(const Points& points, const std::vector<Triangle>& triangles);

} // namespace sinew::solver
