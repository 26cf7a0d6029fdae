// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/viewer/runs.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/faults.h"
#include "tools/viewer/page_data.h"
#include "tools/viewer/shot.h"
#include "tools/viewer/shot_overlays.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

using namespace sinew;
using namespace sinew::viewer;

namespace {

Coordinates& points(ViewScene& scene, std::size_t frame) {
    return std::get<DeformingMotion>(scene.bodies[0].motion).points[frame];
}

std::string all_notes(const ViewScene& scene) {
    std::string out;
    for (const ViewNote& n : scene.notes) out += n.text + "\n";
    return out;
}

std::array<double, 3> read_back(const PageData& data, std::size_t frame, std::size_t vertex, std::size_t vertices) {
    const auto header = nlohmann::json::parse(data.header);
    for (const auto& chunk : header["bodies"][0]["motion"]["chunks"]) {
        const auto first = chunk["first"].get<std::size_t>(), count = chunk["count"].get<std::size_t>();
        if (frame < first || frame >= first + count) continue;
        const auto values = unpack_u16(data.blocks[chunk["block"].get<std::size_t>()]);
        std::array<double, 3> out{};
        for (std::size_t c = 0; c < 3; ++c)
            out[c] = chunk["origin"][c].get<double>() +
                     chunk["step"][c].get<double>() * values[3 * (vertices * (frame - first) + vertex) + c];
        return out;
    }
    FAIL("no chunk has the frame");
    return {};
}

} // namespace

TEST_CASE("frames beside one that flies apart stay within 1e-4 of the body's size") {
    constexpr std::size_t vertices = 400;
    const auto bad = GENERATE(std::size_t{0}, std::size_t{9}, std::size_t{19});
    const auto factor = GENERATE(1e2f, 1e6f, 1e17f);
    ViewScene scene = test::made_scene(vertices, 20);
    for (std::size_t i = 0; i < 3 * vertices; i += 30) points(scene, bad)[i] *= factor;
    const ViewScene before = scene;
    find_faults(scene);
    const PageData data = page_data(scene);
    for (const std::size_t f : {std::size_t{1}, std::size_t{8}, std::size_t{10}, std::size_t{18}})
        for (std::size_t v = 0; v < vertices; v += 7) {
            const auto found = read_back(data, f, v, vertices);
            const auto wanted = vertex_position(before.bodies[0], f, v);
            for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(found[c] - static_cast<double>(wanted[c])) < 1e-4 * 20);
        }
    for (std::size_t f = 0; f < 20; ++f) CHECK(scene.frames[f].faults.empty() == (f != bad));
    CHECK(all_notes(scene).find("Frame " + std::to_string(bad + 1) + ": ball reaches") != std::string::npos);
    CHECK(bounds(scene)[1][1] < 20); // the camera goes by the good frames
}

TEST_CASE("even motion keeps one grid, and an ordinary run has no faults") {
    ViewScene scene = test::made_scene(300, 30);
    find_faults(scene);
    CHECK(scene.notes.empty());
    CHECK(nlohmann::json::parse(page_data(scene).header)["bodies"][0]["motion"]["chunks"].size() == 1);
    for (const ViewFrame& f : scene.frames) CHECK(f.faults.empty());
}

TEST_CASE("a long walk of a small body is no fault of its first half, and stays exact") {
    ViewScene scene = test::made_scene(50, 40);
    for (std::size_t f = 0; f < 40; ++f)
        for (std::size_t i = 0; i < points(scene, f).size(); i += 3)
            points(scene, f)[i] += 25.0f * static_cast<float>(f);
    const ViewScene before = scene;
    find_faults(scene);
    CHECK(scene.notes.empty());
    const PageData data = page_data(scene);
    for (const std::size_t f : {std::size_t{0}, std::size_t{20}, std::size_t{39}})
        CHECK(std::abs(read_back(data, f, 7, 50)[0] - static_cast<double>(vertex_position(before.bodies[0], f, 7)[0])) <
              1e-4 * 20);
}

TEST_CASE("numbers that are none keep the vertex's last place") {
    ViewScene scene = test::made_scene(50, 4);
    points(scene, 2)[3] = NAN;
    points(scene, 2)[31] = INFINITY;
    const Coordinates before = points(scene, 1);
    find_faults(scene);
    CHECK(points(scene, 2)[3] == before[3]);
    CHECK(points(scene, 2)[31] == before[31]);
    CHECK(scene.frames[2].faults.size() == 1);
    CHECK(all_notes(scene).find("Frame 3: ball has coordinates that are no numbers") != std::string::npos);
}

TEST_CASE("most frames decide what is usual, also where every later one is ten times as far") {
    ViewScene scene = test::made_scene(50, 10);
    for (std::size_t f = 5; f < 10; ++f)
        for (float& v : points(scene, f)) v *= std::pow(10.0f, static_cast<float>(f));
    find_faults(scene);
    for (std::size_t f = 0; f < 10; ++f) CHECK(scene.frames[f].faults.empty() == (f < 5));
}

TEST_CASE("a small body that comes late counts for the bounds") {
    const test::TemporaryFolder folder;
    test::write_text(folder / "a.1.obj", "");
    test::write_text(folder / "a.2.obj", test::cube_obj(3));
    const ViewScene scene = collect_folder(folder.path());
    REQUIRE(scene.bodies.size() == 1);
    CHECK(bounds(scene) == std::array<std::array<float, 3>, 2>{{{3, 0, 0}, {4, 1, 1}}});
}

TEST_CASE("of two frames the first is believed, whichever way the second one flies") {
    for (const float far : {1e6f, -1e6f}) {
        ViewScene scene = test::made_scene(30, 2);
        for (float& c : points(scene, 1)) c += far;
        find_faults(scene);
        CHECK(scene.frames[0].faults.empty());
        CHECK_FALSE(scene.frames[1].faults.empty());
    }
}

TEST_CASE("bounds leave out frames that must not be believed, unless all are such") {
    ViewScene scene = test::made_scene(30, 3);
    const auto good = bounds(scene);
    for (float& c : points(scene, 1)) c *= 1000;
    const auto all = bounds(scene);
    CHECK(all[1][0] > 100 * good[1][0]);
    scene.frames[1].faults.push_back("ball flies apart");
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(bounds(scene)[0][c] == Approx(good[0][c]).epsilon(0.1)); // the frame between has its own part of them
        CHECK(bounds(scene)[1][c] == Approx(good[1][c]).epsilon(0.1));
    }
    for (ViewFrame& f : scene.frames) f.faults = {"x"};
    CHECK(bounds(scene) == all);
}

TEST_CASE("marks travel as seven numbers each, a block for each frame and kind") {
    ViewScene scene = test::made_scene(10, 2);
    scene.frames[1].marks = {{"field", "wind", "N/m^3", {{{1, 2, 3}, {0, 1, 0}, 0.5f}, {{4, 5, 6}, {1, 0, 0}, -0.25f}}},
                             {"pressure", "pressure", "Pa", {{{7, 8, 9}, {7, 8, 9}, 2000}}},
                             {"hold", "reaction", "N", {}}};
    const PageData data = page_data(scene);
    const auto header = nlohmann::json::parse(data.header);
    CHECK_FALSE(header["frames"][0].contains("marks"));
    const auto& groups = header["frames"][1]["marks"];
    REQUIRE(groups.size() == 2); // one has none
    CHECK(groups[0]["term"] == "field");
    CHECK(groups[0]["what"] == "wind");
    CHECK(groups[0]["unit"] == "N/m^3");
    const auto numbers = [&](std::size_t g) {
        return unpack_f32(data.blocks[groups[g]["numbers"].get<std::size_t>()]);
    };
    CHECK(numbers(0) == std::vector<float>{1, 2, 3, 0, 1, 0, 0.5f, 4, 5, 6, 1, 0, 0, -0.25f});
    CHECK(numbers(1) == std::vector<float>{7, 8, 9, 7, 8, 9, 2000});
    CHECK_FALSE(groups[0].contains("bodies"));

    scene.frames[1].marks = {{"contact", "force", "N", {{{1, 2, 3}, {0, 1, 0}, 5, {1, 0}}, {{4, 5, 6}, {1, 0, 0}, 6}}}};
    const PageData touching = page_data(scene);
    const auto group = nlohmann::json::parse(touching.header)["frames"][1]["marks"][0];
    CHECK(unpack_f32(touching.blocks[group["bodies"].get<std::size_t>()]) == std::vector<float>{1, 0, -1, -1});
}

TEST_CASE("marks that cannot be drawn are left out, and their frame is named") {
    ViewScene scene = test::made_scene(10, 3);
    for (std::size_t f = 0; f < 3; ++f)
        scene.frames[f].marks = {{"field", "wind", "N/m^3", {{{1, 2, 3}, {0, 1, 0}, 0.5f}, {{4, 5, 6}, {1, 0, 0}, 1}}}};
    scene.frames[1].marks[0].marks[0].value = NAN;
    scene.frames[2].marks[0].marks[1].to[2] = 1e30f;
    find_faults(scene);
    CHECK(scene.frames[0].marks[0].marks.size() == 2);
    CHECK(scene.frames[0].faults.empty());
    REQUIRE(scene.frames[1].marks[0].marks.size() == 1);
    CHECK(scene.frames[1].marks[0].marks[0].value == 1);
    REQUIRE(scene.frames[2].marks[0].marks.size() == 1);
    CHECK(scene.frames[2].marks[0].marks[0].value == 0.5f);
    CHECK(scene.frames[1].faults.size() == 1);
    CHECK(all_notes(scene) ==
          "Frames 2-3: marks of field, wind have coordinates or values that are no numbers or beyond "
          "any; they are left out.\n");
}

TEST_CASE("of some bodies alone the marks about others go, and the rest name them by their new places") {
    ViewScene scene = test::made_scene(10, 1);
    const ViewBody body = scene.bodies.front();
    scene.bodies.assign(4, body);
    for (std::size_t b = 0; b < 4; ++b) scene.bodies[b].name = std::string(1, static_cast<char>('a' + b));
    const auto mark = [](float value, int of, int in) { return ViewMark{{1, 2, 3}, {1, 2, 4}, value, {of, in}}; };
    scene.frames[0].marks = {
        {"contact", "force", "N", {mark(1, 0, 1), mark(2, 1, 3), mark(3, 3, 3), mark(4, 2, 1), mark(5, -1, -1)}}};
    keep_bodies(scene, {1, 3});
    REQUIRE(scene.bodies.size() == 2);
    CHECK(scene.bodies[0].name == "b");
    CHECK(scene.bodies[1].name == "d");
    const std::vector<ViewMark>& left = scene.frames[0].marks[0].marks;
    REQUIRE(left.size() == 5);
    CHECK(left[0].bodies == std::array{-1, 0});
    CHECK(left[1].bodies == std::array{0, 1});
    CHECK(left[2].bodies == std::array{1, 1});
    CHECK(left[3].bodies == std::array{-1, 0});
    CHECK(left[4].bodies == std::array{-1, -1});
    keep_bodies(scene, {1}); // "d"
    REQUIRE(left.size() == 3);
    CHECK(left[0].value == 2);
    CHECK(left[1].value == 3);
    CHECK(left[2].value == 5);
}

TEST_CASE("pictures draw marks in the colours of their unit's range over the frames without faults") {
    ViewScene scene = test::made_scene(10, 3);
    const auto arrow = [](float value) {
        return std::vector<ViewMarks>{{"field", "wind", "N/m^3", {{{1, 0, 0}, {1, 2, 0}, value}}}};
    };
    scene.frames[0].marks = arrow(5), scene.frames[1].marks = arrow(10), scene.frames[2].marks = arrow(1e6f);
    scene.frames[2].faults.push_back("ball flies far away");
    // A point, in another unit: its range is its own.
    scene.frames[0].marks.push_back({"pressure", "pressure", "Pa", {{{3, 3, 3}, {3, 3, 3}, 7}}});
    const auto lines = overlay_segments(scene, 0, {"marks"});
    REQUIRE(lines.size() == 3); // the arrow, its dot, and the point's dot
    CHECK((lines[0].from == solver::Vec3(1, 0, 0)));
    CHECK((lines[0].to == solver::Vec3(1, 2, 0)));
    CHECK((lines[1].from == lines[1].to));
    CHECK((lines[2].from == solver::Vec3(3, 3, 3)));
    // Half of the scale is #f5bb2e, its end #a3157d.
    const auto srgb = [](unsigned hex) {
        const auto c = [&](unsigned shift) { return render::to_linear(static_cast<float>(hex >> shift & 255) / 255); };
        return Eigen::Vector3f(c(16), c(8), c(0));
    };
    CHECK((lines[0].colour - srgb(0xf5bb2e)).norm() < 1e-5f);
    CHECK((lines[2].colour - srgb(0xa3157d)).norm() < 1e-5f);
    CHECK((overlay_segments(scene, 1, {"marks"})[0].colour - srgb(0xa3157d)).norm() < 1e-5f);
    CHECK(overlay_segments(scene, 0, {"attachments"}).empty());
}
