// Contact near edges of a surface: folds that tell no inside from outside, and dents in which points come to rest.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact.h"
#include "tests/support/contact_parts.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

namespace {

/// A block of 2 x 2 x 2 whose top, at y = 0, has a notch along z, so wide at the top to either side and so deep. It is
/// cut along z into `cuts` strips.
std::shared_ptr<BoneRest> notched(double width, double depth, int cuts = 1) {
    const Vec3 outline[] = {{-1, 0, 0}, {-width, 0, 0}, {0, -depth, 0}, {width, 0, 0},
                            {1, 0, 0},  {1, -2, 0},     {-1, -2, 0}};
    constexpr int n = 7;
    Points points;
    for (int k = 0; k <= cuts; ++k)
        for (const Vec3& p : outline) points.push_back(p + Vec3(0, 0, -1 + 2.0 * k / cuts));
    std::vector<Triangle> triangles;
    for (int k = 0; k < cuts; ++k)
        for (int i = 0; i < n; ++i) {
            const int a = n * k + i, b = n * k + (i + 1) % n;
            triangles.push_back({a, a + n, b}), triangles.push_back({b, a + n, b + n});
        }
    for (const Triangle& t :
         {Triangle{0, 1, 6}, Triangle{1, 2, 6}, Triangle{2, 5, 6}, Triangle{2, 3, 5}, Triangle{3, 4, 5}}) {
        triangles.push_back(t); // at the lower z the outline goes the right way round
        triangles.push_back({t[0] + n * cuts, t[2] + n * cuts, t[1] + n * cuts});
    }
    return bone(points, triangles);
}

struct Pressed {
    std::shared_ptr<const Scene> scene;
    StepInputs in = still_inputs();
    State state;

    Pressed(const TetMesh& mesh, const std::shared_ptr<BoneRest>& block, const TissueInputs& values, double stiffness) {
        SceneDescription description;
        description.bodies = {tissue(mesh, ElasticLaw::neo_hookean), block};
        in.bodies = {values, BoneInputs{block->surface}};
        ContactValues contact;
        contact.stiffness = stiffness;
        let_collide(description, in, 2, contact);
        scene = std::make_shared<const Scene>(description);
        state = initial_state(*scene, in);
    }
    int step() {
        Workspace workspace(scene);
        state = advance(workspace, state, std::span(&in, 1));
        REQUIRE(state.record.converged);
        return state.record.newton_iterations;
    }
    double measured(const char* name) const { return value_of(state.record.measured, "contact", name); }
};

} // namespace

TEST_CASE("contact: by the bottom of a crack a point is as deep as below the nearer wall's plane", "[contact]") {
    // Heavy, so that it hardly moves. Below the notch, whose bottom is at y = -0.2, that is the nearest place of all.
    TetMesh cube = box_mesh(Vec3::Constant(0.04), 1, 1, 1);
    for (Vec3& p : cube.vertices) p += Vec3(-0.02, -0.3, -0.02);
    Pressed wide(cube, notched(0.12, 0.2), material(1e5, 0.3, 1e9), 1e4);
    wide.step();
    CHECK(wide.measured("max_depth_m") == Approx(std::hypot(0.02, 0.1)).epsilon(1e-3));
    // 17 degrees: faces that are folded so far back tell nothing of inside, for which the whole way would count at
    // once.
    Pressed narrow(cube, notched(0.03, 0.2), material(1e5, 0.3, 1e9), 1e4);
    narrow.step();
    const double length = std::hypot(0.03, 0.2);
    CHECK(narrow.measured("max_depth_m") == Approx((0.02 * 0.2 + 0.1 * 0.03) / length).epsilon(1e-3));
}

TEST_CASE("contact: a bar comes to rest with its edge in a flat dent without going to and fro over that", "[contact]") {
    // It stands on its edge, a little beside the bottom of a dent of 170 degrees, and gravity is not quite level.
    constexpr double deep = 0.0866;
    TetMesh bar = box_mesh({0.1, 0.1, 0.4}, 2, 2, 8);
    const double turn = std::sqrt(0.5);
    for (Vec3& p : bar.vertices) p = Vec3(turn * (p.x() - p.y()) + 0.003, turn * (p.x() + p.y()) - deep, p.z() - 0.2);
    Pressed rest(bar, notched(0.99, deep, 5), material(2e4, 0.3, 1000), 3e8);
    rest.in.gravity = Vec3(1, -9.8, 0);
    rest.in.step_size = 0.1;
    rest.step(), rest.step();
    CHECK(rest.step() == 6); // with nothing kept to edges 15, with those alone that a refused trial ends on 7
}
