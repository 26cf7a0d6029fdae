// How good the shapes of tets are.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

namespace sinew::solver {

/// Mean ratio 12 (3 V)^(2/3) / (sum of squared edges), Liu & Joe 1994: 1 for a regular tet, 0 for a flat one,
/// -1 for one that is turned inside out.
double tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Smallest and largest dihedral angle of a tet in degrees.
std::array<double, 2> dihedral_range(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// The same over all tets of a mesh; {180, 0} without tets.
std::array<double, 2> dihedral_range(const TetMesh& mesh);

} // namespace sinew::solver
