// Share of a tet inside any surface, with holes and overlaps, by subdivision.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/solid.h"

namespace sinew::solver {

/// Share of the tet inside the solid, from values at 165 points: 512 small tets, each cut by the linear
/// interpolation of the signed distance near the surface, and of the winding number where a hole is closed.
/// Second order in the tet's size where the border is smooth.
/// \param is_near whether the surface touches the tet; if not, only the winding number is asked
double quadrature_share(const Solid& solid, const std::array<Vec3, 4>& corners, bool is_near);

/// Share of a tet on which a linear function with these corner values is positive.
double positive_share(const std::array<double, 4>& values);

} // namespace sinew::solver
