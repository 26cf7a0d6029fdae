// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/tet_batch.h"

#include "solver/error.h"

#include <Eigen/LU>
#include <algorithm>
#include <string>

namespace sinew::solver {

std::vector<TetBatch> make_batches(const TetMesh& mesh, int first_vertex) {
    std::vector<TetBatch> batches((mesh.tets.size() + lanes - 1) / lanes);
    for (std::size_t slot = 0; slot < batches.size() * lanes; ++slot) {
        const bool padding = slot >= mesh.tets.size();
        const std::size_t t = padding ? mesh.tets.size() - 1 : slot;
        TetBatch& batch = batches[slot / lanes];
        const std::size_t lane = slot % lanes;
        const Tet& tet = mesh.tets[t];
        Mat3 edges;
        for (int a = 0; a < 4; ++a) batch.vertex[a][lane] = first_vertex + tet[static_cast<std::size_t>(a)];
        const Vec3& x0 = mesh.vertices[static_cast<std::size_t>(tet[0])];
        for (int a = 1; a < 4; ++a)
            edges.col(a - 1) = mesh.vertices[static_cast<std::size_t>(tet[static_cast<std::size_t>(a)])] - x0;
        const double volume = edges.determinant() / 6;
        if (!(volume > 0))
            throw Error("FE215", "tet " + std::to_string(t) + " has volume " + std::to_string(volume),
                        "every tet needs a positive volume at rest");
        const Mat3 inverse = edges.inverse();
        for (int i = 0; i < 9; ++i) batch.shape[i][lane] = inverse(i / 3, i % 3);
        const double coverage = mesh.coverage.empty() ? 1.0 : std::max(mesh.coverage[t], least_coverage);
        batch.volume[lane] = padding ? 0.0 : volume * coverage;
    }
    return batches;
}

Corners corners_of(const TetBatch& batch, const double* x) {
    Corners out;
    for (std::size_t c = 0; c < 3; ++c)
        for (int a = 0; a < 4; ++a) {
            double p[lanes];
            for (int l = 0; l < lanes; ++l) p[l] = x[3 * static_cast<std::size_t>(batch.vertex[a][l]) + c];
            out.y[a][c] = Pack::load(p);
        }
    return out;
}

void deformation_gradient(const TetBatch& batch, const Corners& corners, Pack* f) {
    Pack edge[3][3]; // edge[a][component] = x_{a+1} - x_0
    for (int a = 0; a < 3; ++a)
        for (int c = 0; c < 3; ++c) edge[a][c] = corners.y[a + 1][c] - corners.y[0][c];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            f[3 * i + j] = edge[0][i] * Pack::load(batch.shape[j]) + edge[1][i] * Pack::load(batch.shape[3 + j]) +
                           edge[2][i] * Pack::load(batch.shape[6 + j]);
}

} // namespace sinew::solver
