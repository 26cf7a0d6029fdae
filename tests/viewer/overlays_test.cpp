// What is drawn on bodies, from data made by hand: anchors, maps, fibres, tets, reports, and how the page gets them.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/overlays.h"

#include "tests/viewer/runs.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/flesh.h"
#include "tools/viewer/page_data.h"
#include "tools/viewer/read_report.h"
#include "tools/viewer/recorder.h"
#include "tools/viewer/shot_overlays.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace sinew;
using namespace sinew::viewer;
using nlohmann::json;
using solver::Vec3;

namespace {

ViewScene collect(const std::shared_ptr<const engine::Graph>& graph) {
    engine::Evaluator evaluator({}, 1);
    Evaluation e;
    e.graph = graph, e.evaluator = &evaluator, e.frames = {1, 2, 3, 4};
    return collect_graph(e);
}

const ViewMap& map_of(const ViewBody& body, const std::string& name) {
    for (const ViewMap& m : body.maps)
        if (m.node + " " + m.name == name) return m;
    FAIL("there is no map " << name);
    return body.maps.front();
}

nodes::BodyRest bone_of(const solver::SurfaceMesh& mesh) {
    nodes::BodyRest out;
    auto bone = std::make_shared<solver::BoneRest>();
    bone->surface = mesh.points, bone->triangles = mesh.triangles;
    out.data = std::shared_ptr<const solver::BoneRest>(std::move(bone));
    return out;
}

/// A body that stands still, of these points.
ViewBody standing(std::vector<float> points) {
    ViewBody body;
    body.rest = std::move(points);
    RigidMotion still;
    still.poses.resize(1);
    body.motion = still;
    return body;
}

/// A corner of a cube of 3 units as one tet, turned by a quarter about z and twice as long in x at frame 1.
ViewBody tet_body() {
    ViewBody body = standing({0, 0, 0});
    ViewLattice lattice;
    lattice.tets = {{0, 1, 2, 3}};
    lattice.rest = {0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 3};
    lattice.frames = {lattice.rest, {0, 0, 0, 0, 6, 0, -3, 0, 0, 0, 0, 3}};
    body.lattice = lattice;
    std::get<RigidMotion>(body.motion).poses.resize(2);
    return body;
}

bool near(const Vec3& a, const Vec3& b) { return (a - b).norm() < 1e-5; }

} // namespace

TEST_CASE("of many anchors an even choice is drawn, with offsets in scene units") {
    const solver::SurfaceMesh triangle =
        solver::SurfaceMesh::from_triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    std::vector<solver::Anchor> anchors(1000);
    for (std::size_t i = 0; i < anchors.size(); ++i) {
        anchors[i].source.vertices = {static_cast<int>(i), 1, 2}, anchors[i].source.coordinates = {0.25, 0.25, 0.5, 0};
        anchors[i].target.vertices = {2, 1, 0}, anchors[i].target.coordinates = {1, 0, 0, 0};
        anchors[i].offset = {0.01, 0.02, static_cast<double>(i)};
    }
    const nodes::BodyRest bone = bone_of(triangle);
    const ViewAttachment drawn = attachment_of(anchors, bone, bone, 100);
    REQUIRE(drawn.anchors.size() == 400);
    for (std::size_t i = 0; i < 400; ++i) {
        const int chosen = static_cast<int>(i * 5 / 2); // 1000 / 400
        CHECK(drawn.anchors[i].source.host == std::array<int, 4>{chosen, 1, 2, -1});
        CHECK(drawn.anchors[i].offset == std::array<float, 3>{1, 2, static_cast<float>(100 * chosen)});
    }
    CHECK(drawn.anchors[0].source.weights == std::array<float, 4>{0.25f, 0.25f, 0.5f, 0});
    CHECK(drawn.anchors[0].target.host == std::array<int, 4>{2, 1, 0, -1});
    anchors.resize(3);
    CHECK(attachment_of(anchors, bone, bone, 1).anchors.size() == 3);
}

TEST_CASE("maps of faces give a vertex the largest of its faces, and each end has its own") {
    engine::Edit edit(test::muscle_graph());
    std::string weights = "[";
    for (int f = 0; f < 40; ++f)
        weights += (f ? ", " : "") + std::string(f % 5 == 0 ? "0.75" : f % 5 == 1 ? "0.25" : "0");
    const auto paint = [&](const std::string& node, const std::string& mesh, const std::string& values) {
        edit.add_node(node, "weights");
        edit.set_json({node, "mesh"}, "{\"from\": \"" + mesh + ".outMesh\"}").set_json({node, "mode"}, "\"list\"");
        edit.set_json({node, "values"}, values);
    };
    paint("faces", "blockMesh", weights + "]");
    edit.set_json({"faces", "on"}, "\"faces\"");
    paint("target", "plateMesh", "[1, 0.5, 1, 1, 1, 1, 1, 0]");
    edit.set_json({"holdTop", "weightsOn"}, "\"faces\"")
        .set_json({"holdTop", "weights"}, R"({"from": "faces.outWeights"})");
    edit.set_json({"holdTop", "targetWeights"}, R"({"from": "target.outWeights"})");
    const auto graph = edit.commit().graph;
    const ViewScene scene = collect(graph);
    engine::Evaluator evaluator({}, 1);
    const auto mesh = evaluator.pull({graph, {"blockMesh", "outMesh"}, 1}).as<nodes::Mesh>();
    REQUIRE(mesh.topology->face_sizes.size() == 40);
    std::vector<float> expected(mesh.points->size(), 0);
    for (std::size_t f = 0, corner = 0; f < 40; ++f)
        for (int k = 0; k < 4; ++k, ++corner) {
            float& there = expected[static_cast<std::size_t>(mesh.topology->face_vertices[corner])];
            there = std::max(there, f % 5 == 0 ? 0.75f : f % 5 == 1 ? 0.25f : 0.0f);
        }
    CHECK(map_of(scene.bodies[2], "holdTop attachment source").values == expected);
    CHECK(map_of(scene.bodies[1], "holdTop attachment target").values == std::vector<float>{1, 0.5f, 1, 1, 1, 1, 1, 0});
}

TEST_CASE("fibres are shown as excited as their envelope lets them be") {
    engine::Edit edit(test::muscle_graph());
    edit.set_json({"fibre", "envelope"}, "0.5");
    CHECK(collect(edit.commit().graph).bodies[2].fibres[0].excitation == std::vector<float>{0, 0.25f, 0.5f, 0.5f});
}

TEST_CASE("the volume of a body is told as a share of that at rest") {
    const auto cube = [](double size) {
        solver::SurfaceMesh m;
        for (int i = 0; i < 8; ++i) m.points.emplace_back(size * (i & 1), size * (i >> 1 & 1), size * (i >> 2));
        m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
        for (const solver::Triangle& t : m.triangles) {
            m.face_sizes.push_back(3);
            m.face_vertices.insert(m.face_vertices.end(), t.begin(), t.end());
        }
        return m;
    };
    std::vector<ViewNote> notes;
    BodyRecorder recorder("a", "", render::BodyKind::plain, 0);
    recorder.set_rest(cube(2));
    for (const double size : {2.0, 4.0, 1.0}) recorder.add(1, cube(size));
    const ViewBody body = recorder.finish(notes);
    REQUIRE(body.volume.size() == 3);
    CHECK((body.volume[0] == Approx(1) && body.volume[1] == Approx(8) && body.volume[2] == Approx(0.125)));
}

TEST_CASE("attached points hold on beside their triangle: along its first edge, across it, and off it") {
    ViewScene scene;
    scene.frames.resize(1);
    scene.units_per_metre = 100;
    scene.bodies = {standing({4, 0, 0, 6, 0, 0, 4, 2, 0}), standing({0, 0, 0, 2, 0, 0, 1, 3, 0})};
    ViewAnchor anchor;
    anchor.source = {{0, 1, 2, -1}, {0.5f, 0.25f, 0.25f, 0}};
    anchor.target = {{0, 1, 2, -1}, {0, 1, 0, 0}};
    anchor.offset = {1, 2, 3};
    scene.attachments = {{"tie", "fixed", 0, 1, {anchor}}};
    const auto lines = overlay_segments(scene, 0, {"attachments"});
    REQUIRE(lines.size() == 2);
    CHECK(near(lines[0].from, {4.5, 0.5, 0}));
    CHECK(near(lines[0].to, {3, 2, 3})); // (2, 0, 0) + 1 x + 2 y + 3 z
    CHECK(near(lines[1].to, {4.5, 0.5, 0}));
}

TEST_CASE("of tets the edges of their border are drawn, and no others") {
    ViewScene scene;
    scene.frames.resize(1);
    ViewBody body = tet_body();
    // The tet in four about its middle.
    body.lattice->rest.insert(body.lattice->rest.end(), {0.5f, 0.5f, 0.5f});
    body.lattice->frames = {body.lattice->rest};
    body.lattice->tets = {{0, 1, 2, 4}, {0, 1, 4, 3}, {0, 4, 2, 3}, {4, 1, 2, 3}};
    scene.bodies = {body};
    const auto lines = overlay_segments(scene, 0, {"lattice"});
    CHECK(lines.size() == 6);
    for (const auto& l : lines) CHECK_FALSE((near(l.from, {0.5, 0.5, 0.5}) || near(l.to, {0.5, 0.5, 0.5})));
}

TEST_CASE("lines of fibres turn and stretch with their tet") {
    ViewScene scene;
    scene.frames.resize(2);
    ViewBody body = tet_body();
    ViewFibres fibres;
    fibres.tets = {0}, fibres.directions = {1, 0, 0}, fibres.weights = {1};
    fibres.centre = {0.25f, 0.25f, 0.25f, 0.25f}, fibres.reach = {0.5f, 0.25f}, fibres.excitation = {0, 1};
    body.fibres = {fibres};
    scene.bodies = {body};
    const auto rest = overlay_segments(scene, 0, {"fibers"}), turned = overlay_segments(scene, 1, {"fibers"});
    REQUIRE((rest.size() == 1 && turned.size() == 1));
    CHECK(near(rest[0].from, {0.25, 0.75, 0.75}));
    CHECK(near(rest[0].to, {1, 0.75, 0.75}));
    CHECK(near(turned[0].from, {-0.75, 0.5, 0.75})); // the middle (-0.75, 1.5, 0.75) less half of (0, 2, 0)
    CHECK(near(turned[0].to, {-0.75, 2, 0.75}));
    const auto srgb = [](unsigned hex) {
        const auto c = [&](unsigned shift) { return render::to_linear(static_cast<float>(hex >> shift & 255) / 255); };
        return Eigen::Vector3f(c(16), c(8), c(0));
    };
    CHECK((rest[0].colour - srgb(0x3b3f73)).norm() < 1e-5f); // the scale from rest to full excitation
    CHECK((turned[0].colour - srgb(0xa5f3ea)).norm() < 1e-5f);
}

TEST_CASE("lines of fibres are as long as their tet and their weight let them be") {
    ViewBody body = tet_body();
    ViewFibres fibres;
    fibres.tets = {0, 0}, fibres.directions = {1, 0, 0, 0, 1, 0}, fibres.weights = {1, 0.5f};
    fibres.excitation = {0, 0};
    body.fibres = {fibres};
    keep_to_flesh(body); // nothing is known to be inside of it: whole
    const double whole = 0.42 * std::cbrt(4.5);
    REQUIRE(body.fibres[0].reach.size() == 4);
    CHECK(body.fibres[0].reach[0] == Approx(whole).epsilon(1e-6));
    CHECK(body.fibres[0].reach[1] == Approx(whole).epsilon(1e-6));
    CHECK(body.fibres[0].reach[2] == Approx(0.7 * whole).epsilon(1e-6));
    // On the page: bytes of the longest.
    ViewScene scene;
    scene.frames.resize(2);
    scene.bodies = {body};
    const PageData page = page_data(scene);
    const json there = json::parse(page.header)["bodies"][0]["fibres"][0];
    CHECK(there["longest"].get<double>() == Approx(whole).epsilon(1e-6));
    CHECK(page.blocks[there["reach"].get<std::size_t>()].deflated ==
          pack(std::span<const std::uint8_t>(std::vector<std::uint8_t>{255, 255, 179, 179})).deflated);
}

TEST_CASE("the page has each number of a frame's report under its name") {
    ViewScene scene = test::made_scene(10, 1);
    solver::StepRecord s;
    s.seconds_assembly = 1, s.seconds_factor = 2, s.seconds_solve = 3, s.seconds_other = 4;
    s.substeps = 5, s.newton_iterations = 6, s.residual = 0.25, s.energy = 0.5, s.min_j = 0.75, s.inverted = 7;
    s.converged = false;
    s.measured = {{solver::find_measure("attachment", "max_stretch_m"), 0.125},
                  {solver::find_measure("hold", "force_x_N"), 8, 0},
                  {solver::find_measure("hold", "force_x_N"), 9, 1}};
    scene.frames[0].step = s, scene.frames[0].wall_s = 11;
    const json header = json::parse(page_data(scene).header);
    CHECK(header["frames"][0] == json::parse(R"({"frame": 1, "reused": false, "wall_s": 11.0,
        "phases": {"assembly": 1.0, "factor": 2.0, "solve": 3.0, "other": 4.0}, "substeps": 5, "newton": 6,
        "residual": 0.25, "energy": 0.5, "minJ": 0.75, "inverted": 7, "converged": false,
        "terms": {"attachment": {"max_stretch_m": 0.125}, "hold": {"force_x_N 1": 8.0, "force_x_N 2": 9.0}}})"));
    std::vector<std::string> measures;
    for (const json& m : header["measures"])
        measures.push_back(m["name"].get<std::string>() + ": " + m["title"].get<std::string>());
    CHECK(measures == std::vector<std::string>{"max_stretch_m: largest attachment stretch",
                                               "force_x_N 1: hold 1: force along x",
                                               "force_x_N 2: hold 2: force along x"});
}

TEST_CASE("a report is read back number by number, the newest first, and what cannot be right is left out") {
    const test::TemporaryFolder folder;
    const auto write = [&](const std::string& name, int newton, int age) {
        test::write_text(folder / name, R"({"graph": "g.json", "frames": [{"frame": 3, "reused": true, "wall_s": 0.5,
            "phases": {"assembly": 1, "factor": 2, "solve": 3, "other": 4}, "substeps": 5, "newton": )" +
                                            std::to_string(newton) +
                                            R"(, "residual": 0.25, "converged": false, "energy": 0.5, "min_J": 0.75,
            "inverted": 7, "terms": {"attachment": {"max_stretch_m": 0.125}, "hold": {"force_x_N": [8, 9]}}}]})");
        std::filesystem::last_write_time(folder / name,
                                         std::filesystem::file_time_type::clock::now() - std::chrono::hours(age));
    };
    write("a.json", 6, 2), write("b.json", 66, 1), write("c.json", 666, 3);
    std::vector<ViewNote> notes;
    const auto found = find_reports(folder.path(), notes);
    REQUIRE(found.size() == 3);
    CHECK(notes.empty());
    std::vector<int> newton;
    for (const FoundReport& r : found) newton.push_back(r.frames.at(3).step->newton_iterations);
    CHECK(newton == std::vector{66, 6, 666});
    const ViewFrame& f = found[0].frames.at(3);
    const solver::StepRecord& s = *f.step;
    CHECK((f.frame == 3 && f.reused && f.wall_s == 0.5));
    CHECK((s.seconds_assembly == 1 && s.seconds_factor == 2 && s.seconds_solve == 3 && s.seconds_other == 4));
    CHECK((s.substeps == 5 && s.residual == 0.25 && !s.converged && s.energy == 0.5 && s.min_j == 0.75));
    CHECK(s.inverted == 7);
    CHECK(solver::value_of(s.measured, "attachment", "max_stretch_m") == 0.125);
    CHECK(solver::value_of(s.measured, "hold", "force_x_N", 1) == 9);

    const test::TemporaryFolder odd;
    test::write_text(odd / "report.json", R"({"frames": [{"frame": 1, "wall_s": -1, "phases": {"assembly": -2}},
        {"frame": 2, "wall_s": 2, "reused": 3}]})");
    const auto strange = find_reports(odd.path(), notes);
    REQUIRE(strange.size() == 1);
    CHECK(strange[0].frames.at(1).wall_s == 0);
    CHECK(strange[0].frames.at(1).step->seconds_assembly == 0);
    CHECK(strange[0].frames.at(2).wall_s == 2);
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].text == "report.json: 3 values cannot be right and are left out.");
}
