// One tet of a law: its energy, gradient and Hessian by vertex, for tests of laws; and the trusted values to compare
// with.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/elastic_point.h"
#include "solver/material/principal.h"
#include "tests/support/solver_scenes.h"

#include <Eigen/Core>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

namespace sinew::test {

using Row3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Vec12 = Eigen::Matrix<double, 12, 1>;
using Mat12 = Eigen::Matrix<double, 12, 12>;

inline Row3 matrix(const nlohmann::json& j) {
    Row3 m;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) m(r, c) = j[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
    return m;
}

/// The identity plus normally distributed entries.
inline Row3 random_matrix(std::mt19937& random, double spread) {
    std::normal_distribution<double> normal;
    Row3 f = Row3::Identity();
    for (int i = 0; i < 9; ++i) f(i) += spread * normal(random);
    return f;
}

/// A slightly irregular tet (all lanes the same), E = 1000 Pa, nu = 0.3; for the anisotropic law with `transverse`
/// stiffness across a slanted direction.
struct OneTet {
    solver::ElasticLaw law;
    solver::TetMesh mesh = irregular();
    solver::TetBatch batch = solver::make_batches(mesh, 0).front();
    solver::TetModuli moduli{};
    solver::Anisotropy anisotropy{};

    OneTet(solver::ElasticLaw law, double compression, double transverse = 1)
        : law(law) {
        const solver::Lame l = solver::lame(1000, 0.3);
        const solver::Vec3 a = solver::Vec3(1, 2, -0.5).normalized();
        for (int i = 0; i < solver::lanes; ++i) {
            moduli.mu[i] = l.mu, moduli.lambda[i] = l.lambda, moduli.compression[i] = compression;
            anisotropy.root[i] = std::pow(transverse, 0.25);
            for (int c = 0; c < 3; ++c) anisotropy.direction[c][i] = a[c];
        }
    }
    double energy(const Vec12& x) const {
        Vec12 unused;
        return evaluate(x, unused);
    }
    Vec12 gradient(const Vec12& x) const {
        Vec12 g;
        evaluate(x, g);
        return g;
    }
    Mat12 hessian(const Vec12& x, bool project) const {
        using solver::block_pairs;
        double h[10][9][solver::lanes];
        solver::point_hessian(inputs(), solver::corners_of(batch, x.data()), project, &h[0][0][0]);
        Mat12 out;
        for (int b = 0; b < 10; ++b)
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) {
                    const int i = 3 * batch.vertex[block_pairs[b][0]][0] + r,
                              j = 3 * batch.vertex[block_pairs[b][1]][0] + c;
                    out(i, j) = out(j, i) = h[b][3 * r + c][0];
                }
        return out;
    }
    /// Vertex positions for a deformation gradient.
    Vec12 positions(const Row3& f) const {
        Vec12 x;
        for (int v = 0; v < 4; ++v) x.segment<3>(3 * v) = f * mesh.vertices[static_cast<std::size_t>(v)];
        return x;
    }

  private:
    static solver::TetMesh irregular() {
        solver::TetMesh mesh = regular_tet(0.7);
        mesh.vertices[0] += solver::Vec3(0.1, -0.05, 0.02);
        return mesh;
    }
    solver::PointInputs inputs() const {
        solver::PointInputs in{law, batch, moduli};
        in.anisotropy = &anisotropy;
        return in;
    }
    double evaluate(const Vec12& x, Vec12& gradient) const {
        double g[4][3][solver::lanes];
        solver::ElementSummary summary;
        solver::point_gradient(inputs(), solver::corners_of(batch, x.data()), &g[0][0][0], summary);
        for (int a = 0; a < 4; ++a)
            for (int c = 0; c < 3; ++c) gradient[3 * batch.vertex[a][0] + c] = g[a][c][0];
        return summary.energy[0];
    }
};

} // namespace sinew::test
