// Animated GLB files: valid by an independent reader, and every frame comes back where it was.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "tests/tools/glb_checker.h"
#include "tools/cli/glb.h"
#include "tools/cli/rigid_motion.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>

using namespace sinew;
using cli::AnimatedBody;
using cli::Animation;
using solver::Points;
using solver::Vec3;

namespace {

std::shared_ptr<const Points> share(Points p) { return std::make_shared<const Points>(std::move(p)); }

Points turned(const Points& points, double angle, const Vec3& shift) {
    const Eigen::AngleAxisd r(angle, Vec3(1, 2, 3).normalized());
    Points out;
    for (const Vec3& p : points) out.push_back(r * p + shift);
    return out;
}

Points squashed(const Points& points, double amount) {
    Points out;
    for (const Vec3& p : points)
        out.emplace_back(p[0] * (1 + amount), p[1] * (1 - amount), p[2] + amount * p[0] * p[0]);
    return out;
}

/// Frames 1, 2, 4 at 24 fps, in centimetres: a bone that turns, a muscle that changes shape, a body at rest.
Animation sample() {
    const solver::SurfaceMesh cube = solver::make_cube(10, 20, 30, 1, 1, 1), ball = solver::make_sphere(8, 12, 8);
    Animation a;
    a.frames = {1, 2, 4};
    a.units_per_metre = 100;
    a.bodies.push_back({"bone", render::BodyKind::bone, cube.triangles, {}});
    a.bodies.push_back({"muscle", render::BodyKind::tissue, ball.triangles, {}});
    a.bodies.push_back({"still", render::BodyKind::plain, ball.triangles, {}});
    for (int f = 0; f < 3; ++f) {
        a.bodies[0].poses.push_back(share(turned(cube.points, 1.3 * f, Vec3(5.0 * f, 100, -f))));
        a.bodies[1].poses.push_back(share(squashed(ball.points, 0.1 * f)));
        a.bodies[2].poses.push_back(share(ball.points));
    }
    return a;
}

const nlohmann::json* channel_of(const nlohmann::json& animation, std::size_t node, const std::string& path) {
    for (const auto& channel : animation.at("channels"))
        if (channel.at("target").at("node") == node && channel.at("target").at("path") == path) return &channel;
    return nullptr;
}

int output_of(const nlohmann::json& animation, const nlohmann::json& channel) {
    return animation.at("samplers").at(channel.at("sampler").get<std::size_t>()).at("output");
}

Vec3 vertex(const std::vector<float>& values, std::size_t i) {
    return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// Distance of `p` [m] to the nearest of `points` [cm].
double distance_to(const Points& points, const Vec3& p) {
    double least = INFINITY;
    for (const Vec3& q : points) least = std::min(least, (q / 100 - p).norm());
    return least;
}

} // namespace

TEST_CASE("a GLB file keeps the rules of glTF 2.0", "[tools]") {
    const test::Glb glb(cli::encode_glb(sample()));
    CHECK(glb.problems() == std::vector<std::string>{});
    CHECK(glb.document.at("meshes").size() == 3);
    CHECK(glb.document.at("materials").size() == 3);
    for (const char* name : {"bone", "muscle", "still"}) {
        bool found = false;
        for (const auto& node : glb.document.at("nodes")) found = found || node.at("name") == name;
        CHECK(found);
    }
}

TEST_CASE("a rigid body becomes an animated node, a deforming one gets a target a frame, a still one nothing",
          "[tools]") {
    const test::Glb glb(cli::encode_glb(sample()));
    const auto& animation = glb.document.at("animations").at(0);
    CHECK(channel_of(animation, 0, "translation"));
    CHECK(channel_of(animation, 0, "rotation"));
    CHECK_FALSE(channel_of(animation, 0, "weights"));
    CHECK(channel_of(animation, 1, "weights"));
    CHECK_FALSE(channel_of(animation, 1, "rotation"));
    for (const char* path : {"translation", "rotation", "weights"}) CHECK_FALSE(channel_of(animation, 2, path));
    CHECK(glb.document.at("meshes").at(1).at("primitives").at(0).at("targets").size() == 2);
    CHECK(glb.document.at("meshes").at(1).at("extras").at("targetNames") == nlohmann::json({"frame 2", "frame 4"}));
}

TEST_CASE("a rigid body's vertices come back in metres at every frame", "[tools]") {
    const Animation a = sample();
    const test::Glb glb(cli::encode_glb(a));
    const auto& animation = glb.document.at("animations").at(0);
    const auto base =
        glb.floats(glb.document.at("meshes").at(0).at("primitives").at(0).at("attributes").at("POSITION"));
    const auto translations = glb.floats(output_of(animation, *channel_of(animation, 0, "translation")));
    const auto rotations = glb.floats(output_of(animation, *channel_of(animation, 0, "rotation")));
    CHECK(base.size() / 3 == 24); // the cube's corners are split: three normals each
    for (std::size_t f = 0; f < 3; ++f) {
        const Eigen::Quaterniond q(rotations[4 * f + 3], rotations[4 * f], rotations[4 * f + 1], rotations[4 * f + 2]);
        for (std::size_t v = 0; v < base.size() / 3; ++v)
            CHECK(distance_to(*a.bodies[0].poses[f], q * vertex(base, v) + vertex(translations, f)) < 1e-6);
    }
}

TEST_CASE("base plus target is the frame's shape, and weights pick one target a frame", "[tools]") {
    const Animation a = sample();
    const test::Glb glb(cli::encode_glb(a));
    const auto& primitive = glb.document.at("meshes").at(1).at("primitives").at(0);
    const auto base = glb.floats(primitive.at("attributes").at("POSITION"));
    REQUIRE(base.size() / 3 == a.bodies[1].poses[0]->size());
    for (std::size_t f = 1; f < 3; ++f) {
        const auto delta = glb.floats(primitive.at("targets").at(f - 1).at("POSITION"));
        for (std::size_t v = 0; v < base.size() / 3; ++v)
            CHECK((vertex(base, v) + vertex(delta, v) - (*a.bodies[1].poses[f])[v] / 100).norm() < 1e-7);
    }
    const auto& animation = glb.document.at("animations").at(0);
    CHECK(glb.floats(output_of(animation, *channel_of(animation, 1, "weights"))) ==
          std::vector<float>{0, 0, 1, 0, 0, 1});
}

TEST_CASE("times are those of the frames", "[tools]") {
    const test::Glb glb(cli::encode_glb(sample()));
    const auto& samplers = glb.document.at("animations").at(0).at("samplers");
    CHECK(glb.floats(samplers.at(0).at("input")) == std::vector<float>{0.0f, 1 / 24.0f, 3 / 24.0f});
}

TEST_CASE("one frame gives a still file, no body an empty scene, z up a turned one", "[tools]") {
    Animation one = sample();
    one.frames.resize(1);
    for (AnimatedBody& body : one.bodies) body.poses.resize(1);
    const test::Glb still(cli::encode_glb(one));
    CHECK(still.problems() == std::vector<std::string>{});
    CHECK_FALSE(still.document.contains("animations"));

    const test::Glb empty(cli::encode_glb({}));
    CHECK(empty.problems() == std::vector<std::string>{});
    CHECK(empty.binary.empty());

    one.up = 'z';
    const test::Glb upright(cli::encode_glb(one));
    CHECK(upright.problems() == std::vector<std::string>{});
    const auto& root =
        upright.document.at("nodes").at(upright.document.at("scenes").at(0).at("nodes").at(0).get<std::size_t>());
    const auto r = root.at("rotation").get<std::vector<double>>();
    const Vec3 up = Eigen::Quaterniond(r[3], r[0], r[1], r[2]) * Vec3(0, 0, 1);
    CHECK((up - Vec3(0, 1, 0)).norm() < 1e-12);
}

TEST_CASE("the same run gives the same bytes", "[tools]") {
    CHECK(cli::encode_glb(sample()) == cli::encode_glb(sample()));
}

TEST_CASE("a rigid motion is found to rounding, and a change of shape is not taken for one", "[tools]") {
    const Points rest = solver::make_sphere(3, 10, 7).points;
    const auto motion = cli::find_rigid_motion(
        {share(rest), share(turned(rest, 3.0, Vec3(1, -4, 2))), share(turned(rest, 6.0, Vec3(0, 0, 0)))});
    REQUIRE(motion);
    CHECK(motion->moves);
    for (std::size_t f = 1; f < 3; ++f) {
        const Points now = turned(rest, 3.0 * static_cast<double>(f), f == 1 ? Vec3(1, -4, 2) : Vec3(0, 0, 0));
        for (std::size_t v = 0; v < rest.size(); ++v)
            CHECK(
                (motion->poses[f].translation + motion->poses[f].rotation * (rest[v] - motion->pivot) - now[v]).norm() <
                1e-12);
        CHECK(motion->poses[f].rotation.dot(motion->poses[f - 1].rotation) >= 0);
    }
    CHECK_FALSE(cli::find_rigid_motion({share(rest), share(squashed(rest, 1e-3))}));
    Points mirrored;
    for (const Vec3& p : squashed(rest, 0.3)) mirrored.emplace_back(-p[0], p[1], p[2]);
    CHECK_FALSE(cli::find_rigid_motion({share(squashed(rest, 0.3)), share(mirrored)}));
}
