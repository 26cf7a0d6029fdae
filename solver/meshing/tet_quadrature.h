// Share of a tet inside any surface, with holes and overlaps, by subdivision.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_moments.h"
#include "solver/meshing/solid.h"

namespace sinew::solver {

/// Share of the tet inside the solid, from values at 165 points: 512 small tets, each cut by the linear
/// interpolation of the signed distance near the surface, and of the winding number where a hole is closed.
/// Second order in the tet's size where the border is smooth.
/// \param is_near whether the surface touches the tet; if not, only the winding number is asked
/// \param moments where wanted, takes those of the same pieces; they start at zero
double quadrature_share(const Solid& solid, const std::array<Vec3, 4>& corners, bool is_near,
                        TetMoments* moments = nullptr);

/// Share of a tet on which a linear function with these corner values is positive.
double positive_share(const std::array<double, 4>& values);
/// Adds the moments of that part; `corners` in the coordinates of the moments, `volume` that of the whole.
void add_positive_part(const std::array<double, 4>& values, const std::array<Barycentric, 4>& corners, double volume,
                       TetMoments& moments);

} // namespace sinew::solver
