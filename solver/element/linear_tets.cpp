// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/linear_tets.h"

#include "solver/element/svd3.h"
#include "solver/element/symmetric3.h"
#include "solver/error.h"
#include "solver/material/corotational.h"
#include "solver/material/neo_hookean.h"
#include "solver/material/stvk.h"

#include <Eigen/LU>
#include <algorithm>
#include <string>

namespace sinew::solver {

namespace {

template <class R>
void evaluate_law(ElasticLaw law, const R* s, R mu, R lambda, R compression, Principal<R>& out) {
    switch (law) {
    case ElasticLaw::stvk:
        stvk(s, mu, lambda, out);
        add_compression_resistance(s, compression, out);
        break;
    case ElasticLaw::neo_hookean:
        neo_hookean(s, mu, lambda, out);
        add_compression_resistance(s, compression, out);
        break;
    case ElasticLaw::corotational: corotational(s, mu, lambda, out); break;
    }
}

/// out = U diag(d) V^T
template <class R> void recompose(const R* u, const R* d, const R* v, R* out) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out[3 * i + j] =
                u[3 * i] * d[0] * v[3 * j] + u[3 * i + 1] * d[1] * v[3 * j + 1] + u[3 * i + 2] * d[2] * v[3 * j + 2];
}

template <class R> R determinant(const R* f) {
    return f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) +
           f[2] * (f[3] * f[7] - f[4] * f[6]);
}

/// out = U k U^T
void rotate_block(const Pack* u, const Pack* k, Pack* out) {
    Pack uk[9];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            uk[3 * i + j] = u[3 * i] * k[j] + u[3 * i + 1] * k[3 + j] + u[3 * i + 2] * k[6 + j];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out[3 * i + j] = uk[3 * i] * u[3 * j] + uk[3 * i + 1] * u[3 * j + 1] + uk[3 * i + 2] * u[3 * j + 2];
}

} // namespace

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

void deformation_gradient(const TetBatch& batch, const double* x, Pack* f) {
    Pack edge[3][3]; // edge[a][component] = x_{a+1} - x_0
    for (int c = 0; c < 3; ++c) {
        double p[4][lanes];
        for (int a = 0; a < 4; ++a)
            for (int l = 0; l < lanes; ++l)
                p[a][l] = x[3 * static_cast<std::size_t>(batch.vertex[a][l]) + static_cast<std::size_t>(c)];
        for (int a = 0; a < 3; ++a) edge[a][c] = Pack::load(p[a + 1]) - Pack::load(p[0]);
    }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            f[3 * i + j] = edge[0][i] * Pack::load(batch.shape[j]) + edge[1][i] * Pack::load(batch.shape[3 + j]) +
                           edge[2][i] * Pack::load(batch.shape[6 + j]);
}

void elastic_gradient(ElasticLaw law, const TetBatch& batch, const TetModuli& moduli, const double* x,
                      TetGradient& out) {
    Pack f[9];
    deformation_gradient(batch, x, f);
    Svd3<Pack> svd;
    svd3(f, svd);
    Principal<Pack> law_values;
    evaluate_law(law, svd.s, Pack::load(moduli.mu), Pack::load(moduli.lambda), Pack::load(moduli.compression),
                 law_values);
    const Pack volume = Pack::load(batch.volume);
    (law_values.energy * volume).store(out.energy);
    determinant(f).store(out.j);
    Pack(0.0).store(out.fiber_squares);
    Pack p[9];
    recompose(svd.u, law_values.first, svd.v, p);
    for (int c = 0; c < 3; ++c) {
        Pack sum(0.0);
        for (int a = 1; a < 4; ++a) {
            const Pack g = volume * (p[3 * c] * Pack::load(batch.shape[3 * (a - 1)]) +
                                     p[3 * c + 1] * Pack::load(batch.shape[3 * (a - 1) + 1]) +
                                     p[3 * c + 2] * Pack::load(batch.shape[3 * (a - 1) + 2]));
            g.store(out.g[a][c]);
            sum += g;
        }
        (-sum).store(out.g[0][c]);
    }
}

void elastic_hessian(ElasticLaw law, const TetBatch& batch, const TetModuli& moduli, const double* x, bool project,
                     TetHessian& out) {
    Pack f[9];
    deformation_gradient(batch, x, f);
    Svd3<Pack> svd;
    svd3(f, svd);
    Principal<Pack> q;
    evaluate_law(law, svd.s, Pack::load(moduli.mu), Pack::load(moduli.lambda), Pack::load(moduli.compression), q);
    if (project) {
        clamp_symmetric3(q.diagonal, q.off_diagonal);
        for (int k = 0; k < 3; ++k) {
            q.flip[k] = max(q.flip[k], Pack(0.0));
            q.twist[k] = max(q.twist[k], Pack(0.0));
        }
    }
    const Pack volume = Pack::load(batch.volume);
    // In the frame of U and V: same[k] on (dF_ij)^2 and (dF_ji)^2, cross[k] on dF_ij dF_ji, pair k = (i, j).
    Pack same[3], cross[3];
    for (int k = 0; k < 3; ++k) {
        same[k] = Pack(0.5) * volume * (q.flip[k] + q.twist[k]);
        cross[k] = Pack(0.5) * volume * (q.flip[k] - q.twist[k]);
        q.diagonal[k] *= volume;
        q.off_diagonal[k] *= volume;
    }
    Pack n[3][3]; // V^T grad N_a
    for (int a = 0; a < 3; ++a)
        for (int i = 0; i < 3; ++i)
            n[a][i] = svd.v[i] * Pack::load(batch.shape[3 * a]) + svd.v[3 + i] * Pack::load(batch.shape[3 * a + 1]) +
                      svd.v[6 + i] * Pack::load(batch.shape[3 * a + 2]);
    Pack block[3][3][9]; // of vertices a+1 <= b+1
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) {
            Pack k[9];
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3, m = (i + 2) % 3;
                k[4 * i] = q.diagonal[i] * n[a][i] * n[b][i] + same[m] * n[a][j] * n[b][j] + same[j] * n[a][m] * n[b][m];
                k[3 * j + m] = q.off_diagonal[i] * n[a][j] * n[b][m] + cross[i] * n[a][m] * n[b][j];
                k[3 * m + j] = q.off_diagonal[i] * n[a][m] * n[b][j] + cross[i] * n[a][j] * n[b][m];
            }
            rotate_block(svd.u, k, block[a][b]);
        }
    // Shape functions sum to one, so every row of blocks sums to zero: blocks with vertex 0 follow from the others.
    const auto entry = [&](int a, int b, int r, int c) { return a <= b ? block[a][b][3 * r + c] : block[b][a][3 * c + r]; };
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            Pack corner(0.0);
            for (int b = 0; b < 3; ++b) {
                const Pack sum = entry(0, b, r, c) + entry(1, b, r, c) + entry(2, b, r, c);
                (-sum).store(out.h[1 + b][3 * r + c]);
                corner += sum;
            }
            corner.store(out.h[0][3 * r + c]);
            int index = 4;
            for (int a = 0; a < 3; ++a)
                for (int b = a; b < 3; ++b) block[a][b][3 * r + c].store(out.h[index++][3 * r + c]);
        }
}

void elastic_stress(ElasticLaw law, double mu, double lambda, double compression, const double* f, double* p,
                    double* energy) {
    Svd3<double> svd;
    svd3(f, svd);
    Principal<double> q{};
    evaluate_law(law, svd.s, mu, lambda, compression, q);
    recompose(svd.u, q.first, svd.v, p);
    *energy = q.energy;
}

} // namespace sinew::solver
