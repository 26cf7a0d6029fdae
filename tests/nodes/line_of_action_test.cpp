// Lines of action from end to end: curves that follow bones and matrices, what they come to in the solver, growth that
// follows them.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "nodes/marks.h"
#include "solver/mesh/surface_mesh.h"

#include <cmath>

using namespace bench;

namespace {

/// A box of 8 x 4 x 4 cm that nothing holds, and a line of 10 cm through it whose second point moves along it by keys:
/// in 5 frames it shortens by 2 cm, then stands. `u` scene units a metre.
std::string muscle(double u, const std::string& line, const std::string& fiber, const std::string& solver = "") {
    return R"("mesh": {"type": "polyCube", "inputs": {"width": )" + number(0.08 * u) + R"(, "height": )" +
           number(0.04 * u) + R"(, "depth": )" + number(0.04 * u) + R"(, "subdivisionsWidth": 4}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 4000}},
        "path": {"type": "curve", "inputs": {"points": [)" +
           number(-0.05 * u) + ", 0, 0, " + number(0.05 * u) + R"(, 0, 0]}},
        "slide": {"type": "transform", "inputs": {"translate": {"keys": [[1, [0, 0, 0]], [6, [)" +
           number(-0.02 * u) + R"(, 0, 0]]]}}},
        "rivet": {"type": "zRivetToBone", "inputs": {"curve": {"from": "path.outCurve"}, "cvIndices": [1],
            "matrix": {"from": "slide.outMatrix"}}},
        "line": {"type": "zLineOfAction", "inputs": {"curves": [{"from": "rivet.outCurve"}])" +
           line + R"(}},
        "fibre": {"type": "zFiber", "inputs": {"direction": [1, 0, 0], "strength": 8000)" +
           fiber + R"(}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": )" +
           number(0.03 * u) + R"(}},
        "box": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"},
            "materials": [{"from": "flesh.outMaterial"}], "fibers": [{"from": "fibre.outFiber"}]}},
        "solver": {"type": "zSolver", "inputs": {"scale": )" +
           number(u) + R"(, "gravity": [0, 0, 0], "bodies": [{"from": "box.outBody"}])" + solver + R"(}})";
}

const std::string with_line = R"(, "lineOfAction": {"from": "line.outLineOfAction"})";

double loa_value(Session& s, double frame) {
    const auto all = s.get<engine::NumberList>("solver", "outLoaValues", frame);
    REQUIRE(all.size() == 1);
    return all[0];
}

nodes::LineReport reported(Session& s, double frame) {
    const auto report = s.get<nodes::SolveReport>("solver", "outReport", frame);
    REQUIRE(report.lines.size() == 1);
    return report.lines[0];
}

solver::Points points(Session& s, double frame) {
    return *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[0].points;
}

solver::Points curve_points(Session& s, const std::string& node, double frame) {
    return s.get<nodes::CurvePoints>(node, "outCurve", frame).points;
}

} // namespace

TEST_CASE("a line of action excites the fibres by its shortening, in any unit", "[nodes][line]") {
    solver::Points in_metres;
    for (const double u : {1.0, 100.0, 25.4}) {
        Session s(muscle(u, R"(, "posSensitivity": 2)", with_line + R"(, "excitation": 0.25)"));
        CHECK(loa_value(s, 1) == 0);
        for (const auto& [frame, value] : {std::pair{2.0, 0.08}, {4.0, 0.24}, {6.0, 0.4}, {9.0, 0.4}}) {
            INFO(u << ", frame " << frame);
            CHECK(loa_value(s, frame) == Approx(value).epsilon(1e-12));
            CHECK(s.get<double>("line", "outLength", frame) == Approx((0.1 - 0.05 * value) * u).epsilon(1e-12));
            const nodes::LineReport r = reported(s, frame);
            CHECK(r.excitation == Approx(0.25 + value).epsilon(1e-12));
            CHECK(r.line.length == Approx(0.1 - 0.05 * value).epsilon(1e-12));
            CHECK(r.line.rest_length == Approx(0.1).epsilon(1e-12));
            CHECK(r.growth == 1);
        }
        solver::Points p = points(s, 9);
        for (solver::Vec3& v : p) v /= u;
        if (in_metres.empty()) in_metres = p;
        CHECK(largest_difference(p, in_metres) < 1e-9);
        CHECK(std::abs((p.front() - p.back()).x()) < 0.075); // it has pulled
        CHECK(s.counter.warnings.empty());
    }
}

TEST_CASE("a line's excitation is reported as it is used, run up", "[nodes][line]") {
    const std::string slowly = R"(, "runupWeight": {"keys": [[1, 0], [5, 1]]})";
    Session s(muscle(1, R"(, "posSensitivity": 2)", with_line + R"(, "excitation": 0.25)", slowly));
    CHECK(loa_value(s, 4) == Approx(0.24).epsilon(1e-12)); // the line's own is what it is
    CHECK(reported(s, 4).excitation == Approx(0.75 * 0.49).epsilon(1e-12));
    Session at_once(muscle(1, R"(, "posSensitivity": 2)", with_line + R"(, "excitation": 0.25)",
                           slowly + R"(, "affectFiberExcitation": false)"));
    CHECK(reported(at_once, 4).excitation == Approx(0.49).epsilon(1e-12));
}

TEST_CASE("a line of action is the same as keying the excitation that it comes to", "[nodes][line]") {
    for (const char* scheme : {"BackwardEuler", "BDF2", "TR-BDF2"}) {
        const std::string solver = R"(, "integrator": ")" + std::string(scheme) + R"(", "substeps": 2)";
        Session by_line(muscle(1, R"(, "posSensitivity": 2)", with_line, solver));
        std::string keys;
        std::vector<double> values;
        for (double frame = 1; frame <= 8; ++frame) {
            values.push_back(loa_value(by_line, frame));
            keys += (keys.empty() ? "[" : ", [") + number(frame) + ", " + number(values.back()) + "]";
        }
        Session keyed(muscle(1, "", R"(, "excitation": {"keys": [)" + keys + "]}", solver));
        INFO(scheme);
        // Between keys both are lines, met by other roundings.
        CHECK(largest_difference(points(by_line, 8), points(keyed, 8)) < 1e-12);
        CHECK(largest_difference(points(by_line, 8), points(by_line, 1)) > 1e-3);
        CHECK(keyed.get<engine::NumberList>("solver", "outLoaValues", 8).empty());
    }
}

TEST_CASE("rates of a line of action come from the steps before and are part of the state", "[nodes][line]") {
    // It shortens by 0.2 of its length in 5 frames of 1/24 s: 0.96 of its length a second.
    const std::string line = R"(, "posSensitivity": 0, "velSensitivity": 0.25, "accSensitivity": 0.01)";
    for (const char* substeps : {"1", "3"}) {
        const std::string all = muscle(1, line, with_line, R"(, "substeps": )" + std::string(substeps));
        Session s(all);
        INFO(substeps);
        CHECK(loa_value(s, 1) == 0);
        // The first frame's first step knows no acceleration; a later one is none while the rate stays.
        for (const double frame : {2.0, 3.0, 6.0}) CHECK(loa_value(s, frame) == Approx(0.24).epsilon(1e-9));
        // It stops: no rate, and what stopped it acts in the first step after alone (a stop is a lengthening push).
        CHECK(loa_value(s, 7) == 0);
        CHECK(loa_value(s, 8) == 0);
        for (const double frame : {2.0, 6.0}) {
            const auto bytes = s.evaluator.save_state({s.graph, {"solver", "outMeshes"}, frame});
            Session resumed(all);
            resumed.evaluator.load_state({resumed.graph, {"solver", "outMeshes"}, frame}, bytes);
            CHECK(points(resumed, 9) == points(s, 9));
            CHECK(reported(resumed, 7).line == reported(s, 7).line);
            CHECK(resumed.counter.steps["solver"] == static_cast<int>(9 - frame));
        }
    }
    // One that sets out: its acceleration fires in the step that follows the first, divided by the steps' size.
    Session start(muscle(1, R"(, "posSensitivity": 0, "accSensitivity": 0.002)", with_line));
    start.set("slide", "translate", R"({"keys": [[1, [0, 0, 0]], [2, [0, 0, 0]], [3, [-0.01, 0, 0]]]})");
    CHECK(loa_value(start, 2) == 0);
    CHECK(loa_value(start, 3) == Approx(0.002 * 0.1 * 24 * 24).epsilon(1e-9));
    CHECK(loa_value(start, 4) == 0); // it stops
}

TEST_CASE("sensitivities may be keyed, and an edit runs again from the first key that changed", "[nodes][line]") {
    Session s(muscle(1, R"(, "posSensitivity": {"keys": [[1, 0], [6, 0], [7, 1]]})", with_line));
    CHECK(loa_value(s, 6) == 0);
    CHECK(loa_value(s, 8) == Approx(0.2).epsilon(1e-12));
    CHECK(s.counter.steps["solver"] == 8);
    s.set("line", "posSensitivity", R"({"keys": [[1, 0], [6, 0], [7, 0.5]]})");
    CHECK(loa_value(s, 8) == Approx(0.1).epsilon(1e-12));
    CHECK(s.counter.steps["solver"] == 10);
}

TEST_CASE("a muscle grows as its line of action shortens", "[nodes][line]") {
    const double model = 0.08 * 0.04 * 0.04;
    // At rest of itself: no pull, long steps.
    const std::string solver = R"(, "framesPerSecond": 0.1, "maxNewtonIterations": 50, "solverToleranceFactor": 0.001)";
    for (const auto& [scale, envelope] : {std::pair{2.0, 1.0}, {0.5, 1.0}, {2.0, 0.5}}) {
        Session s(muscle(1, "",
                         with_line + R"(, "enableMuscleGrowth": true, "useLoaForMuscleGrowth": true,
            "muscleGrowthScale": )" +
                             number(scale) + R"(, "envelope": )" + number(envelope),
                         solver));
        s.set("fibre", "strength", "0");
        INFO(scale << ", " << envelope);
        const auto volume = [&](double frame) {
            const nodes::Mesh mesh = s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[0];
            return solver::enclosed_volume(*mesh.points, mesh.surface().triangles);
        };
        CHECK(volume(1) == Approx(model).epsilon(1e-12));
        const double across = std::pow(scale, 0.2 * envelope); // the line is a fifth shorter
        CHECK(volume(9) == Approx(across * across * model).epsilon(1e-7));
        CHECK(reported(s, 9).growth == Approx(std::pow(scale, 0.2)).epsilon(1e-12));
        const auto report = s.get<nodes::SolveReport>("solver", "outReport", 9);
        CHECK(report.worst.j == Approx(1).epsilon(1e-6)); // measured from the shape that has grown
        CHECK(report.record.min_j == Approx(1).epsilon(1e-6));
        CHECK(s.counter.warnings.empty());
    }
}

TEST_CASE("lengths of several curves of a line add, and each fibre takes its own line", "[nodes][line]") {
    Session s(muscle(1, "", with_line) + R"(,
        "other": {"type": "curve", "inputs": {"points": [0, 0, 0, 0, 0.1, 0, 0.1, 0.1, 0, 0.1, 0, 0], "form": "cubic"}})");
    s.set("line", "curves", R"([{"from": "rivet.outCurve"}, {"from": "other.outCurve"}])");
    const double other = s.get<double>("other", "outLength");
    CHECK(other > 0.1);
    CHECK(other < 0.3);
    CHECK(s.get<double>("line", "outLength", 1) == Approx(0.1 + other).epsilon(1e-12));
    CHECK(loa_value(s, 6) == Approx(0.02 / (0.1 + other)).epsilon(1e-12));
}

TEST_CASE("a line of action is shown as marks with its loaValue", "[nodes][line]") {
    Session s(muscle(100, "", with_line));
    const auto marks = s.get<nodes::MarkList>("solver", "outMarks", 6);
    REQUIRE(marks.groups.size() == 1);
    CHECK(marks.groups[0].term == "line of action");
    CHECK(marks.groups[0].what == "loaValue");
    REQUIRE(marks.groups[0].marks.size() == 1);
    const solver::Mark& m = marks.groups[0].marks[0];
    CHECK(m.from == solver::Vec3(-5, 0, 0));
    CHECK((m.to - solver::Vec3(3, 0, 0)).norm() < 1e-12);
    CHECK(m.value == Approx(0.2).epsilon(1e-12));
    CHECK(m.bodies[0] == 0);
}

TEST_CASE("riveted points move as their bone does, from where both are modelled", "[nodes][line]") {
    // A bone that turns by 90 degrees about z and is shifted, by its matrix or by its mesh.
    const std::string all = R"("cube": {"type": "polyCube"},
        "move": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"},
            "translate": {"keys": [[1, [0, 0, 0]], [2, [5, 0, 0]]]}, "rotate": {"keys": [[1, [0, 0, 0]], [2, [0, 0, 90]]]}}},
        "byMatrix": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}, "matrix": {"from": "move.outMatrix"}}},
        "byMesh": {"type": "zBone", "inputs": {"mesh": {"from": "move.outMesh"}}},
        "path": {"type": "curve", "inputs": {"points": [0.6, 0.1, 0.2, 3, 0, 0, 0.1, 0.75, -0.3]}},
        "a": {"type": "zRivetToBone", "inputs": {"curve": {"from": "path.outCurve"}, "cvIndices": [0, 2],
            "bone": {"from": "byMatrix.outBody"}}},
        "b": {"type": "zRivetToBone", "inputs": {"curve": {"from": "path.outCurve"}, "cvIndices": [0, 2],
            "bone": {"from": "byMesh.outBody"}, "boneAsModelled": {"from": "cube.outMesh"}}},
        "half": {"type": "zRivetToBone", "inputs": {"curve": {"from": "path.outCurve"}, "envelope": 0.5,
            "bone": {"from": "byMatrix.outBody"}}},
        "chain": {"type": "zRivetToBone", "inputs": {"curve": {"from": "a.outCurve"}, "cvIndices": [1],
            "matrix": [1,0,0,0, 0,1,0,7, 0,0,1,0, 0,0,0,1]}})";
    Session s(all);
    const solver::Points moved{{5 - 0.1, 0.6, 0.2}, {3, 0, 0}, {5 - 0.75, 0.1, -0.3}};
    CHECK(largest_difference(curve_points(s, "a", 2), moved) < 1e-14);
    CHECK(largest_difference(curve_points(s, "b", 2), moved) < 1e-14);
    CHECK(largest_difference(curve_points(s, "a", 1), curve_points(s, "path", 1)) < 1e-15);
    const solver::Points chained{moved[0], {3, 7, 0}, moved[2]};
    CHECK(largest_difference(curve_points(s, "chain", 2), chained) < 1e-14);
    const solver::Points halfway{0.5 * (moved[0] + solver::Vec3(0.6, 0.1, 0.2)),
                                 0.5 * (solver::Vec3(5, 3, 0) + solver::Vec3(3, 0, 0)),
                                 0.5 * (moved[2] + solver::Vec3(0.1, 0.75, -0.3))};
    CHECK(largest_difference(curve_points(s, "half", 2), halfway) < 1e-14);
    // The same line at all frames, or another one.
    const auto bound = [&](const char* node, double frame) {
        return s.get<nodes::CurvePoints>(node, "outCurve", frame).bound;
    };
    CHECK(bound("a", 1) == bound("a", 2));
    CHECK(bound("b", 1) == bound("b", 2));
    CHECK(bound("chain", 1) == bound("chain", 2));
    CHECK_FALSE(bound("a", 1) == bound("chain", 1));
}

TEST_CASE("lines of action that cannot be followed are refused", "[nodes][line]") {
    const std::string all = muscle(1, "", with_line);
    std::string text;
    Session s(all);
    s.set("rivet", "cvIndices", "[0, 2]");
    CHECK(codes([&] { s.pull("solver", "outMeshes"); }, &text) == Codes{"FE283"});
    CHECK(text.find("has no point 2; its 2 points count from 0 to 1") != std::string::npos);
    s.set("rivet", "cvIndices", "[0.5]");
    CHECK(codes([&] { s.pull("rivet", "outCurve"); }) == Codes{"FE283"});
    s.set("rivet", "cvIndices", "[-1]");
    CHECK(codes([&] { s.pull("rivet", "outCurve"); }) == Codes{"FE283"});

    Session flat(all);
    flat.set("path", "points", "[0, 0, 0, 0, 0, 0]");
    CHECK(codes([&] { flat.pull("solver", "outMeshes"); }, &text) == Codes{"FE280"});
    CHECK(text.find("fiber 1 of box") != std::string::npos);
    flat.set("path", "points", "[0, 0, 0, 0, 1e-9, 0]"); // a point and rounding
    CHECK(codes([&] { flat.pull("solver", "outMeshes"); }) == Codes{"FE280"});

    Session far(all);
    far.set("path", "points", "[5, 0, 0, 6, 0, 0]");
    far.pull("solver", "outMeshes");
    REQUIRE(far.counter.warnings.size() == 1);
    CHECK(far.counter.warnings[0].code == "FE281");

    // A bone whose mesh moves before it, and nothing that says where it was.
    const std::string bone = R"(, "cube": {"type": "polyCube", "inputs": {"width": 0.1, "height": 0.1, "depth": 0.1}},
        "move": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"},
            "translate": {"keys": [[1, [0, 0, 0]], [5, [0.1, 0, 0]]]}}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "move.outMesh"}}})";
    Session loose(all + bone);
    loose.set("rivet", "matrix", "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]");
    loose.set("rivet", "bone", R"({"from": "bone.outBody"})");
    loose.pull("solver", "outMeshes", 1);
    CHECK(codes([&] { loose.pull("solver", "outMeshes", 2); }, &text) == Codes{"FE282"});
    CHECK(text.find("boneAsModelled") != std::string::npos);
    loose.set("rivet", "boneAsModelled", R"({"from": "cube.outMesh"})");
    CHECK(loa_value(loose, 5) == 0); // the line gets longer
    CHECK(reported(loose, 5).line.length == Approx(0.2).epsilon(1e-12));
    CHECK(loose.counter.warnings.empty());

    Session both(all + bone);
    both.set("rivet", "bone", R"({"from": "bone.outBody"})");
    CHECK(codes([&] { both.pull("rivet", "outCurve", 3); }) == Codes{"DG110"});
    Session tissue(all + R"(, "other": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"},
        "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}})");
    tissue.set("rivet", "matrix", "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]");
    tissue.set("rivet", "bone", R"({"from": "other.outBody"})");
    CHECK(codes([&] { tissue.pull("rivet", "outCurve"); }) == Codes{"FE218"});
}
