// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/viewer/runs.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/recorder.h"

#include <catch2/catch.hpp>

using namespace sinew;
using namespace sinew::viewer;

namespace {

struct Collected {
    ViewScene scene;
    std::vector<nodes::MeshList> meshes; ///< what the solver gave at each frame
};

Collected collect_muscle(bool with_lattices = true) {
    const auto graph = test::muscle_graph();
    engine::Evaluator evaluator({}, 1);
    Evaluation e;
    e.graph = graph, e.evaluator = &evaluator, e.frames = {1, 2, 3, 4}, e.with_lattices = with_lattices;
    Collected out{collect_graph(e), {}};
    for (const int frame : e.frames)
        out.meshes.push_back(
            evaluator.pull({graph, {"solver", "outMeshes"}, static_cast<double>(frame)}).as<nodes::MeshList>());
    return out;
}

double largest_error(const Collected& c) {
    double worst = 0;
    for (std::size_t f = 0; f < c.meshes.size(); ++f)
        for (std::size_t b = 0; b < c.scene.bodies.size(); ++b) {
            const solver::Points& points = *c.meshes[f].meshes[b].points;
            REQUIRE(c.scene.bodies[b].vertex_count() == points.size());
            for (std::size_t v = 0; v < points.size(); ++v) {
                const auto p = vertex_position(c.scene.bodies[b], f, v);
                for (std::size_t k = 0; k < 3; ++k)
                    worst = std::max(worst, std::abs(static_cast<double>(p[k]) - points[v][static_cast<int>(k)]));
            }
        }
    return worst;
}

bool says(const std::vector<ViewNote>& notes, const std::string& part) {
    return std::any_of(notes.begin(), notes.end(),
                       [&](const ViewNote& n) { return n.text.find(part) != std::string::npos; });
}

} // namespace

TEST_CASE("vertices of a collected run are where the solver put them") {
    CHECK(largest_error(collect_muscle()) < 1e-5); // of a scene of 10 units, in single precision
    CHECK(largest_error(collect_muscle(false)) < 1e-5);
}

TEST_CASE("bones are rigid, tissues ride on their lattice, and the node of each body is known") {
    const ViewScene scene = collect_muscle().scene;
    REQUIRE(scene.bodies.size() == 3);
    CHECK(std::holds_alternative<RigidMotion>(scene.bodies[1].motion));
    CHECK(scene.bodies[2].lattice->tets.size() > 10);
    CHECK(scene.bodies[2].lattice->surface.tet.size() == scene.bodies[2].vertex_count());
    CHECK(scene.bodies[2].node == "block");
    CHECK(scene.bodies[2].kind == render::BodyKind::tissue);
    CHECK(scene.bodies[2].volume.size() == 4);
    CHECK(scene.bodies[2].volume[0] == Approx(1).margin(1e-6));
    CHECK(scene.notes.empty());
}

TEST_CASE("bodies of one name in two solvers are called as in the files of a run") {
    engine::Edit edit(test::muscle_graph());
    edit.add_node("second", "zSolver");
    edit.set_json({"second", "bodies"}, R"([{"from": "block.outBody"}])");
    engine::Evaluator evaluator({}, 1);
    Evaluation e;
    e.graph = edit.commit().graph, e.evaluator = &evaluator, e.frames = {1};
    e.shown = {{"solver", "outMeshes"}, {"second", "outMeshes"}};
    const ViewScene scene = collect_graph(e);
    REQUIRE(scene.bodies.size() == 4);
    CHECK(scene.bodies[2].name == "block");
    CHECK(scene.bodies[3].name == "second_block");
    CHECK(scene.bodies[3].node == "block");
}

TEST_CASE("fibres, excitation, painted maps and attachments are collected") {
    const ViewScene scene = collect_muscle().scene;
    const ViewBody& block = scene.bodies[2];
    REQUIRE(block.fibres.size() == 1);
    CHECK(block.fibres[0].node == "fibre");
    CHECK(block.fibres[0].tets.size() > 10);
    CHECK(block.fibres[0].excitation == std::vector<float>{0, 0.5f, 1, 1});
    std::vector<std::string> maps;
    for (const ViewMap& m : block.maps) maps.push_back(m.node + ": " + m.name);
    CHECK(maps == std::vector<std::string>{"fibre: fibre end points", "holdTop: attachment source",
                                           "holdBottom: attachment source"});
    REQUIRE(scene.attachments.size() == 2); // one is switched off
    CHECK(scene.attachments[0].node == "holdTop");
    CHECK(scene.attachments[0].source == 2);
    CHECK(scene.attachments[0].target == 1);
    CHECK(scene.attachments[1].target == 0);
    CHECK(scene.attachments[0].anchors.size() > 4);
}

TEST_CASE("the report of every frame is there, and the graph") {
    const ViewScene scene = collect_muscle().scene;
    REQUIRE(scene.frames.size() == 4);
    CHECK(scene.frames[3].frame == 4);
    REQUIRE(scene.frames[3].step);
    CHECK(scene.frames[3].step->newton_iterations > 0);
    CHECK(scene.graph.boxes.size() == 16);
}

TEST_CASE("a run that fails on the way keeps the frames before and says why") {
    // A tissue's mesh must not move; this one does at frame 3 (FE211).
    engine::Edit edit(test::muscle_graph());
    edit.add_node("drift", "transform");
    edit.set_json({"drift", "mesh"}, R"({"from": "blockMesh.outMesh"})");
    edit.set_json({"drift", "translate"}, R"({"keys": [[2, [0, 0, 0]], [3, [1, 0, 0]]]})");
    edit.set_json({"block", "mesh"}, R"({"from": "drift.outMesh"})");
    const auto broken = edit.commit().graph;
    engine::Evaluator evaluator({}, 1);
    Evaluation e;
    e.graph = broken, e.evaluator = &evaluator, e.frames = {1, 2, 3, 4};
    const ViewScene scene = collect_graph(e);
    CHECK(scene.frames.size() == 2);
    CHECK(says(scene.notes, "ended before frame 3"));
}

TEST_CASE("frames that are missing in the middle are told, and the others are shown") {
    const test::TemporaryFolder folder;
    for (const int f : {1, 2, 5, 6}) test::write_text(folder / ("a." + std::to_string(f) + ".obj"), test::cube_obj(f));
    for (const int f : {1, 2, 6})
        test::write_text(folder / ("b." + std::to_string(f) + ".obj"), test::cube_obj(10 + f));
    const ViewScene scene = collect_folder(folder.path());
    REQUIRE(scene.frames.size() == 4);
    CHECK(scene.frames[2].frame == 5);
    CHECK(scene.up == 'z');
    CHECK(scene.units_per_metre == 10);
    CHECK(says(scene.notes, "Frames 3-4 are missing"));
    CHECK(says(scene.notes, "b: nothing for frame 5"));
    REQUIRE(scene.bodies.size() == 2);
    CHECK(scene.bodies[0].present.empty());
    CHECK(scene.bodies[1].present == std::vector<char>{1, 1, 0, 1});
    CHECK(vertex_position(scene.bodies[1], 3, 0)[0] == Approx(16));
    CHECK(scene.bodies[1].shading.size() == 24); // a cube has sharp edges
}

TEST_CASE("a body that changes its number of vertices is hidden where it does") {
    const test::TemporaryFolder folder;
    for (int f = 1; f <= 4; ++f)
        test::write_text(folder / ("a." + std::to_string(f) + ".obj"), test::cube_obj(f, f == 3 ? 2 : 0));
    const ViewScene scene = collect_folder(folder.path());
    REQUIRE(scene.bodies.size() == 1);
    CHECK(scene.bodies[0].present == std::vector<char>{1, 1, 0, 1});
    CHECK(says(scene.notes, "a has 8 vertices, but another number in frame 3"));
}

TEST_CASE("unreadable files and an empty folder are told, not thrown") {
    const test::TemporaryFolder empty;
    const ViewScene nothing = collect_folder(empty.path());
    CHECK(nothing.bodies.empty());
    CHECK(says(nothing.notes, "no OBJ sequences"));

    const test::TemporaryFolder folder;
    test::write_text(folder / "a.1.obj", test::cube_obj(1));
    test::write_text(folder / "a.2.obj", "v 0 0 zero\n");
    test::write_text(folder / "bad.1.obj", "");
    test::write_text(
        folder / "report.json",
        R"({"frames": [3, {"frame": "x"}, {"frame": 1, "phases": 7, "wall_s": 0.5}, {"frame": 2}], "graph": "gone.json"})");
    const ViewScene scene = collect_folder(folder.path());
    REQUIRE(scene.bodies.size() == 1);
    CHECK(scene.bodies[0].present == std::vector<char>{1, 0});
    CHECK(scene.frames[0].wall_s == 0.5);
    CHECK(scene.notes.size() >= 3);
}

TEST_CASE("chosen frames of a folder, and ones that it does not have") {
    const test::TemporaryFolder folder;
    for (int f = 1; f <= 4; ++f) test::write_text(folder / ("a." + std::to_string(f) + ".obj"), test::cube_obj(f));
    const ViewScene scene = collect_folder(folder.path(), {2, 3, 9});
    CHECK(scene.frames.size() == 2);
    CHECK(says(scene.notes, "no frame 9"));
}

TEST_CASE("a body that turns out not to be rigid keeps the frames that were") {
    std::vector<ViewNote> notes;
    BodyRecorder recorder("a", "", render::BodyKind::plain, 0);
    const auto cube = [](double x, double squash) {
        solver::SurfaceMesh m;
        for (int i = 0; i < 8; ++i) m.points.emplace_back(x + (i & 1), squash * (i >> 1 & 1), i >> 2);
        m.triangles = {{0, 1, 2}, {1, 3, 2}};
        m.face_sizes = {3, 3}, m.face_vertices = {0, 1, 2, 1, 3, 2};
        return m;
    };
    recorder.add(1, cube(0, 1));
    recorder.add(2, cube(5, 1));
    recorder.add(3, cube(5, 0.5));
    const ViewBody body = recorder.finish(notes);
    CHECK(std::holds_alternative<DeformingMotion>(body.motion));
    CHECK(vertex_position(body, 1, 1)[0] == Approx(6).epsilon(1e-6));
    CHECK(vertex_position(body, 2, 2)[1] == Approx(0.5).epsilon(1e-6));
}

TEST_CASE("lists of frames are short") {
    CHECK(frame_list({}) == "");
    CHECK(frame_list({4}) == "4");
    CHECK(frame_list({1, 2, 3, 7}) == "1-3 and 7");
    CHECK(frame_list({1, 3, 5}) == "1, 3 and 5");
    std::vector<int> many;
    for (int i = 0; i < 100; ++i) many.push_back(2 * i);
    CHECK(frame_list(many).ends_with("and 92 more ranges"));
}
