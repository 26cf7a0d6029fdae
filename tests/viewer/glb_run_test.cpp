// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/glb_animation.h"
#include "tests/viewer/runs.h"
#include "tools/viewer/collect_glb.h"

#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>

using namespace sinew;
using namespace sinew::viewer;

namespace {

solver::Points cube(double x, double squash) {
    solver::Points out;
    for (int i = 0; i < 8; ++i) out.emplace_back(x + (i & 1), squash * (i >> 1 & 1), i >> 2);
    return out;
}

/// A cube that travels and turns not at all, and one that is squashed.
test::Animation animation() {
    const std::vector<solver::Triangle> sides{{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                              {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    test::Animation out;
    out.fps = 30, out.units_per_metre = 10, out.up = 'z', out.frames = {3, 4, 7};
    test::AnimatedBody bone{"mover", render::BodyKind::bone, sides, {}},
        flesh{"soft", render::BodyKind::tissue, sides, {}};
    for (int f = 0; f < 3; ++f) {
        bone.poses.push_back(std::make_shared<solver::Points>(cube(2.5 * f, 1)));
        flesh.poses.push_back(std::make_shared<solver::Points>(cube(0, 1 - 0.2 * f)));
    }
    out.bodies = {bone, flesh};
    return out;
}

} // namespace

TEST_CASE("a run comes back from its GLB: frames, units, bodies and places") {
    const test::TemporaryFolder folder;
    const auto file = folder / "run.glb";
    test::write_text(file, test::encode_glb(animation()));
    CHECK(find_glb(folder.path()) == file);
    const GlbRun run(file);
    CHECK(run.frames().numbers == std::set<int>{3, 4, 7});
    CHECK(run.frames().fps == 30);
    CHECK(run.frames().units_per_metre == 10);
    CHECK(run.frames().up == 'z');
    std::vector<ViewNote> notes;
    const std::vector<ViewBody> bodies = run.bodies({4, 7}, notes);
    CHECK(notes.empty());
    REQUIRE(bodies.size() == 2);
    CHECK(bodies[0].name == "mover");
    CHECK(bodies[0].kind == render::BodyKind::bone);
    CHECK(bodies[1].kind == render::BodyKind::tissue);
    for (const ViewBody& body : bodies) {
        CHECK(body.vertex_count() == 8); // welded again
        CHECK(body.triangles.size() == 12);
    }
    CHECK(std::holds_alternative<RigidMotion>(bodies[0].motion));
    const auto highest = [&](std::size_t b, std::size_t frame, std::size_t axis) {
        float most = -1e9f;
        for (std::size_t v = 0; v < 8; ++v) most = std::max(most, vertex_position(bodies[b], frame, v)[axis]);
        return most;
    };
    CHECK(highest(0, 0, 0) == Approx(3.5).epsilon(1e-5));
    CHECK(highest(0, 1, 0) == Approx(6).epsilon(1e-5));
    CHECK(highest(1, 0, 1) == Approx(0.8).epsilon(1e-5));
    CHECK(highest(1, 1, 1) == Approx(0.6).epsilon(1e-5));
}

TEST_CASE("a file of a million frames is read in one go, not a million times") {
    const test::TemporaryFolder folder;
    test::Animation one = animation();
    one.frames = {3};
    for (test::AnimatedBody& body : one.bodies) body.poses.resize(1);
    std::string text = test::encode_glb(one), frames = "\"frames\":[3";
    const std::size_t at = text.find("\"frames\":[3]");
    for (int f = 4; f < 1'000'000; ++f) frames += "," + std::to_string(f);
    frames += "]";
    while (frames.size() % 4 != 0) frames += ' '; // as before: chunks are whole words
    text.replace(at, 12, frames);
    for (const std::size_t place : {std::size_t{8}, std::size_t{12}}) {
        std::uint32_t length = 0;
        std::memcpy(&length, text.data() + place, 4);
        length += static_cast<std::uint32_t>(frames.size() - 12);
        std::memcpy(text.data() + place, &length, 4);
    }
    test::write_text(folder / "run.glb", text);
    const GlbRun run(folder / "run.glb");
    CHECK(run.frames().numbers.size() == 999'997);
    std::vector<ViewNote> notes;
    const std::vector<int> all(run.frames().numbers.begin(), run.frames().numbers.end());
    const std::vector<ViewBody> bodies = run.bodies(all, notes);
    REQUIRE(bodies.size() == 2);
    CHECK(std::get<RigidMotion>(bodies[0].motion).poses.size() == all.size());
}

TEST_CASE("files that are no GLB, cut off or not of Sinew are refused with a reason") {
    const test::TemporaryFolder folder;
    const auto file = folder / "run.glb";
    const std::string whole = test::encode_glb(animation());
    const auto reason = [&](const std::string& bytes) {
        test::write_text(file, bytes);
        try {
            std::vector<ViewNote> notes;
            GlbRun(file).bodies({3}, notes);
        } catch (const std::runtime_error& e) {
            return std::string(e.what());
        }
        return std::string("fine");
    };
    CHECK(reason(whole) == "fine");
    CHECK(reason("") == "it is no GLB file");
    CHECK(reason(whole.substr(0, whole.size() / 2)) == "it ends in the middle");
    for (std::size_t cut = 20; cut < whole.size(); cut += 97) CHECK(reason(whole.substr(0, cut)) != "fine");
    std::string other = whole;
    other.replace(other.find("\"sinew\":{"), 9, "\"sonew\":{");
    CHECK(reason(other).find("which frames") != std::string::npos);
    // An accessor that says it has 1e15 times as many numbers: refused before room is made for them.
    std::string huge = whole;
    const std::size_t count = huge.find("\"count\":") + 8, grown = 16; // whole words: chunks are padded to four bytes
    huge.insert(huge.find_first_not_of("0123456789", count), grown - 1, '0').insert(count, " ");
    for (const std::size_t at : {std::size_t{8}, std::size_t{12}}) {
        std::uint32_t length = 0;
        std::memcpy(&length, huge.data() + at, 4);
        length += grown;
        std::memcpy(huge.data() + at, &length, 4);
    }
    CHECK(reason(huge).find("reaches beyond the file's numbers") != std::string::npos);
}
