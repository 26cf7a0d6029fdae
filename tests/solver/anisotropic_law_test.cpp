// Transverse isotropy: what its ratio of stiffnesses does. What all laws must hold is in laws_test.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/one_tet.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

TEST_CASE(
    "with equal stiffness across and along, the anisotropic law is StVK, each side of 1 moves the right modulus") {
    std::mt19937 random(9);
    const Lame l = lame(1000, 0.3);
    const Vec3 a = Vec3(0.3, -1, 0.4).normalized();
    for (int i = 0; i < 30; ++i) {
        const Row3 f = random_matrix(random, 0.5);
        Row3 p, q;
        double w = 0, v = 0;
        elastic_stress(ElasticLaw::anisotropic, l.mu, l.lambda, 0, f.data(), p.data(), &w, a.data(), 1);
        elastic_stress(ElasticLaw::stvk, l.mu, l.lambda, 0, f.data(), q.data(), &v);
        CHECK((p - q).norm() < 1e-10 * std::max(1.0, q.norm()));
        CHECK(w == Approx(v).epsilon(1e-10));
    }
    // Free small stretch along and across: Young's moduli E and t E (lateral strains solved for).
    const double t = 0.3;
    const auto modulus = [&](int axis) {
        const Vec3 along = Vec3::UnitX();
        Eigen::Matrix<double, 9, 9> tangent;
        const double h = 1e-6;
        for (int k = 0; k < 9; ++k) {
            Row3 plus = Row3::Identity(), minus = plus, pp, pm;
            double w;
            plus(k) += h, minus(k) -= h;
            elastic_stress(ElasticLaw::anisotropic, l.mu, l.lambda, 0, plus.data(), pp.data(), &w, along.data(), t);
            elastic_stress(ElasticLaw::anisotropic, l.mu, l.lambda, 0, minus.data(), pm.data(), &w, along.data(), t);
            for (int r = 0; r < 9; ++r) tangent(r, k) = (pp(r) - pm(r)) / (2 * h);
        }
        Eigen::Matrix3d c;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) c(i, j) = tangent(4 * i, 4 * j);
        return 1 / c.inverse()(axis, axis);
    };
    CHECK(modulus(0) == Approx(1000).epsilon(1e-6));
    CHECK(modulus(1) == Approx(1000 * t).epsilon(1e-6));
    CHECK(modulus(2) == Approx(1000 * t).epsilon(1e-6));
}
