// How far out points may lie.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

namespace sinew::solver {

/// No coordinate may be larger: squares, volumes and the fields of far triangles stay finite below it.
inline constexpr double largest_coordinate = 1e60;

/// False for a point that is not finite, too.
inline bool is_within_reach(const Vec3& p) { return p.cwiseAbs().maxCoeff() <= largest_coordinate && p.allFinite(); }

/// Throws Error FE202 (not finite) or FE224 (beyond largest_coordinate), naming the vertex.
void check_coordinates(const Points& points);

} // namespace sinew::solver
