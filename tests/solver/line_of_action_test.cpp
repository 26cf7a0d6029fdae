// Curves and lines of action (solver/fiber): lengths in closed form, loaValue from its definition.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/fiber/curve.h"
#include "solver/fiber/line_of_action.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace sinew::solver;

namespace {

std::string code_of(const Curve& curve) {
    try {
        check_curve(curve);
    } catch (const Error& e) {
        return e.code;
    }
    return "";
}

} // namespace

TEST_CASE("a polyline is as long as its pieces", "[line]") {
    CHECK(curve_length({{{0, 0, 0}, {3, 0, 0}, {3, 4, 0}, {3, 4, 0.5}}, CurveForm::polyline}) == 7.5);
    CHECK(curve_samples({{{0, 0, 0}, {1, 2, 3}}, CurveForm::polyline}, 8) == Points{{0, 0, 0}, {1, 2, 3}});
}

TEST_CASE("a cubic of control points of a parabola is that parabola", "[line]") {
    // y = x^2 from 0 to 1 by its blossom (u v + v w + w u) / 3: of one span, of two that meet at one half, of three.
    const auto point = [](double u, double v, double w) {
        return Vec3((u + v + w) / 3, (u * v + v * w + w * u) / 3, 0);
    };
    const double length = 0.5 * std::sqrt(5.0) + 0.25 * std::asinh(2.0);
    for (int spans = 1; spans <= 3; ++spans) {
        const auto knot = [&](int i) { return static_cast<double>(std::clamp(i - 3, 0, spans)) / spans; };
        Curve curve{{}, CurveForm::cubic};
        for (int i = 0; i < spans + 3; ++i) curve.points.push_back(point(knot(i + 1), knot(i + 2), knot(i + 3)));
        INFO(spans);
        CHECK(std::abs(curve_length(curve) - length) < 1e-13);
        const Points samples = curve_samples(curve, 5);
        REQUIRE(samples.size() == static_cast<std::size_t>(5 * spans + 1));
        for (const Vec3& p : samples) CHECK(std::abs(p.y() - p.x() * p.x()) < 1e-15);
        CHECK(samples.front() == Vec3(0, 0, 0));
        CHECK(samples.back() == Vec3(1, 1, 0));
    }
}

TEST_CASE("a curve with too few points for its form is refused", "[line]") {
    const Points three{{0, 0, 0}, {1, 0, 0}, {2, 1, 0}};
    CHECK(code_of({three, CurveForm::polyline}).empty());
    CHECK(code_of({three, CurveForm::cubic}) == "FE216");
    CHECK(code_of({{{0, 0, 0}}, CurveForm::polyline}) == "FE216");
}

TEST_CASE("loaValue is the share by which a line is shorter, within its limits", "[line]") {
    LineOfActionValues v;
    LineMemory line = start_line(v, 2);
    CHECK(line.value == 0);
    CHECK(follow_line(v, line, 1.5, 0.1).value == 0.25);
    CHECK(follow_line(v, line, 2.5, 0.1).value == 0); // longer gives nothing, not less
    v.pos_sensitivity = 2;
    CHECK(follow_line(v, line, 1.5, 0.1).value == 0.5);
    v.max_excitation = 0.3;
    CHECK(follow_line(v, line, 1.5, 0.1).value == 0.3);
    v = {.stretch_bias = 0.25}; // measured from 2.5: fires at rest
    CHECK(start_line(v, 2).value == Approx(0.2).epsilon(1e-15));
    CHECK(follow_line(v, line, 2.5, 0.1).value == 0);
    CHECK(follow_line(v, line, 1.25, 0.1).value == 0.5);
    CHECK(excitation_with(0.5, {.value = 0.25}) == 0.75);
    CHECK(excitation_with(0.9, {.value = 0.25}) == 1);
}

TEST_CASE("rates of a line are relative and in seconds, over steps of any size", "[line]") {
    // L = 2 + 0.3 t - 0.5 t^2, of which differences over steps are known in closed form.
    const auto length = [](double t) { return 2 + 0.3 * t - 0.5 * t * t; };
    const double first = 0.1, second = 0.3, full = 2 * 1.5;
    LineOfActionValues v{.max_excitation = 1e9, .stretch_bias = 0.5, .pos_sensitivity = 0, .vel_sensitivity = 1};
    const LineMemory rest = start_line(v, length(0));
    CHECK(rest.value == 0);
    // Shortening fires: the rate over a step is that of its middle, 0.3 - (t0 + t1) / 2.
    v.vel_sensitivity = -1; // this line lengthens at first
    const LineMemory one = follow_line(v, rest, length(first), first);
    CHECK(one.value == Approx((0.3 - first / 2) / full).epsilon(1e-12));
    v.vel_sensitivity = 7;
    CHECK(follow_line(v, one, length(1.3), 1.2).value == Approx(7 * (1.4 / 2 - 0.3) / full).epsilon(1e-12));
    // L'' = -1 exactly, from the second step on, also where steps differ.
    v.vel_sensitivity = 0, v.acc_sensitivity = 2;
    CHECK(follow_line(v, rest, length(first), first).value == 0);
    CHECK(follow_line(v, one, length(first + second), second).value == Approx(2 / full).epsilon(1e-12));
}
