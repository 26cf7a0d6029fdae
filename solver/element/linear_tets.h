// Linear (P1) tetrahedra in structure-of-arrays batches: deformation gradients, and from any law in principal
// stretches the energy, gradient and Hessian of a batch in closed form.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"
#include "solver/scene.h"
#include "solver/simd.h"

#include <vector>

namespace sinew::solver {

/// `lanes` tets. Padding lanes repeat a real tet with volume 0.
struct TetBatch {
    int vertex[4][lanes];
    double shape[9][lanes]; ///< row a-1 is the gradient of shape function a = 1…3 at rest [1/m]; row-major
    double volume[lanes];   ///< rest volume x coverage [m^3]
};

/// Moduli of a batch's tets.
struct TetModuli {
    double mu[lanes], lambda[lanes], compression[lanes]; ///< [Pa]
};

/// Local 3x3 blocks (a, b) with a <= b of an element's 12x12 Hessian, in this order.
inline constexpr int block_pairs[10][2] = {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1},
                                           {1, 2}, {1, 3}, {2, 2}, {2, 3}, {3, 3}};

/// What one batch contributes; `hessian[block][row*3+col][lane]`.
struct TetGradient {
    double g[4][3][lanes]; ///< dE/dx [N]
    double energy[lanes];  ///< [J]
    double j[lanes];       ///< det F
    double fiber_squares[lanes]; ///< sum of squared fibre forces [N^2]: they may cancel the elastic ones within a tet
};
struct TetHessian {
    double h[10][9][lanes]; ///< [N/m]
};

/// Tets with less of their volume inside the solid than this count as this much, so that no vertex floats free.
inline constexpr double least_coverage = 1e-3;

/// Batches of a tissue; vertex numbers are `first_vertex` + the mesh's own. Throws Error FE215 for zero volume.
std::vector<TetBatch> make_batches(const TetMesh& mesh, int first_vertex);

/// Deformation gradient F (row-major) of a batch at positions x (3 numbers a vertex).
void deformation_gradient(const TetBatch& batch, const double* x, Pack* f);

void elastic_gradient(ElasticLaw law, const TetBatch& batch, const TetModuli& moduli, const double* x,
                      TetGradient& out);
/// \param project clamp the eigenvalues at zero (positive semi-definite); false = the exact Hessian
void elastic_hessian(ElasticLaw law, const TetBatch& batch, const TetModuli& moduli, const double* x, bool project,
                     TetHessian& out);

/// First Piola-Kirchhoff stress and energy density of one deformation gradient (row-major), for tests and users.
void elastic_stress(ElasticLaw law, double mu, double lambda, double compression, const double* f, double* p,
                    double* energy);

} // namespace sinew::solver
