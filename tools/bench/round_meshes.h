// Tets that fill balls and shells, in six blocks about the middle as on the faces of a cube: as symmetric as tets can
// be, with their outer vertices on the sphere.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

namespace sinew::bench {

/// Between two radii [m], about the origin: n x n cells on each of the six faces, `layers` across; 6 tets a cell.
solver::TetMesh shell_mesh(double inner, double outer, int n, int layers);
/// A ball about the origin: a cube of n cells a side in its middle, `layers` of cells around it.
solver::TetMesh ball_mesh(double radius, int n, int layers);

} // namespace sinew::bench
