// Holds: numbers of small cases that are known by hand.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "tests/support/held_body.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

bool at_left(const Vec3& p) { return p.x() < 1e-9; }
bool at_right(const Vec3& p) { return p.x() > 0.4 - 1e-9; }

/// A bar of 40 x 10 x 10 cm in four cubes.
HeldBody bar(const std::vector<Where>& held) {
    return {{0.4, 0.1, 0.1}, 4, 1, 1, ElasticLaw::stvk, ElementKind::linear, held};
}

} // namespace

TEST_CASE("the largest force of a hold is the largest, whichever hold it is of") {
    for (const bool left_is_larger : {true, false}) {
        HeldBody b = bar({at_left, at_right});
        b.values().forces.assign(b.nodes.size(), Vec3::Zero());
        for (std::size_t v = 0; v < b.nodes.size(); ++v) { // four vertices at each end
            if (at_left(b.nodes[v])) b.values().forces[v] = left_is_larger ? Vec3(0, 3, 4) : Vec3(0, 0, 1);
            if (at_right(b.nodes[v])) b.values().forces[v] = left_is_larger ? Vec3(0, 0, 1) : Vec3(0, 3, 4);
        }
        b.start();
        REQUIRE(b.step());
        CHECK(value_of(b.state.record.measured, "hold", "reaction_N") == Approx(20).epsilon(1e-9));
        CHECK(b.force(left_is_larger ? 0 : 1).norm() == Approx(20).epsilon(1e-9));
        CHECK(b.force(left_is_larger ? 1 : 0).norm() == Approx(4).epsilon(1e-9));
    }
}

TEST_CASE("a bone may be off a rigid motion by a ten-thousandth of its size and no more") {
    const auto code = [](double off) {
        HeldBody b = bar({at_left});
        b.follow_bone({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}});
        b.start();
        Points& bone = std::get<BoneInputs>(b.in.bodies[1]).positions;
        bone[3].z() += off;
        try {
            b.step();
        } catch (const Error& e) {
            return e.code;
        }
        return std::string();
    };
    CHECK(code(1e-5).empty());
    CHECK(code(1e-3) == "FE250");
    CHECK(code(5e-3) == "FE250");
}

TEST_CASE("what is held goes as its motion does from the start frame on, whatever that was there") {
    const RigidMotion start = about({0.3, -0.2, 0}, Eigen::AngleAxisd(0.7, Vec3::UnitZ())),
                      later = about({-0.4, 0, 0.5}, Eigen::AngleAxisd(-1.1, Vec3(1, 2, 2) / 3));
    HeldBody b = bar({at_left});
    b.hold(0).set_motion(start);
    b.put_holds();
    b.start();
    b.hold(0).set_motion(later);
    b.put_holds();
    REQUIRE(b.step());
    for (std::size_t v = 0; v < b.nodes.size(); ++v) {
        if (!at_left(b.nodes[v])) continue;
        const Vec3 local = start.rotation.conjugate() * (b.nodes[v] - start.translation);
        const Vec3 there = later.rotation * local + later.translation;
        CHECK((position(b.state, static_cast<int>(v)) - there).norm() < 1e-12);
    }
}

TEST_CASE("between two holds a body is taken along by the nearer one for more") {
    HeldBody b = bar({at_left, at_right});
    b.start();
    b.hold(1).set_motion({Eigen::Quaterniond::Identity(), Vec3(0.2, 0, 0.1)});
    b.put_holds();
    Potential potential(*b.scene);
    ImplicitForm form;
    quasi_static_form(b.state, form);
    potential.take(b.state, b.in);
    potential.begin_step(b.state, b.in);
    potential.begin_stage(b.state, form, b.state.bones);
    Positions x = b.state.x, carried;
    potential.place_held(x);
    std::vector<char> bodies;
    REQUIRE(potential.carry(x, carried, bodies));
    CHECK(bodies == std::vector<char>{1});
    for (std::size_t v = 0; v < b.nodes.size(); ++v) {
        // By the inverse of the distance to what is held: x / (x + (0.4 - x)) of the right one's way.
        const Vec3 there = b.nodes[v] + b.nodes[v].x() / 0.4 * Vec3(0.2, 0, 0.1);
        const Vec3 found(carried[3 * v], carried[3 * v + 1], carried[3 * v + 2]);
        CHECK((found - there).norm() < 1e-12);
    }
}
