// Animated GLB files: valid by an independent reader, and every frame comes back where it was.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/diagnostics.h"
#include "engine/digest.h"
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "tests/tools/file_size_limit.h"
#include "tests/tools/glb_animation.h"
#include "tests/tools/glb_checker.h"
#include "tools/cli/rigid_motion.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <optional>

using namespace sinew;
using solver::Points;
using solver::Vec3;
using test::AnimatedBody;
using test::Animation;

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
    const test::Glb glb(test::encode_glb(sample()));
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
    const test::Glb glb(test::encode_glb(sample()));
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
    const test::Glb glb(test::encode_glb(a));
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
    const test::Glb glb(test::encode_glb(a));
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
    const test::Glb glb(test::encode_glb(sample()));
    const auto& samplers = glb.document.at("animations").at(0).at("samplers");
    CHECK(glb.floats(samplers.at(0).at("input")) == std::vector<float>{0.0f, 1 / 24.0f, 3 / 24.0f});
}

TEST_CASE("one frame gives a still file, no body an empty scene, z up a turned one", "[tools]") {
    Animation one = sample();
    one.frames.resize(1);
    for (AnimatedBody& body : one.bodies) body.poses.resize(1);
    const test::Glb still(test::encode_glb(one));
    CHECK(still.problems() == std::vector<std::string>{});
    CHECK_FALSE(still.document.contains("animations"));

    // Without triangles there is nothing to show, but the frames are told.
    Animation points = one;
    for (AnimatedBody& body : points.bodies) body.triangles.clear();
    const test::Glb empty(test::encode_glb(points));
    CHECK(empty.problems() == std::vector<std::string>{});
    CHECK(empty.binary.empty());
    CHECK(empty.document.at("scenes").at(0).at("extras").at("sinew").at("frames") == nlohmann::json({1}));
    CHECK(test::encode_glb({}).empty());

    one.up = 'z';
    const test::Glb upright(test::encode_glb(one));
    CHECK(upright.problems() == std::vector<std::string>{});
    const auto& root =
        upright.document.at("nodes").at(upright.document.at("scenes").at(0).at("nodes").at(0).get<std::size_t>());
    const auto r = root.at("rotation").get<std::vector<double>>();
    const Vec3 up = Eigen::Quaterniond(r[3], r[0], r[1], r[2]) * Vec3(0, 0, 1);
    CHECK((up - Vec3(0, 1, 0)).norm() < 1e-12);
}

TEST_CASE("the same run gives the same bytes", "[tools]") {
    CHECK(test::encode_glb(sample()) == test::encode_glb(sample()));
}

TEST_CASE("a rigid motion is found to rounding, and a change of shape is not taken for one", "[tools]") {
    const Points rest = solver::make_sphere(3, 10, 7).points;
    cli::RigidFit fit(rest);
    REQUIRE(fit.add(rest));
    Eigen::Quaterniond before = Eigen::Quaterniond::Identity();
    for (int f = 1; f < 3; ++f) {
        const Points now = turned(rest, 3.0 * f, f == 1 ? Vec3(1, -4, 2) : Vec3(0, 0, 0));
        const auto pose = fit.add(now);
        REQUIRE(pose);
        for (std::size_t v = 0; v < rest.size(); ++v)
            CHECK((pose->translation + pose->rotation * (rest[v] - fit.pivot()) - now[v]).norm() < 1e-12);
        CHECK(pose->rotation.dot(before) >= 0);
        before = pose->rotation;
    }
    CHECK_FALSE(fit.add(squashed(rest, 1e-3)));
    Points mirrored;
    for (const Vec3& p : squashed(rest, 0.3)) mirrored.emplace_back(-p[0], p[1], p[2]);
    CHECK_FALSE(cli::RigidFit(squashed(rest, 0.3)).add(mirrored));
}

namespace {

/// A plane that bends and one that stays, of numbers that binary fractions hold: no rounding, so any machine and any
/// order of summation gives the same bytes.
Animation dyadic() {
    Animation a;
    a.frames = {1, 2, 5};
    a.fps = 8, a.units_per_metre = 2;
    const std::vector<solver::Triangle> square{{0, 1, 2}, {0, 2, 3}};
    a.bodies.push_back({"bends", render::BodyKind::tissue, square, {}});
    a.bodies.push_back({"stays", render::BodyKind::bone, square, {}});
    for (const double z : {0.0, 0.0, 0.75}) {
        const Points still{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        Points bent = still;
        for (Vec3& p : bent) p *= 1 + z; // normals stay
        a.bodies[0].poses.push_back(share(bent));
        a.bodies[1].poses.push_back(share(still));
    }
    return a;
}

} // namespace

TEST_CASE("a GLB holds what it held when poses were kept in memory", "[tools]") {
    test::Glb glb(test::encode_glb(dyadic()));
    glb.document.at("asset").erase("generator"); // the version
    glb.document.erase("materials");             // colours come from powers, which mathematical libraries round
    // Of commit c2d7364.
    CHECK(engine::Hasher().add(glb.document.dump()).add(glb.binary).finish().hex() ==
          "86661a6edc6ead67fba7b92c73377cfb");
}

TEST_CASE("a body that deforms late, and one that stands still for long, come back at every frame", "[tools]") {
    Animation a = sample();
    const Points rest = *a.bodies[2].poses[0];
    a.frames.clear();
    for (AnimatedBody& body : a.bodies) body.poses.clear();
    const solver::SurfaceMesh cube = solver::make_cube(10, 20, 30, 1, 1, 1);
    for (int f = 0; f < 12; ++f) {
        a.frames.push_back(3 * f);
        a.bodies[0].poses.push_back(share(turned(cube.points, 0.2 * f, Vec3(f, 0, 0))));
        a.bodies[1].poses.push_back(share(f < 8 ? turned(rest, 0.1 * f, Vec3(0, f, 0)) : squashed(rest, 0.01 * f)));
        a.bodies[2].poses.push_back(share(f < 4 ? rest : f < 9 ? squashed(rest, 0.1) : rest));
    }
    const test::Glb glb(test::encode_glb(a));
    CHECK(glb.problems() == std::vector<std::string>{});
    for (const std::size_t b : {std::size_t{1}, std::size_t{2}}) {
        const auto& primitive = glb.document.at("meshes").at(b).at("primitives").at(0);
        const auto base = glb.floats(primitive.at("attributes").at("POSITION"));
        REQUIRE(primitive.at("targets").size() == 11);
        for (std::size_t f = 1; f < 12; ++f) {
            const auto delta = glb.floats(primitive.at("targets").at(f - 1).at("POSITION"));
            for (std::size_t v = 0; v < base.size() / 3; ++v)
                CHECK((vertex(base, v) + vertex(delta, v) - (*a.bodies[b].poses[f])[v] / 100).norm() < 1e-7);
        }
    }
}

TEST_CASE("a frame that not all bodies have stays out, and what they did in it does not count", "[tools]") {
    const test::TemporaryFolder folder;
    Animation a = sample();
    const auto write = [&](const char* name, bool with_half_a_frame) {
        cli::GlbFile glb(folder / name, {a.fps, a.units_per_metre, a.up});
        for (std::size_t b = 0; b < 3; ++b)
            glb.add_body(a.bodies[b].name, a.bodies[b].kind, a.bodies[b].triangles, a.bodies[b].poses[0]);
        for (std::size_t f = 0; f < 3; ++f)
            for (std::size_t b = 0; b < 3; ++b) glb.add_pose(b, a.frames[f], a.bodies[b].poses[f]);
        if (with_half_a_frame) { // the bone has another shape in it
            glb.add_pose(0, 9, share(squashed(*a.bodies[0].poses[0], 0.5)));
            glb.add_pose(1, 9, a.bodies[1].poses[0]);
        }
        CHECK(glb.finish());
        return test::read_text(folder / name);
    };
    CHECK(write("half.glb", true) == write("whole.glb", false));
}

TEST_CASE("a pose that finds no room on disk has not been added, and the frames before it are written", "[tools]") {
    const test::TemporaryFolder folder;
    Animation a = sample();
    a.bodies.pop_back(); // the muscle is the last one: all bodies before it have the frame that fails
    cli::GlbFile glb(folder / "run.glb", {a.fps, a.units_per_metre, a.up});
    std::size_t bytes = 0; // of a frame
    for (const AnimatedBody& body : a.bodies) {
        glb.add_body(body.name, body.kind, body.triangles, body.poses[0]);
        bytes += sizeof(Vec3) * body.poses[0]->size();
    }
    for (std::size_t f = 0; f < 2; ++f)
        for (std::size_t b = 0; b < 2; ++b) glb.add_pose(b, a.frames[f], a.bodies[b].poses[f]);
    {
        const test::FileSizeLimit full(2 * bytes - 100); // the first frame does not wait there
        glb.add_pose(0, a.frames[2], a.bodies[0].poses[2]);
        try {
            glb.add_pose(1, a.frames[2], a.bodies[1].poses[2]);
            FAIL("is refused");
        } catch (const engine::Failure& failure) {
            CHECK(failure.diagnostics().front().code == "IO405");
        }
    }
    CHECK(glb.finish());
    a.frames.pop_back();
    for (AnimatedBody& body : a.bodies) body.poses.pop_back();
    CHECK(test::read_text(folder / "run.glb") == test::encode_glb(a));
}

TEST_CASE("poses wait on disk in a file without a name, and nothing is left of them", "[tools]") {
    const test::TemporaryFolder folder;
    const auto entries = [&] {
        return std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator());
    };
    const Animation a = sample();
    cli::GlbFile glb(folder / "run.glb", {});
    glb.add_body("muscle", render::BodyKind::tissue, a.bodies[1].triangles, a.bodies[1].poses[0]);
    for (std::size_t f = 0; f < 3; ++f) glb.add_pose(0, a.frames[f], a.bodies[1].poses[f]);
    CHECK(a.bodies[1].poses[1].use_count() == 1); // the writer holds the first and the last pose only
    CHECK(entries() == 0);
    CHECK(glb.finish());
    CHECK(entries() == 1);
}

TEST_CASE("sizes of a GLB are known before it is written", "[tools]") {
    const Animation a = sample();
    std::vector<cli::GlbCost> costs;
    for (const AnimatedBody& body : a.bodies) costs.push_back(cli::glb_cost(body.kind, *body.poses[0], body.triangles));
    CHECK(costs[0].shading_vertices == 24); // a cube's corners, once a face
    CHECK_FALSE(costs[0].deforms);
    CHECK(costs[1].deforms);
    const auto file = static_cast<double>(test::encode_glb(a).size());
    CHECK(cli::glb_size(costs, 3) < file);
    CHECK(cli::glb_size(costs, 3) > 0.5 * file); // small bodies: most of the rest is the document
    // By hand: positions and normals of 12 bytes each, triangles of 12; a deforming body has them again for each frame
    // but the first, with 400 bytes of text; and once a time for each frame, and a weight for each frame and target.
    CHECK(cli::glb_size({{100, 50, false}}, 3) == 2400 + 600);
    CHECK(cli::glb_size({{100, 50, true}}, 3) == 2400 + 600 + 2 * (2400 + 400) + 4 * 3 + 4 * 3 * 2);
    CHECK(cli::glb_size({{100, 50, true}, {10, 5, false}, {7, 0, true}}, 1) == 2400 + 600 + 240 + 60 + 4);
    // A million vertices, 24 bytes each and frame: 178 frames are 4.27 GB, the limit is 4.29.
    const std::vector<cli::GlbCost> large{{1'000'000, 1'000'000, true}};
    CHECK_NOTHROW(cli::check_glb_size(large, 178));
    try {
        cli::check_glb_size(large, 1000);
        FAIL("is refused");
    } catch (const engine::Failure& failure) {
        CHECK(failure.diagnostics().front().code == "IO405");
        CHECK(failure.diagnostics().front().hint.find("at most 178 frames fit") == 0);
    }
    CHECK_NOTHROW(cli::check_glb_size({{1'000'000, 1'000'000, false}}, 100'000));
}
