// Energy of a point that presses into a surface: 1/2 k A d^2, d its distance to the nearest place q of one triangle.
// Corner 0 is the point, 1 to 3 the triangle's. As q is nearest, the gradient is k A d's as if q were fixed on the
// triangle: k A L_c (p - q) with L = (1, -b_1, -b_2, -b_3), so forces and moments balance exactly.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/overlay.h"

namespace sinew::solver {

using PointTriangleBlocks = Overlay::Blocks;

/// L of the place q.
inline std::array<double, 4> corner_weights_of(const Vec3& place) { return {1, -place[0], -place[1], -place[2]}; }

/// Adds the form (sum of L_c u_c)^T m (sum of L_c u_c), m symmetric.
void add_square(const Vec3& place, const Mat3& m, PointTriangleBlocks& blocks);

/// Second derivatives of d^2/2. `place`: barycentric coordinates of q, zeros on edges and vertices; `away` = p - q.
/// `project`: without the part that bends, which leaves a positive semi-definite matrix.
///
/// With q = q(s) of one or two coordinates s along the feature (none at a vertex) and f = |p - q(s)|^2/2, the Hessian
/// of the minimum is f_xx - f_xs f_ss^-1 f_sx.
PointTriangleBlocks point_triangle_hessian(const std::array<Vec3, 3>& corners, const Vec3& place, const Vec3& away,
                                           bool project);

} // namespace sinew::solver
