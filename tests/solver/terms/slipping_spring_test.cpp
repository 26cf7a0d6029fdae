// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/slipping_spring.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace sinew;
using namespace sinew::solver;

namespace {

/// In the plane across z, as between two surfaces.
const Mat3 plane = Vec3(1, 1, 0).asDiagonal();
const SlippingSpring spring{200, 3}; // slips from 15 mm on

} // namespace

TEST_CASE("slipping spring: pulls as a spring does, and never with more than its most", "[friction]") {
    CHECK((spring.force(Vec3(0.006, -0.008, 0)) - Vec3(1.2, -1.6, 0)).norm() < 1e-15);
    CHECK(spring.energy(Vec3(0.006, -0.008, 0)) == Approx(0.5 * 200 * 1e-4));
    CHECK(!spring.slips(Vec3(0.006, -0.008, 0)));
    CHECK((spring.force(Vec3(0.06, -0.08, 0)) - Vec3(1.8, -2.4, 0)).norm() < 1e-14);
    // 3 N over the 85 mm that it slips, and what it stores by then.
    CHECK(spring.energy(Vec3(0.06, -0.08, 0)) == Approx(3 * 0.085 + 0.5 * 200 * 0.015 * 0.015));
    const SlippingSpring firm{200, std::numeric_limits<double>::infinity()};
    CHECK(firm.force(Vec3(0, 5, 0)) == Vec3(0, 1000, 0));
    CHECK(firm.energy(Vec3(0, 5, 0)) == Approx(2500));
    // Neither a stiffness nor a most: nothing.
    CHECK(SlippingSpring{}.force(Vec3(0, 5, 0)) == Vec3::Zero());
    CHECK(SlippingSpring{200, 0}.force(Vec3(0, 5, 0)) == Vec3::Zero());
    CHECK(SlippingSpring{200, 0}.energy(Vec3(0, 5, 0)) == 0);
}

TEST_CASE("followed force: is the spring's own where ways no longer change, and its stiffness the second derivative",
          "[friction]") {
    for (const Vec3& way : {Vec3(0.004, 0.003, 0), Vec3(0.05, -0.02, 0)}) {
        FollowedForce f;
        f.follow(spring, way), f.follow(spring, way);
        CHECK((f.force() - spring.force(way)).norm() < 1e-14);
        const Mat3 h = f.stiffness(spring, way, plane);
        for (int c = 0; c < 2; ++c) {
            constexpr double step = 1e-6;
            const Vec3 d = step * Vec3::Unit(c);
            const Vec3 derivative = (spring.force(way + d) - spring.force(way - d)) / (2 * step);
            CHECK((h.col(c) - derivative).norm() < 1e-6 * spring.stiffness);
        }
        CHECK(h.col(2).norm() == 0);
    }
}

TEST_CASE("followed force: never exceeds the spring's most, and its stiffness is never negative", "[friction]") {
    FollowedForce f(Vec3(0, 2.5, 0));
    double sideways = 1;
    for (int i = 0; i < 50; ++i) {
        sideways *= -1.3;
        const Vec3 way(0.03 * std::sin(1.7 * i) + 1e-3 * sideways, 0.05 * std::cos(2.9 * i), 0);
        f.follow(spring, way);
        CHECK(f.force().norm() <= spring.most * (1 + 1e-14));
        const Mat3 h = f.stiffness(spring, way, plane);
        CHECK((h - h.transpose()).norm() == 0);
        CHECK(Eigen::SelfAdjointEigenSolver<Mat3>(h).eigenvalues().minCoeff() >= -1e-12 * spring.stiffness);
    }
}

TEST_CASE("followed force: Newton's method finds where a pulled mass on a soft and a slipping spring rests",
          "[friction]") {
    // A soft spring (2 N/m) to the place where a force alone would have it, and friction of 3 N that may hold it
    // anywhere on the way: |rest| = |pulled| - 3 N / 2 N/m, along the same line. The exact second derivative, nearly
    // zero along the slip, throws it from one side to the other.
    const Vec3 pulled(9, 12, 0); // 15 m from the anchor
    constexpr double soft = 2;
    const Vec3 rest = (15 - 3 / soft) / 15 * pulled;
    Vec3 x(-1, 0.01, 0); // on the wrong side
    FollowedForce f;
    int iterations = 0;
    for (; iterations < 12; ++iterations) {
        const Vec3 gradient = soft * (x - pulled) + spring.force(x);
        if (gradient.norm() < 1e-12) break;
        f.follow(spring, x);
        x -= Mat3(soft * Mat3::Identity() + f.stiffness(spring, x, plane)).inverse() * gradient;
    }
    CHECK((x - rest).norm() < 1e-9);
    CHECK(iterations <= 8);
}
