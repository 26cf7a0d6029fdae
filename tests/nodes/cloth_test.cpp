// zCloth from end to end: a scene of cloth alone, units, layers, keys.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

using namespace bench;

namespace {

/// A sheet of 1 x 0.5 m, held at one end, `unit` scene units a metre.
std::string sheet(int unit, const std::string& cloth = "", const std::string& solver = "") {
    const std::string u = std::to_string(unit);
    return R"("mesh": {"type": "polyPlane", "inputs": {"width": )" + u + R"(, "height": )" +
           std::to_string(0.5 * unit) + R"(, "subdivisionsWidth": 8, "subdivisionsHeight": 4}},
        "cotton": {"type": "zMaterial", "inputs": {"tensileStiffness": 800, "shearStiffness": 80, "bendStiffness": 0.05, "clothMassDensity": 0.3}},
        "heavy": {"type": "zMaterial", "inputs": {"clothMassDensity": 0.9, "weights": {"from": "far.outWeights"}}},
        "far": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "start": 0, "end": )" +
           u + R"(}},
        "cloth": {"type": "zCloth", "inputs": {"mesh": {"from": "mesh.outMesh"},
            "materials": [{"from": "cotton.outMaterial"}, {"from": "heavy.outMaterial"}])" +
           cloth + R"(}},
        "end": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "start": )" +
           std::to_string(-0.49 * unit) + R"(, "end": )" + std::to_string(-0.5 * unit) + R"(}},
        "hold": {"type": "zHold", "inputs": {"tissue": {"from": "cloth.outBody"}, "weights": {"from": "end.outWeights"}}},
        "solver": {"type": "zSolver", "inputs": {"scale": )" +
           u +
           R"(, "maxNewtonIterations": 40, "bodies": [{"from": "cloth.outBody"}], "forces": [{"from": "hold.outForce"}])" +
           solver + "}}";
}

solver::Points places(Session& s, double frame) {
    return *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes.at(0).points;
}

} // namespace

TEST_CASE("a scene of cloth alone is simulated, alike in metres and centimetres", "[nodes]") {
    Session metres(sheet(1)), centimetres(sheet(100));
    const solver::Points one = places(metres, 8), other = places(centimetres, 8);
    REQUIRE(one.size() == 45);
    double lowest = 0;
    for (std::size_t v = 0; v < one.size(); ++v) {
        CHECK((one[v] - other[v] / 100).norm() < 1e-6);
        lowest = std::min(lowest, one[v].y());
    }
    CHECK(lowest < -0.1);
    const auto report = metres.get<nodes::SolveReport>("solver", "outReport", 8);
    CHECK(report.record.converged);
    CHECK(report.triangles == 64);
    CHECK(report.tets == 0);
    CHECK(report.dofs == 135);
    CHECK(std::find(report.terms.begin(), report.terms.end(), "cloth") != report.terms.end());
    CHECK(metres.counter.warnings.empty());
}

TEST_CASE("at rest a held cloth weighs its layers, by their painted densities", "[nodes]") {
    Session s(sheet(1, "", R"(, "integrator": "QuasiStatic", "gravity": [10, 0, 0])"));
    const auto report = s.get<nodes::SolveReport>("solver", "outReport", 2);
    CHECK(report.record.converged);
    // The upper layer goes from 0 at x = 0 to half at x = 0.5: 0.3 + 0.6 x there, 0.3 elsewhere.
    const double mass = 0.5 * (0.3 + 0.5 * 0.5 * 0.6 * 0.5);
    double force = 0;
    for (const solver::Measured& m : report.record.measured)
        if (m.what->term == "hold" && m.what->name == "force_x_N") force = m.value;
    CHECK(force == Approx(-10 * mass).epsilon(1e-4));
}

TEST_CASE("a cloth that is keyed to shrink does so", "[nodes]") {
    Session s(sheet(1, R"(, "restScaleEnvelope": {"keys": [[1, 0], [4, 1]]})", R"(, "gravity": [0, 0, 0])"));
    s.set("cotton", "restScale", "0.8");
    s.set("heavy", "restScale", "0.8");
    double end = -1;
    for (const solver::Vec3& p : places(s, 30)) end = std::max(end, p.x());
    CHECK(end == Approx(-0.5 + 0.8).epsilon(0.02));
}

TEST_CASE("what cannot ride on a cloth is told so", "[nodes]") {
    const std::string rider =
        R"(, "rider": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "cloth.outBody"}}})";
    CHECK(codes(sheet(1) + rider, "rider", "outMeshes") == Codes{"FE218"});
}

TEST_CASE("a cloth that is switched off stands still, and starts from rest when it comes on", "[nodes]") {
    Session s(sheet(1, R"(, "enable": {"keys": [[1, true], [4, false], [6, true]]})"));
    s.set("solver", "forces", "[]");
    const solver::Points third = places(s, 3);
    CHECK(third[0].y() < -0.01);
    CHECK(places(s, 5) == third);
    CHECK(places(s, 6)[0].y() - third[0].y() == Approx(-9.8 / 576).epsilon(1e-6)); // backward Euler's first step
    Session late(sheet(1, R"(, "enable": {"keys": [[1, false], [4, true]]})"));
    CHECK(places(late, 3) == places(late, 1));
    CHECK((places(late, 6).back() - places(late, 3).back()).norm() > 1e-3);
    Session never(sheet(1, R"(, "enable": {"keys": [[1, false], [4, false]]})"));
    never.set("solver", "forces", "[]");
    CHECK(never.get<nodes::SolveReport>("solver", "outReport", 3).bodies == 0);
}

TEST_CASE("inertial damping of a cloth arrives, is reported, and run-up weighs it where it is asked to", "[nodes]") {
    const auto fall = [](const std::string& cloth, const std::string& solver) {
        Session s(sheet(1, cloth, solver));
        s.set("solver", "forces", "[]");
        const auto report = s.get<nodes::SolveReport>("solver", "outReport", 3);
        CHECK((std::find(report.terms.begin(), report.terms.end(), "inertialDamping") != report.terms.end()) ==
              !cloth.empty());
        return places(s, 3)[0].y();
    };
    const double step = -9.8 / 576;                        // of backward Euler's first step from rest
    CHECK(fall("", "") == Approx(3 * step).epsilon(1e-6)); // one, then two of them
    CHECK(fall(R"(, "inertialDamping": 1)", "") == Approx(2 * step).epsilon(1e-6));
    CHECK(fall(R"(, "inertialDamping": 1)",
               R"(, "affectInertialDamping": true, "affectSolverGravity": false, "runupWeight": 0)") ==
          Approx(3 * step).epsilon(1e-6));
    // 0.3 of the speed remains after a frame.
    CHECK(fall(R"(, "inertialDamping": 0.7)", "") == Approx(2.3 * step).epsilon(1e-6));
}

TEST_CASE("a cloth that runs out of iterations is told how many it may need", "[nodes]") {
    Session s(sheet(1, "", R"(, "solverToleranceFactor": 1e-12)"));
    s.set("solver", "maxNewtonIterations", "2");
    places(s, 2);
    REQUIRE_FALSE(s.counter.warnings.empty());
    CHECK(s.counter.warnings[0].code == "FE301");
    CHECK(s.counter.warnings[0].hint.find("Raise maxNewtonIterations from 2 to 60: cloth") == 0);
}

TEST_CASE("a solve that ends before it runs out of iterations is not told to take more", "[nodes]") {
    // Flat and without tension: nothing bears the cube that hangs on the sheet.
    Session s(
        R"("plane": {"type": "polyPlane", "inputs": {"width": 1, "height": 1, "subdivisionsWidth": 4, "subdivisionsHeight": 4}},
        "cotton": {"type": "zMaterial", "inputs": {"tensileStiffness": 500, "shearStiffness": 50, "clothMassDensity": 0.2}},
        "cloth": {"type": "zCloth", "inputs": {"mesh": {"from": "plane.outMesh"}, "materials": [{"from": "cotton.outMaterial"}]}},
        "edge": {"type": "weights", "inputs": {"mesh": {"from": "plane.outMesh"}, "mode": "ramp", "axis": "z", "start": -0.4, "end": -0.49}},
        "pin": {"type": "zHold", "inputs": {"tissue": {"from": "cloth.outBody"}, "weights": {"from": "edge.outWeights"}}},
        "box": {"type": "polyCube", "inputs": {"width": 0.2, "height": 0.2, "depth": 0.2, "subdivisionsWidth": 3, "subdivisionsHeight": 3, "subdivisionsDepth": 3}},
        "below": {"type": "transform", "inputs": {"mesh": {"from": "box.outMesh"}, "translate": [0, -0.12, 0]}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 20000}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "below.outMesh"}, "tetSize": 0.1}},
        "cube": {"type": "zTissue", "inputs": {"mesh": {"from": "below.outMesh"}, "tets": {"from": "tets.outTets"},
                 "materials": [{"from": "flesh.outMaterial"}]}},
        "top": {"type": "weights", "inputs": {"mesh": {"from": "below.outMesh"}, "mode": "ramp", "axis": "y", "start": -0.05, "end": -0.03}},
        "tie": {"type": "zAttachment", "inputs": {"source": {"from": "cube.outBody"}, "target": {"from": "cloth.outBody"},
                "weights": {"from": "top.outWeights"}, "stiffness": 1e5}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "integrator": "QuasiStatic", "maxNewtonIterations": 30,
                   "bodies": [{"from": "cloth.outBody"}, {"from": "cube.outBody"}],
                   "attachments": [{"from": "tie.outAttachment"}], "forces": [{"from": "pin.outForce"}]}})");
    places(s, 2);
    REQUIRE_FALSE(s.counter.warnings.empty());
    CHECK(s.counter.warnings.back().code == "FE301");
    CHECK(s.counter.warnings.back().hint.find("More iterations would not help") == 0);
}
