// Triangulation of one polygon: a fan where it is convex, ear clipping where it is not.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <span>
#include <vector>

namespace sinew::solver {

/// Cutting ears off takes the square of it.
inline constexpr std::size_t most_clipped_corners = 50000;

/// Appends corners.size() - 2 triangles with the polygon's orientation to `out`. Corners index `points`. The
/// polygon is judged in the plane of its mean normal (Newell), so it may be slightly warped; one that crosses
/// itself gives some triangulation of the right count. A convex polygon is a fan from its first corner. Throws Error
/// FE208 for one that is not convex and has more than most_clipped_corners, which would take too long.
void triangulate_polygon(const Points& points, std::span<const int> corners, std::vector<Triangle>& out);

} // namespace sinew::solver
