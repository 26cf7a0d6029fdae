// Boxes and other images of a grid of cubes, cut into tets: the meshes that benchmarks and references share.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

#include <functional>

namespace sinew::solver {

/// nx x ny x nz cubes over the unit cube, each cut along its long diagonal into six Kuhn tets; each point is taken to
/// where `place` puts it, which must keep orientation. Vertices by x, then y, then z; coverage 1.
TetMesh kuhn_mesh(int nx, int ny, int nz, const std::function<Vec3(double, double, double)>& place);

} // namespace sinew::solver
