// The laws beside the three for animation: neo-Hookean with logarithms and transverse isotropy.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/one_tet.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

TEST_CASE("log neo-Hookean and transverse isotropy give the trusted stresses and energies") {
    const nlohmann::json p = accuracy()["material_patch"];
    const Lame l = lame(p["E"], p["nu"]);
    const auto& a = p["tistvk"]["a"];
    const double direction[3] = {a[0], a[1], a[2]};
    for (const auto& [title, c] : p["cases"].items()) {
        INFO(title);
        const Row3 f = matrix(c["F"]);
        Row3 stress;
        double energy = 0;
        elastic_stress(ElasticLaw::anisotropic, l.mu, l.lambda, 0, f.data(), stress.data(), &energy, direction,
                       p["tistvk"]["t"]);
        CHECK(energy == Approx(double(c["tistvk"]["W"])).epsilon(1e-10).margin(1e-9));
        CHECK((stress - matrix(c["tistvk"]["P"])).norm() < 1e-9 * std::max(1.0, stress.norm()));
        elastic_stress(ElasticLaw::log_neo_hookean, l.mu, l.lambda, 0, f.data(), stress.data(), &energy);
        if (f.determinant() > 0) {
            CHECK(energy == Approx(double(c["nh"]["W"])).epsilon(1e-10).margin(1e-9));
            CHECK((stress - matrix(c["nh"]["P"])).norm() < 1e-9 * std::max(1.0, stress.norm()));
        } else {
            CHECK_FALSE(std::isfinite(energy)); // the line search sees that it must not go there
        }
    }
}

TEST_CASE("their gradients and Hessians converge to finite differences at second order, projected ones are definite") {
    std::mt19937 random(5);
    for (const auto& [law, t] : {std::pair{ElasticLaw::log_neo_hookean, 1.0},
                                 {ElasticLaw::anisotropic, 0.05},
                                 {ElasticLaw::anisotropic, 4.0}}) {
        const OneTet tet(law, 0, t);
        for (const double spread : {0.1, 0.3}) {
            Row3 f = random_matrix(random, spread);
            while (f.determinant() < 0.3) f = random_matrix(random, spread);
            const Vec12 x = tet.positions(f), d = Vec12::Random();
            const Vec12 g = tet.gradient(x);
            const Mat12 h = tet.hessian(x, false);
            double gradient_error[2], hessian_error[2];
            for (int i = 0; i < 2; ++i) {
                const double step = i ? 5e-4 : 1e-3;
                gradient_error[i] =
                    std::abs((tet.energy(x + step * d) - tet.energy(x - step * d)) / (2 * step) - g.dot(d));
                hessian_error[i] =
                    ((tet.gradient(x + step * d) - tet.gradient(x - step * d)) / (2 * step) - h * d).norm();
            }
            INFO(t << " " << spread);
            CHECK(std::log2(gradient_error[0] / gradient_error[1]) == Approx(2).margin(0.1));
            CHECK(std::log2(hessian_error[0] / hessian_error[1]) == Approx(2).margin(0.1));
        }
        double least = 0;
        for (int i = 0; i < 5000; ++i) {
            Row3 f = random_matrix(random, i % 2 ? 1.0 : 0.3);
            if (law == ElasticLaw::log_neo_hookean && f.determinant() < 1e-3) continue;
            const Mat12 h = tet.hessian(tet.positions(f), true);
            REQUIRE(h.allFinite());
            const Eigen::SelfAdjointEigenSolver<Mat12> eigen(h, Eigen::EigenvaluesOnly);
            least = std::min(least, eigen.eigenvalues()[0] / std::max(1.0, eigen.eigenvalues()[11]));
        }
        CHECK(least > -1e-12);
    }
}

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
