// Skinning against closed forms: rigid motion, a twist of half a turn, the mean of two places.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/rigid_motion.h"
#include "solver/mesh/skinning.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace sinew::solver;

namespace {

JointMotion turned(const Vec3& axis, double angle, const Vec3& about, const Vec3& shift) {
    const Mat3 turn = rotation_by(angle * axis.normalized()).toRotationMatrix();
    return {turn, about - turn * about + shift};
}

const Points points{{1, 0, 0}, {0, 1, 0.5}, {-0.3, 0.2, 2}};

} // namespace

TEST_CASE("where joints move alike both skinnings move rigidly", "[mesh]") {
    const JointMotion m = turned({1, 2, -1}, 2.2, {0.3, 0, 1}, {4, 5, 6});
    const std::vector<JointMotion> joints{m, m};
    const std::vector<std::vector<double>> weights{{0.25, 1, 0}, {0.75, 0, 1}};
    const Points linear = skin_linearly(points, joints, weights),
                 dual = skin_by_dual_quaternions(points, joints, weights);
    for (std::size_t v = 0; v < points.size(); ++v) {
        CHECK((linear[v] - (m.linear * points[v] + m.shift)).norm() < 1e-14);
        CHECK((dual[v] - (m.linear * points[v] + m.shift)).norm() < 1e-14);
    }
}

TEST_CASE(
    "halfway in a twist of half a turn, linear skins collapse onto the axis and dual quaternions turn by a quarter",
    "[mesh]") {
    const std::vector<JointMotion> joints{{}, turned({0, 0, 1}, std::numbers::pi, {0, 0, 0}, {0, 0, 0})};
    const std::vector<std::vector<double>> weights{{0.5}, {0.5}};
    const Points one{{1, 0, 3}};
    CHECK((skin_linearly(one, joints, weights)[0] - Vec3(0, 0, 3)).norm() < 1e-15);
    const Vec3 p = skin_by_dual_quaternions(one, joints, weights)[0];
    CHECK(std::abs(p.x()) < 1e-15);
    CHECK(std::abs(std::abs(p.y()) - 1) < 1e-15);
    CHECK(p.z() == Approx(3));
}

TEST_CASE("dual quaternions about one axis turn by the angle between, also the long way of the quaternions", "[mesh]") {
    // Of turns about one axis by a and b with equal weights comes (a + b) / 2.
    for (const auto& [a, b] : {std::pair(0.4, 1.0), {2.9, 3.5}, {-3.0, 3.0}}) {
        const Vec3 axis(0.2, -1, 0.6), about(1, 1, 0);
        const std::vector<JointMotion> joints{turned(axis, a, about, {0, 0, 0}), turned(axis, b, about, {0, 0, 0})};
        const std::vector<std::vector<double>> weights{{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}};
        const double middle = std::abs(a - b) < std::numbers::pi ? 0.5 * (a + b) : 0.5 * (a + b) + std::numbers::pi;
        const JointMotion wanted = turned(axis, middle, about, {0, 0, 0});
        const Points got = skin_by_dual_quaternions(points, joints, weights);
        for (std::size_t v = 0; v < points.size(); ++v)
            CHECK((got[v] - (wanted.linear * points[v] + wanted.shift)).norm() < 1e-14);
    }
}

TEST_CASE("linear skins take the weighted mean of what joints do, scales too", "[mesh]") {
    const std::vector<JointMotion> joints{{2 * Mat3::Identity(), {0, 0, 0}}, {Mat3::Identity(), {0, 4, 0}}};
    const std::vector<std::vector<double>> weights{{0.25}, {0.75}};
    CHECK((skin_linearly({{1, 2, 3}}, joints, weights)[0] - Vec3(1.25, 5.5, 3.75)).norm() < 1e-15);
    CHECK(unlike_rigid(joints[0]) == Approx(3));
    CHECK(unlike_rigid({-Mat3::Identity(), {0, 0, 0}}) == Approx(1));
    CHECK(unlike_rigid(turned({1, 1, 1}, 1, {2, 0, 0}, {1, 0, 0})) < 1e-15);
}
