// Tets in structure-of-arrays batches: their corners and rest shapes, which linear and quadratic tets share.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"
#include "solver/simd.h"

#include <vector>

namespace sinew::solver {

/// `lanes` tets. Padding lanes repeat a real tet with volume 0.
struct TetBatch {
    int vertex[4][lanes];
    double shape[9][lanes]; ///< row a-1 is the gradient of barycentric coordinate a = 1…3 at rest [1/m]; row-major
    double volume[lanes];   ///< rest volume x coverage [m^3]
};

/// Local 3x3 blocks (a, b) with a <= b of a linear tet's 12x12 Hessian, in this order.
inline constexpr int block_pairs[10][2] = {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1},
                                           {1, 2}, {1, 3}, {2, 2}, {2, 3}, {3, 3}};

/// Tets with less of their volume inside the solid than this count as this much, so that no vertex floats free.
inline constexpr double least_coverage = 1e-3;

/// Batches of a tissue; vertex numbers are `first_vertex` + the mesh's own. Throws Error FE215 for zero volume.
std::vector<TetBatch> make_batches(const TetMesh& mesh, int first_vertex);

/// Corner positions of a batch's tets [m].
struct Corners {
    Pack y[4][3];
};
/// From positions x (3 numbers a vertex).
Corners corners_of(const TetBatch& batch, const double* x);

/// Deformation gradient F (row-major) of the linear map from the rest shape to these corners.
void deformation_gradient(const TetBatch& batch, const Corners& corners, Pack* f);

} // namespace sinew::solver
