// The elastic laws: trusted stresses and energies, derivatives, invariance, projection.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/compression_resistance.h"
#include "tests/support/one_tet.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

const Vec3 some_direction = Vec3(2, -1, 0.5).normalized();

/// `direction` and `transverse`: for laws with directions; 1 is the same in all of them.
Row3 stress(ElasticLaw law, const Lame& l, double compression, const Row3& f, double* energy = nullptr,
            const Vec3& direction = some_direction, double transverse = 1) {
    Row3 p;
    double w = 0;
    elastic_stress(law, l.mu, l.lambda, compression, f.data(), p.data(), &w, direction.data(), transverse);
    if (energy) *energy = w;
    return p;
}

/// Stiffness across the direction over that along it, where the law reads it.
std::vector<double> ratios(const LawFacts& facts) {
    return needs_direction(facts.law) ? std::vector<double>{0.05, 4} : std::vector<double>{1};
}
double resistance(const LawFacts& facts) { return facts.resists_compression ? 3000 : 0; }

constexpr const char* rotation = "rotation 90deg about (1,2,3)/sqrt14 (must give P=0)";
constexpr const char* inverted = "inverted diag(-0.3,1,1)";

} // namespace

TEST_CASE("stresses and energies of every law equal the trusted values for thirteen deformations") {
    const nlohmann::json patch = accuracy()["material_patch"];
    const Lame l = lame(patch["E"], patch["nu"]);
    const auto& a = patch["tistvk"]["a"];
    const Vec3 direction(a[0], a[1], a[2]);
    for (const LawFacts& facts : elastic_laws) {
        const std::string reference(facts.reference);
        if (reference.empty()) continue; // no code gave values: the tests below remain
        const auto& cases = patch["cases"];
        double w = 0;
        stress(facts.law, l, 0, matrix(cases[rotation]["F"]), &w, direction, patch["tistvk"]["t"]);
        CHECK(std::abs(w) < 1e-10);
        // The reference's stable neo-Hookean does not subtract its energy at rest; ours is zero there.
        const double reference_rest = cases[rotation][reference]["W"];
        for (const auto& [title, c] : cases.items()) {
            INFO(facts.name << ", " << title);
            const Row3 p = stress(facts.law, l, 0, matrix(c["F"]), &w, direction, patch["tistvk"]["t"]);
            if (c[reference].is_string()) { // "undefined": the line search sees that it must not go there
                CHECK_FALSE(std::isfinite(w));
                continue;
            }
            const bool pole = facts.law == ElasticLaw::corotational && title == inverted;
            CHECK(w == Approx(double(c[reference]["W"]) - reference_rest).epsilon(1e-10).margin(1e-9));
            const Row3 expected = matrix(c[reference]["P"]);
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

TEST_CASE("gradients and Hessians of every law converge to finite differences at second order") {
    std::mt19937 random(11);
    for (const LawFacts& facts : elastic_laws)
        for (const double ratio : ratios(facts))
            for (const double spread : {0.1, 0.3}) {
                const OneTet tet(facts.law, resistance(facts), ratio);
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
                INFO(facts.name << " ratio " << ratio << " spread " << spread << ": " << gradient_error[0] << " "
                                << hessian_error[0]);
                CHECK(std::log2(gradient_error[0] / gradient_error[1]) == Approx(2).margin(0.1));
                CHECK(std::log2(hessian_error[0] / hessian_error[1]) == Approx(2).margin(0.1));
                CHECK(hessian_error[1] < 1e-3 * (h * d).norm());
            }
}

TEST_CASE("at rest no law has stress, and rotations change nothing") {
    const Lame l = lame(1e4, 0.45);
    std::mt19937 random(2);
    for (const LawFacts& facts : elastic_laws)
        for (const double ratio : ratios(facts)) {
            INFO(facts.name);
            CHECK(stress(facts.law, l, 2e4, Row3::Identity(), nullptr, some_direction, ratio).norm() <
                  1e-10 * l.lambda);
            for (int i = 0; i < 50; ++i) {
                const Row3 f = random_matrix(random, 0.3);
                if (f.determinant() < 0.05) continue;
                const Row3 q = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
                double before = 0, left = 0, right = 0;
                const Row3 p = stress(facts.law, l, 100, f, &before, some_direction, ratio);
                CHECK((stress(facts.law, l, 100, q * f, &left, some_direction, ratio) - q * p).norm() <
                      1e-10 * std::max(1.0, p.norm()));
                // Another rest frame, in which the direction is another one too.
                stress(facts.law, l, 100, f * q, &right, q.transpose() * some_direction, ratio);
                CHECK(left == Approx(before).epsilon(1e-10));
                CHECK(right == Approx(before).epsilon(1e-10));
            }
        }
}

TEST_CASE("the small-strain limit of every law is linear elasticity with exactly (E, nu)") {
    const double e = 5000, nu = 0.4;
    const Lame l = lame(e, nu);
    for (const LawFacts& facts : elastic_laws) {
        INFO(facts.name);
        Row3 strain;
        strain << 1, 0.3, -0.2, 0.3, -0.5, 0.4, -0.2, 0.4, 0.7;
        const double t = 1e-6;
        const Row3 expected = 2 * l.mu * strain + l.lambda * strain.trace() * Row3::Identity();
        const Row3 p = (stress(facts.law, l, 100, Row3::Identity() + t * strain) -
                        stress(facts.law, l, 100, Row3::Identity() - t * strain)) /
                       (2 * t);
        CHECK((p - expected).norm() < 1e-6 * expected.norm());
    }
}

TEST_CASE("projected Hessians of every law are positive semi-definite on ten thousand random and inverted tets") {
    std::mt19937 random(13);
    for (const LawFacts& facts : elastic_laws)
        for (const double ratio : ratios(facts)) {
            const OneTet tet(facts.law, resistance(facts), ratio);
            Row3 turned_inside_out = Row3::Identity();
            turned_inside_out(0, 0) = -0.3;
            const bool has_inverse = std::isfinite(tet.energy(tet.positions(turned_inside_out)));
            double least = 0;
            int checked = 0;
            for (int i = 0; i < 10000; ++i) {
                Row3 f = random_matrix(random, i % 2 ? 2.0 : 0.4);
                if (i % 5 == 0) f.col(1).setZero();
                if (i == 7) f.setZero();
                if (!has_inverse && f.determinant() < 1e-3) continue;
                ++checked;
                const Mat12 h = tet.hessian(tet.positions(f), true);
                REQUIRE(h.allFinite());
                const Eigen::SelfAdjointEigenSolver<Mat12> eigen(h, Eigen::EigenvaluesOnly);
                least = std::min(least, eigen.eigenvalues()[0] / std::max(1.0, eigen.eigenvalues()[11]));
            }
            INFO(facts.name << " ratio " << ratio);
            CHECK(checked > 4000);
            CHECK(least > -1e-12);
        }
}

TEST_CASE("where no eigenvalue is negative the projection of isotropic laws changes nothing") {
    std::mt19937 random(17);
    for (const LawFacts& facts : elastic_laws) {
        if (needs_direction(facts.law)) continue; // clamps its tension, which is more than the sum needs
        const OneTet tet(facts.law, 0);
        int checked = 0;
        for (int i = 0; i < 200; ++i) {
            const Row3 f = random_matrix(random, 0.15) * 1.3;
            if (f.determinant() < 0.3) continue;
            const Vec12 x = tet.positions(f);
            const Mat12 exact = tet.hessian(x, false);
            if (Eigen::SelfAdjointEigenSolver<Mat12>(exact).eigenvalues()[0] < -1e-9) continue;
            ++checked;
            CHECK((exact - tet.hessian(x, true)).norm() < 1e-11 * exact.norm());
        }
        INFO(facts.name);
        CHECK(checked > 20);
    }
}
