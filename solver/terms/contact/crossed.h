// Whether a point goes through a triangle, or an edge through an edge, where all corners move straight from one place
// to another.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

namespace sinew::solver {

/// `from` and `to`: of the point and the triangle's corners. What starts or ends in the plane does not go through it.
bool crosses_face(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to);
/// Likewise of the ends of two edges.
bool crosses_edge(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to);

} // namespace sinew::solver
