// Rest scale and muscle growth from end to end: what zMaterial, zTissue and zFiber say about them, in any scene unit.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "solver/mesh/surface_mesh.h"

#include <cmath>

using namespace bench;

namespace {

/// A box of 8 x 4 x 4 cm in its lattice that nothing holds, in steps so long that it comes to rest in a few; `u` scene
/// units a metre.
std::string box(double u, const std::string& material, const std::string& tissue, const std::string& fiber = "",
                const std::string& element = "linear") {
    return R"("mesh": {"type": "polyCube", "inputs": {"width": )" + number(0.08 * u) + R"(, "height": )" +
           number(0.04 * u) + R"(, "depth": )" + number(0.04 * u) + R"(, "subdivisionsWidth": 4}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1000, "poissonsRatio": 0.45)" +
           material + R"(}},
        "fibre": {"type": "zFiber", "inputs": {"direction": [1, 0, 0])" +
           fiber + R"(}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": )" +
           number(0.03 * u) + R"(, "element": ")" + element + R"("}},
        "box": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"},
            "materials": [{"from": "flesh.outMaterial"}], "fibers": [{"from": "fibre.outFiber"}])" +
           tissue + R"(}},
        "solver": {"type": "zSolver", "inputs": {"scale": )" +
           number(u) + R"(, "maxNewtonIterations": 50, "framesPerSecond": 0.1, "gravity": [0, 0, 0],
            "solverToleranceFactor": 0.001, "bodies": [{"from": "box.outBody"}]}})";
}

solver::Points points(Session& s, double frame) {
    return *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[0].points;
}

double volume(Session& s, double frame) {
    const nodes::Mesh mesh = s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[0];
    return solver::enclosed_volume(*mesh.points, mesh.surface().triangles);
}

/// Distance of the first and the last vertex, which lie across the box.
double across(Session& s, double frame) {
    const solver::Points p = points(s, frame);
    return (p.front() - p.back()).norm();
}

} // namespace

TEST_CASE("a tissue of restScale comes to rest exactly scaled, in any unit, by its envelope", "[nodes]") {
    for (const char* element : {"linear", "quadratic"})
        for (const double u : {1.0, 100.0}) {
            Session s(box(u, R"(, "restScale": 0.8)",
                          R"(, "restScaleEnvelope": {"keys": [[1, 0], [2, 0], [3, 1], [6, 1], [7, -1], [10, -1],
                            [11, 2]], "interp": "step"})",
                          "", element));
            const double size = across(s, 1);
            for (const auto& [frame, e] : {std::pair{2.0, 0.0}, {6.0, 1.0}, {10.0, -1.0}, {15.0, 2.0}}) {
                INFO(element << ", " << u << ", frame " << frame);
                const double scale = std::pow(0.8, e);
                CHECK(across(s, frame) == Approx(scale * size).epsilon(1e-7));
                CHECK(volume(s, frame) == Approx(scale * scale * scale * 0.08 * 0.04 * 0.04 * u * u * u).epsilon(1e-7));
                const auto report = s.get<nodes::SolveReport>("solver", "outReport", frame);
                CHECK(report.record.energy < 1e-12);
                CHECK(report.record.min_j == Approx(1).epsilon(1e-6));
                CHECK(report.worst.j == Approx(report.record.min_j).epsilon(1e-9));
                const bool named =
                    std::find(report.terms.begin(), report.terms.end(), "restShapeChange") != report.terms.end();
                CHECK(named == (e != 0));
            }
            CHECK(s.counter.warnings.empty());
        }
}

TEST_CASE("a muscle grows across its fibres by keys, without a line of action it does not follow one", "[nodes]") {
    const std::string grows = R"(, "enableMuscleGrowth": true, "muscleGrowthScale": {"keys": [[1, 1], [2, 1.5]]})";
    const double model = 0.08 * 0.04 * 0.04;
    Session s(box(1, "", "", grows));
    CHECK(volume(s, 5) == Approx(2.25 * model).epsilon(1e-7));
    const solver::Vec3 at_rest = points(s, 1).front() - points(s, 1).back();
    REQUIRE(std::abs(at_rest.x()) > 0.07); // from end to end: as long as it was, and wider
    CHECK(across(s, 5) == Approx(solver::Vec3(at_rest.x(), 1.5 * at_rest.y(), 1.5 * at_rest.z()).norm()).epsilon(1e-7));
    CHECK(s.get<nodes::SolveReport>("solver", "outReport", 5).record.energy < 1e-12);
    Session half(box(1, "", "", grows + R"(, "envelope": 0.5, "weights": [0.5])"));
    CHECK(volume(half, 5) == Approx(std::sqrt(1.5) * model).epsilon(1e-7));
    CHECK((s.counter.warnings.empty() && half.counter.warnings.empty()));

    Session off(box(1, "", "", R"(, "muscleGrowthScale": 1.5)"));
    CHECK(volume(off, 5) == Approx(model).epsilon(1e-12));
    CHECK(off.counter.warnings.empty());
    Session alone(box(1, "", "", grows + R"(, "useLoaForMuscleGrowth": true)"));
    CHECK(volume(alone, 5) == Approx(model).epsilon(1e-12));
    REQUIRE_FALSE(alone.counter.warnings.empty());
    CHECK(alone.counter.warnings[0].code == "FE248");
    CHECK(alone.counter.warnings[0].node == "fibre");
    CHECK(alone.counter.warnings[0].attribute == "useLoaForMuscleGrowth");
}

TEST_CASE("painted restScale acts where its layer is", "[nodes]") {
    // A layer of weight 0.5 and envelope 0.5 over one of restScale 1.2: 0.75 of that and 0.25 of its own.
    const std::string over = R"(, "over": {"type": "zMaterial", "inputs": {"youngsModulus": 1000,
        "poissonsRatio": 0.45, "restScale": 0.8, "weights": [0.5], "envelope": 0.5}})";
    std::string nodes = box(1, R"(, "restScale": 1.2)", "") + over;
    const std::string one = R"([{"from": "flesh.outMaterial"}])";
    nodes.replace(nodes.find(one), one.size(), R"([{"from": "flesh.outMaterial"}, {"from": "over.outMaterial"}])");
    Session s(nodes);
    CHECK(across(s, 5) == Approx((0.75 * 1.2 + 0.25 * 0.8) * across(s, 1)).epsilon(1e-7));

    // Painted from one end to the other the box becomes a wedge: wide where nothing shrinks it.
    std::string ramp = nodes;
    ramp.replace(ramp.find(R"("weights": [0.5], "envelope": 0.5)"), 33, R"("weights": {"from": "paint.outWeights"})");
    ramp.replace(ramp.find(R"("restScale": 1.2)"), 16, R"("restScale": 1)");
    ramp += R"(, "paint": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "axis": "x",
        "start": -0.04, "end": 0.04}})";
    Session wedge(ramp);
    const solver::Points before = points(wedge, 1), after = points(wedge, 6);
    const auto height = [&](double x) { // of the face there, by the vertices of its lower and upper edge
        double low = 0, high = 0;
        for (std::size_t v = 0; v < before.size(); ++v)
            if (std::abs(before[v].x() - x) < 1e-9) {
                low = std::min(low, after[v].y());
                high = std::max(high, after[v].y());
            }
        return (high - low) / 0.04;
    };
    CHECK(height(-0.04) == Approx(1).margin(0.06));
    CHECK(height(0.04) == Approx(0.8).margin(0.06));
    CHECK(height(0) == Approx(0.9).margin(0.03));
}

TEST_CASE("an edit of a keyed rest shape runs again from its first key that changed", "[nodes]") {
    Session s(box(1, R"(, "restScale": 0.8)", R"(, "restScaleEnvelope": {"keys": [[1, 0], [4, 0], [6, 1]]})"));
    points(s, 8);
    CHECK(s.counter.steps["solver"] == 8);
    const int meshed = s.counter.computes["tets"];
    s.set("box", "restScaleEnvelope", R"({"keys": [[1, 0], [4, 0], [6, -1]]})");
    points(s, 4);
    CHECK(s.counter.steps["solver"] == 8);
    points(s, 8);
    CHECK(s.counter.steps["solver"] == 12);
    s.set("fibre", "enableMuscleGrowth", R"({"keys": [[1, false], [7, true]]})");
    points(s, 8); // a scale of 1: nothing grows, nothing runs
    CHECK(s.counter.steps["solver"] == 12);
    s.set("fibre", "muscleGrowthScale", "1.2");
    points(s, 8);
    CHECK(s.counter.steps["solver"] == 14);
    CHECK(s.counter.computes["tets"] == meshed);
}

TEST_CASE("rest shapes that are none are refused at the attribute that asks for them", "[nodes]") {
    std::string text;
    CHECK(codes(box(1, R"(, "restScale": 0)", ""), "solver", "outMeshes", &text) == Codes{"DG013"});
    CHECK(codes(box(1, R"(, "restScale": -1)", ""), "solver", "outMeshes", &text) == Codes{"DG013"});
    CHECK(codes(box(1, "", "", R"(, "muscleGrowthScale": 0)"), "solver", "outMeshes", &text) == Codes{"DG013"});
    CHECK(codes(box(1, R"(, "restScale": 0.5)", R"(, "restScaleEnvelope": -12)"), "box", "outBody", &text) ==
          Codes{"FE247"});
    CHECK_THAT(text, Catch::Contains("box.restScaleEnvelope") && Catch::Contains("scales the tissue at rest by 4096"));
    std::string twice = box(1, "", "", R"(, "enableMuscleGrowth": true, "muscleGrowthScale": 100)");
    const std::string one = R"([{"from": "fibre.outFiber"}])";
    twice.replace(twice.find(one), one.size(), R"([{"from": "fibre.outFiber"}, {"from": "other.outFiber"}])");
    twice += R"(, "other": {"type": "zFiber", "inputs": {"direction": [1, 0, 0], "enableMuscleGrowth": true,
        "muscleGrowthScale": 100}})";
    CHECK(codes(twice, "box", "outBody", &text) == Codes{"FE247"});
    CHECK_THAT(text, Catch::Contains("box.fibers") && Catch::Contains("10000"));
}

TEST_CASE("a rest shape that changes gives the same bits on one thread and two, and goes on from what was saved",
          "[nodes]") {
    for (const char* element : {"linear", "quadratic"}) {
        std::string nodes =
            box(100, R"(, "restScale": 0.8, "volumeConservation": 1e5)",
                R"(, "restScaleEnvelope": {"keys": [[1, 0], [6, 1]]})",
                R"(, "enableMuscleGrowth": true, "muscleGrowthScale": {"keys": [[1, 1], [6, 1.4]]})", element);
        const std::string steps = R"("framesPerSecond": 0.1)";
        nodes.replace(nodes.find(steps), steps.size(), R"("integrator": "TR-BDF2", "stiffnessDamping": 0.01)");
        Session one(nodes, 1), two(nodes, 2);
        const engine::Digest expected = one.pull("solver", "outMeshes", 6).digest();
        CHECK(two.pull("solver", "outMeshes", 6).digest() == expected);
        for (double frame : {1.0, 4.0}) {
            const auto bytes = one.evaluator.save_state({one.graph, {"solver", "outMeshes"}, frame});
            Session resumed(nodes);
            resumed.evaluator.load_state({resumed.graph, {"solver", "outMeshes"}, frame}, bytes);
            CHECK(resumed.pull("solver", "outMeshes", 6).digest() == expected);
            CHECK(resumed.counter.steps["solver"] == static_cast<int>(6 - frame));
        }
    }
}
