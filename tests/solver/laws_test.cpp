// The elastic laws: trusted stresses and energies, derivatives, invariance, projection.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/stvk.h"
#include "tests/support/one_tet.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

const std::pair<ElasticLaw, const char*> laws[] = {
    {ElasticLaw::stvk, "stvk"}, {ElasticLaw::neo_hookean, "snh"}, {ElasticLaw::corotational, "corot"}};

Row3 stress(ElasticLaw law, const Lame& l, double compression, const Row3& f, double* energy = nullptr) {
    Row3 p;
    double w = 0;
    elastic_stress(law, l.mu, l.lambda, compression, f.data(), p.data(), &w);
    if (energy) *energy = w;
    return p;
}

} // namespace

TEST_CASE("stresses and energies equal the trusted values for thirteen deformations") {
    const nlohmann::json patch = accuracy()["material_patch"];
    const Lame l = lame(patch["E"], patch["nu"]);
    for (const auto& [law, name] : laws) {
        double energy_of_rotation = 0;
        const auto& cases = patch["cases"];
        stress(law, l, 0, matrix(cases["rotation 90deg about (1,2,3)/sqrt14 (must give P=0)"]["F"]),
               &energy_of_rotation);
        // The reference's stable neo-Hookean does not subtract its energy at rest; ours is zero there.
        const double reference_rest = cases["rotation 90deg about (1,2,3)/sqrt14 (must give P=0)"][name]["W"];
        CHECK(std::abs(energy_of_rotation) < 1e-10);
        for (const auto& [title, c] : cases.items()) {
            INFO(name << ", " << title);
            double w = 0;
            const Row3 p = stress(law, l, 0, matrix(c["F"]), &w), expected = matrix(c[name]["P"]);
            const bool pole = law == ElasticLaw::corotational && title.find("inverted") != std::string::npos;
            CHECK(w == Approx(double(c[name]["W"]) - reference_rest).epsilon(1e-10).margin(1e-9));
            if (!pole) CHECK((p - expected).norm() < 1e-9 * std::max(1.0, expected.norm()));
        }
    }
}

TEST_CASE("compression resistance equals the trusted values and is nothing in tension") {
    const nlohmann::json patch = accuracy()["material_patch"];
    const double k = compression_coefficient(patch["compres"]["c"], patch["E"], patch["nu"]);
    for (const auto& [title, c] : patch["cases"].items()) {
        INFO(title);
        double w = 0, without = 0;
        const Row3 f = matrix(c["F"]);
        const Lame l = lame(patch["E"], patch["nu"]);
        const Row3 p = stress(ElasticLaw::stvk, l, k, f, &w) - stress(ElasticLaw::stvk, l, 0, f, &without);
        CHECK(w - without == Approx(double(c["compres_vega"]["W"])).epsilon(1e-10).margin(1e-9));
        CHECK((p - matrix(c["compres_vega"]["P"])).norm() < 1e-8 * std::max(1.0, p.norm()));
    }
}

TEST_CASE("closed forms: confined uniaxial, simple shear and volumetric stress") {
    const double e = 1000, nu = 0.3;
    const Lame m = lame(e, nu);
    for (const double s : {0.6, 0.9, 1.3, 2.0}) {
        const Row3 uniaxial = Vec3(s, 1, 1).asDiagonal();
        CHECK(stress(ElasticLaw::stvk, m, 0, uniaxial)(0, 0) == Approx((m.lambda + 2 * m.mu) * s * (s * s - 1) / 2));
        CHECK(stress(ElasticLaw::corotational, m, 0, uniaxial)(0, 0) == Approx((m.lambda + 2 * m.mu) * (s - 1)));
        CHECK(stress(ElasticLaw::corotational, m, 0, uniaxial)(1, 1) == Approx(m.lambda * (s - 1)));
        const Row3 volumetric = s * Row3::Identity();
        CHECK(stress(ElasticLaw::stvk, m, 0, volumetric)(0, 0) / (s * s) ==
              Approx((3 * m.lambda + 2 * m.mu) * (s * s - 1) / (2 * s)));
        CHECK(stress(ElasticLaw::corotational, m, 0, volumetric)(0, 0) / (s * s) ==
              Approx((3 * m.lambda + 2 * m.mu) * (s - 1) / (s * s)));
        // Stable neo-Hookean: ms (1 - 1/(3 s^2 + 1)) s + ls (s^3 - a) s^2.
        const double ms = 4.0 / 3 * m.mu, ls = m.lambda + 5.0 / 6 * m.mu, a = 1 + ms / ls - ms / (4 * ls);
        CHECK(stress(ElasticLaw::neo_hookean, m, 0, volumetric)(0, 0) ==
              Approx(ms * (1 - 1 / (3 * s * s + 1)) * s + ls * (s * s * s - a) * s * s).margin(1e-9));
    }
    for (const double k : {0.1, 0.7}) {
        Row3 shear = Row3::Identity();
        shear(0, 1) = k;
        const Row3 p = stress(ElasticLaw::stvk, m, 0, shear);
        CHECK(p(0, 1) == Approx(m.mu * k + (m.lambda / 2 + m.mu) * k * k * k));
        CHECK(p(0, 0) == Approx((m.lambda / 2 + m.mu) * k * k));
        CHECK(p(1, 0) == Approx(m.mu * k));
    }
}

TEST_CASE("gradients and Hessians converge to finite differences at second order") {
    std::mt19937 random(11);
    for (const auto& [law, name] : laws)
        for (const double spread : {0.1, 0.6}) {
            const OneTet tet(law, law == ElasticLaw::corotational ? 0 : 3000);
            Row3 f = random_matrix(random, spread);
            if (f.determinant() < 0.1) f.col(0) *= -1; // away from the pole of the co-rotational law
            if (f.determinant() < 0.1) f = random_matrix(random, 0.05);
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
            INFO(name << " spread " << spread << ": " << gradient_error[0] << " " << hessian_error[0]);
            CHECK(std::log2(gradient_error[0] / gradient_error[1]) == Approx(2).margin(0.1));
            CHECK(std::log2(hessian_error[0] / hessian_error[1]) == Approx(2).margin(0.1));
            CHECK(hessian_error[1] < 1e-3 * (h * d).norm());
        }
}

TEST_CASE("rest is free of stress and rotations change nothing") {
    const Lame l = lame(1e4, 0.45);
    std::mt19937 random(2);
    for (const auto& [law, name] : laws) {
        INFO(name);
        CHECK(stress(law, l, 2e4, Row3::Identity()).norm() < 1e-10 * l.lambda);
        for (int i = 0; i < 50; ++i) {
            const Row3 f = random_matrix(random, 0.3);
            if (f.determinant() < 0.05) continue;
            const Row3 q = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
            double before = 0, left = 0, right = 0;
            const Row3 p = stress(law, l, 100, f, &before);
            CHECK((stress(law, l, 100, q * f, &left) - q * p).norm() < 1e-10 * std::max(1.0, p.norm()));
            stress(law, l, 100, f * q, &right);
            CHECK(left == Approx(before).epsilon(1e-10));
            CHECK(right == Approx(before).epsilon(1e-10));
        }
    }
}

TEST_CASE("the small-strain limit is linear elasticity with exactly (E, nu)") {
    const double e = 5000, nu = 0.4;
    const Lame l = lame(e, nu);
    for (const auto& [law, name] : laws) {
        INFO(name);
        Row3 strain;
        strain << 1, 0.3, -0.2, 0.3, -0.5, 0.4, -0.2, 0.4, 0.7;
        const double t = 1e-6;
        const Row3 expected = 2 * l.mu * strain + l.lambda * strain.trace() * Row3::Identity();
        const Row3 p =
            (stress(law, l, 100, Row3::Identity() + t * strain) - stress(law, l, 100, Row3::Identity() - t * strain)) /
            (2 * t);
        CHECK((p - expected).norm() < 1e-6 * expected.norm());
    }
}

TEST_CASE("projected Hessians are positive semi-definite on ten thousand random and inverted tets") {
    std::mt19937 random(13);
    for (const auto& [law, name] : laws) {
        const OneTet tet(law, law == ElasticLaw::corotational ? 0 : 3000);
        double least = 0;
        for (int i = 0; i < 10000; ++i) {
            Row3 f = random_matrix(random, i % 2 ? 2.0 : 0.4);
            if (i % 5 == 0) f.col(1).setZero();
            if (i == 7) f.setZero();
            const Mat12 h = tet.hessian(tet.positions(f), true);
            REQUIRE(h.allFinite());
            const Eigen::SelfAdjointEigenSolver<Mat12> eigen(h, Eigen::EigenvaluesOnly);
            least = std::min(least, eigen.eigenvalues()[0] / std::max(1.0, eigen.eigenvalues()[11]));
        }
        INFO(name);
        CHECK(least > -1e-12);
    }
}

TEST_CASE("where no eigenvalue is negative the projection changes nothing") {
    std::mt19937 random(17);
    for (const auto& [law, name] : laws) {
        const OneTet tet(law, 0);
        int checked = 0;
        for (int i = 0; i < 200; ++i) {
            const Vec12 x = tet.positions(random_matrix(random, 0.15) * 1.3);
            const Mat12 exact = tet.hessian(x, false);
            if (Eigen::SelfAdjointEigenSolver<Mat12>(exact).eigenvalues()[0] < -1e-9) continue;
            ++checked;
            CHECK((exact - tet.hessian(x, true)).norm() < 1e-11 * exact.norm());
        }
        INFO(name);
        CHECK(checked > 20);
    }
}
