// The singular value decomposition under every law: accuracy on random, graded, singular and inverted matrices.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/svd3.h"
#include "solver/element/symmetric3.h"
#include "solver/types.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>

using namespace sinew::solver;
using Row3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

namespace {

/// Worst of |U S V^T - F| / |F|, |U^T U - I|, |V^T V - I|, |det - 1|.
double defect(const Row3& f) {
    Svd3<double> out;
    svd3(f.data(), out);
    const Row3 u = Eigen::Map<const Row3>(out.u), v = Eigen::Map<const Row3>(out.v);
    const Row3 s = Vec3(out.s[0], out.s[1], out.s[2]).asDiagonal();
    const double scale = std::max(f.norm(), 1e-300);
    return std::max({(u * s * v.transpose() - f).norm() / scale, (u.transpose() * u - Row3::Identity()).norm(),
                     (v.transpose() * v - Row3::Identity()).norm(), std::abs(u.determinant() - 1),
                     std::abs(v.determinant() - 1)});
}

} // namespace

TEST_CASE("the SVD rebuilds random, graded and inverted matrices to rounding") {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        Row3 f;
        for (int k = 0; k < 9; ++k) f(k) = normal(random);
        if (i % 4 == 1) f.col(i % 3) *= 1e-9;
        if (i % 4 == 2) f = Row3::Identity() + 1e-8 * f;
        if (i % 4 == 3) f *= std::pow(10.0, normal(random) * 6);
        worst = std::max(worst, defect(f));
    }
    CHECK(worst < 3e-14);
}

TEST_CASE("the SVD of singular matrices has rotations all the same") {
    const Row3 zero = Row3::Zero(), identity = Row3::Identity();
    Row3 line = zero, plane = identity;
    line(0, 1) = 2, plane(2, 2) = 0;
    const Vec3 a(1, 2, 3), b(-2, 0.5, 1);
    const Row3 rank_one = a * b.transpose();
    Row3 reflected = identity;
    reflected(0, 0) = -0.3;
    for (const Row3& f : {zero, line, plane, rank_one, identity, reflected}) CHECK(defect(f) < 1e-14);
    Svd3<double> out;
    svd3(reflected.data(), out);
    CHECK(out.s[2] == Approx(-0.3).epsilon(1e-14));
    CHECK(out.s[0] == Approx(1).epsilon(1e-14));
}

TEST_CASE("a pack gives the same bits as a plain number in every lane") {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    double f[lanes][9];
    Pack packed[9];
    for (int k = 0; k < 9; ++k)
        for (int l = 0; l < lanes; ++l) packed[k].v[l] = f[l][k] = normal(random);
    Svd3<Pack> p;
    svd3(packed, p);
    for (int l = 0; l < lanes; ++l) {
        Svd3<double> s;
        svd3(f[l], s);
        for (int k = 0; k < 9; ++k) {
            CHECK(p.u[k][l] == s.u[k]);
            CHECK(p.v[k][l] == s.v[k]);
        }
    }
}

TEST_CASE("clamping a symmetric matrix keeps its positive part") {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        double d[3], o[3];
        for (int k = 0; k < 3; ++k) d[k] = normal(random), o[k] = normal(random);
        Mat3 m;
        m << d[0], o[2], o[1], o[2], d[1], o[0], o[1], o[0], d[2];
        const Eigen::SelfAdjointEigenSolver<Mat3> eigen(m);
        const Mat3 expected =
            eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
        clamp_symmetric3(d, o);
        Mat3 got;
        got << d[0], o[2], o[1], o[2], d[1], o[0], o[1], o[0], d[2];
        worst = std::max(worst, (got - expected).norm());
    }
    CHECK(worst < 1e-13);
}
