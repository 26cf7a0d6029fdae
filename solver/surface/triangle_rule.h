// Integration over triangles: points with positive weights, inside.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <span>

namespace sinew::solver {

struct RulePoint {
    Vec3 place;   ///< barycentric coordinates
    double share; ///< of the triangle's area
};

/// 1, 3, 6 or 7 points: exact for polynomials up to degree 1, 2, 4 or 5 (Strang and Fix 1973; Radon 1948), the lowest
/// of these that reaches `degree`, which is at most 5.
std::span<const RulePoint> triangle_rule(int degree);

} // namespace sinew::solver
