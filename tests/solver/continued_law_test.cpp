// LogNeoHookean continued to tets that are flat or inside out, which first guesses go by.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/formulas.h"
#include "tests/support/one_tet.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace sinew::solver;
using Catch::Detail::Approx;

namespace {

constexpr double mu = 3000, lambda = 40000;
constexpr LawInUse plain = ElasticLaw::log_neo_hookean, continued{ElasticLaw::log_neo_hookean, true};

Principal<double> by_stretches(LawInUse law, std::array<double, 3> s) {
    Principal<double> out;
    evaluate_law(law, s.data(), mu, lambda, 0.0, out);
    return out;
}

TensorForm<double> by_strains(LawInUse law, double x, double y, double z) {
    const double f[9] = {x, 0, 0, 0, y, 0, 0, 0, z};
    Strains<double> strains;
    set_strains(f, strains);
    TensorForm<double> out;
    evaluate_law(law, strains, mu, lambda, 0.0, out);
    return out;
}

} // namespace

TEST_CASE("LogNeoHookean continued is the law itself above J = 0.03, and goes on by its Taylor series below") {
    for (const double z : {1.2, 0.4, 0.031}) {
        const auto a = by_stretches(plain, {1.1, 1 / 1.1, z}), b = by_stretches(continued, {1.1, 1 / 1.1, z});
        CHECK(b.energy == Approx(a.energy).epsilon(1e-13));
        for (int i = 0; i < 3; ++i) {
            CHECK(b.first[i] == Approx(a.first[i]).epsilon(1e-12));
            CHECK(b.diagonal[i] == Approx(a.diagonal[i]).epsilon(1e-12));
            CHECK(b.off_diagonal[i] == Approx(a.off_diagonal[i]).epsilon(1e-12));
        }
    }
    // J = -0.5 on stretches 2, 1 and -0.25: ln 0.03 + d - d^2/2 with d = -0.53/0.03.
    const double d = -0.53 / 0.03, log = std::log(0.03) + d - d * d / 2;
    const double expected = mu / 2 * (4 + 1 + 0.0625 - 3) - mu * log + lambda / 2 * log * log;
    CHECK_FALSE(std::isfinite(by_stretches(plain, {2, 1, -0.25}).energy));
    CHECK(by_stretches(continued, {2, 1, -0.25}).energy == Approx(expected).epsilon(1e-12));
    CHECK(by_strains(continued, 2, 1, -0.25).energy == Approx(expected).epsilon(1e-12));
}

TEST_CASE("LogNeoHookean continued has the derivatives of its energy, by stretches and by J, on both sides of 0.03") {
    constexpr double h = 1e-6;
    for (const double z : {0.05, 0.02, 0.0, -0.01, -0.4}) {
        INFO("J = " << z);
        const auto energy = [&](double at) { return by_stretches(continued, {1, 1, at}).energy; };
        const auto here = by_stretches(continued, {1, 1, z});
        CHECK(here.first[2] == Approx((energy(z + h) - energy(z - h)) / (2 * h)).epsilon(1e-5));
        const auto slope = [&](double at) { return by_stretches(continued, {1, 1, at}).first[2]; };
        CHECK(here.diagonal[2] == Approx((slope(z + h) - slope(z - h)) / (2 * h)).epsilon(1e-5));
        // By strains: what hangs on J alone is the energy less mu tr E.
        const auto by_j = [&](double at) { return by_strains(continued, 1, 1, at).energy - mu / 2 * (at * at - 1); };
        const auto form = by_strains(continued, 1, 1, z);
        CHECK(form.by_j == Approx((by_j(z + h) - by_j(z - h)) / (2 * h)).epsilon(1e-5));
        const auto j_slope = [&](double at) { return by_strains(continued, 1, 1, at).by_j; };
        CHECK(form.by_jj == Approx((j_slope(z + h) - j_slope(z - h)) / (2 * h)).epsilon(1e-5));
        // Its measure of volume is the same logarithm.
        const auto measure = [&](double at) {
            Principal<double> out;
            const std::array<double, 3> s{1, 1, at};
            evaluate_measure(continued, s.data(), out);
            return out;
        };
        CHECK(measure(z).first[2] == Approx((measure(z + h).energy - measure(z - h).energy) / (2 * h)).epsilon(1e-5));
    }
}
