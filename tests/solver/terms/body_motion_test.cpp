// Contact: what a body's surface sweeps, as someone sees it who moves along with the body.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/body_motion.h"
#include "solver/terms/contact/collision_bodies.h"
#include "solver/terms/contact/contact.h"
#include "tests/support/solver_scenes.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// A block of edge 2 whose top and bottom rise at 45 degrees along x, from z = x to z = x + 2.
struct Slanted {
    std::unique_ptr<Scene> scene;
    std::unique_ptr<CollisionBodies> bodies;
    const Vec3 up = Vec3(-1, 0, 1).normalized(), on_top = Vec3(1, 1, 3); ///< the top's normal; its middle
    Slanted() {
        TetMesh mesh = box_mesh({2, 2, 2}, 2, 2, 2);
        for (Vec3& p : mesh.vertices) p.z() += p.x();
        SceneDescription d;
        d.bodies.emplace_back(tissue(mesh, ElasticLaw::stvk));
        d.parts.push_back({&contact_type, {0}, std::make_shared<ContactRest>()});
        scene = std::make_unique<Scene>(d);
        bodies = std::make_unique<CollisionBodies>(*scene);
    }
    const CollisionBody& body() const { return (*bodies)[0]; }
};

} // namespace

TEST_CASE("body motion: a point is near a triangle that its way, against that triangle's own, leads to", "[contact]") {
    const Slanted block;
    const Points& from = block.body().modelled();
    BodyMotion motion;
    motion.set(from, from);
    motion.fit_boxes(block.body(), from);
    const Vec3 above = block.on_top + 0.2 * block.up;
    SECTION("at rest within the distance alone, though boxes about slanted triangles reach farther") {
        CHECK_FALSE(motion.meets(above, above, 0.199));
        CHECK(motion.meets(above, above, 0.201));
    }
    SECTION("on its way by as much as that leads towards it") {
        CHECK_FALSE(motion.meets(above, above - 0.15 * block.up, 0.049));
        CHECK(motion.meets(above, above - 0.15 * block.up, 0.051));
    }
    SECTION("right through the body") { CHECK(motion.meets(above, above - 9 * block.up, 0)); }
}

TEST_CASE("body motion: what moves along with a body stays where it was", "[contact]") {
    const Slanted block;
    const Points& from = block.body().modelled();
    const Eigen::Isometry3d move = Eigen::Translation3d(7, -3, 2) * Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized());
    Points to = from;
    for (Vec3& p : to) p = move * p;
    BodyMotion motion;
    motion.set(from, to);
    motion.fit_boxes(block.body(), from);
    CHECK(motion.farthest() < 1e-14);
    CHECK(motion.farthest_way(from, to) < 1e-14);
    const Vec3 above = block.on_top + 0.2 * block.up;
    CHECK((motion.seen(move * above) - above).norm() < 1e-14);
    CHECK_FALSE(motion.meets(above, motion.seen(move * above), 0.199));
    CHECK(motion.meets(above, motion.seen(move * above), 0.201));
    // One corner is .3 off: so is the farthest of its places.
    Points other = to;
    other[0] += 0.3 * Vec3(0, 0.6, 0.8);
    CHECK(motion.farthest_way(from, other) == Approx(0.3).epsilon(1e-12));
}

TEST_CASE("body motion: a part that bulges on its own meets what is above it", "[contact]") {
    const Slanted block;
    const Points& from = block.body().modelled();
    // The middle of the top rises by .5: the rest of the body says what stands still, nearly.
    Points to = from;
    std::size_t raised = 0;
    for (Vec3& p : to)
        if ((p - block.on_top).norm() < 1e-12) p += 0.5 * block.up, ++raised;
    REQUIRE(raised == 1);
    BodyMotion motion;
    motion.set(from, to);
    motion.fit_boxes(block.body(), from);
    const Vec3 above = block.on_top + 0.45 * block.up, beside = above + Vec3(0, 4, 0);
    CHECK(motion.meets(above, motion.seen(above), 0));
    CHECK_FALSE(motion.meets(beside, motion.seen(beside), 0.4));
}
