// zRestShape from end to end: targets on the tissue's mesh, in any unit, painted and keyed, on lattices that the
// surface cuts.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "solver/mesh/surface_mesh.h"

#include <cmath>

using namespace bench;

namespace {

/// A box of 8 x 4 x 4 cm in its lattice that nothing holds, with a target that is the box scaled along its axes, in
/// steps so long that it comes to rest in a few; `u` scene units a metre.
std::string box(double u, const std::string& scale, const std::string& shape = "", const std::string& tissue = "",
                const std::string& element = "linear") {
    return R"("mesh": {"type": "polyCube", "inputs": {"width": )" + number(0.08 * u) + R"(, "height": )" +
           number(0.04 * u) + R"(, "depth": )" + number(0.04 * u) + R"(, "subdivisionsWidth": 4}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1000, "poissonsRatio": 0.45}},
        "sculpt": {"type": "transform", "inputs": {"mesh": {"from": "mesh.outMesh"}, "scale": )" +
           scale + R"(, "translate": [3, 4, 5], "rotate": [10, 20, 30]}},
        "shape": {"type": "zRestShape", "inputs": {"target": {"from": "sculpt.outMesh"})" +
           shape + R"(}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": )" +
           number(0.03 * u) + R"(, "element": ")" + element + R"("}},
        "box": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"},
            "materials": [{"from": "flesh.outMaterial"}], "restShapes": [{"from": "shape.outRestShape"}])" +
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

/// Greatest difference of distances between vertices from those of the model scaled along its axes.
double misshape(Session& s, double frame, const solver::Vec3& scale) {
    const solver::Points is = points(s, frame), model = *s.get<nodes::Mesh>("mesh", "outMesh").points;
    double worst = 0;
    for (std::size_t a = 0; a < is.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
            const double wanted = scale.cwiseProduct(model[a] - model[b]).norm();
            worst = std::max(worst, std::abs((is[a] - is[b]).norm() - wanted) / wanted);
        }
    return worst;
}

} // namespace

TEST_CASE("a tissue comes to rest in its target, by the keyed weight, in any unit", "[nodes][restshape]") {
    for (const char* element : {"linear", "quadratic"})
        for (const double u : {1.0, 100.0}) {
            Session s(box(u, "[1.5, 0.8, 1]", R"(, "envelope": 0.5, "targetWeight":
                {"keys": [[1, 0], [2, 0], [3, 2], [6, 2], [7, 1], [10, 1], [11, -2]], "interp": "step"})",
                          "", element));
            for (const auto& [frame, w] : {std::pair{2.0, 0.0}, {6.0, 1.0}, {10.0, 0.5}, {15.0, -1.0}}) {
                INFO(element << ", " << u << ", frame " << frame);
                CHECK(misshape(s, frame, {std::pow(1.5, w), std::pow(0.8, w), 1}) < 1e-6);
                const auto report = s.get<nodes::SolveReport>("solver", "outReport", frame);
                CHECK(report.record.energy < 1e-12);
                CHECK(report.record.min_j == Approx(1).epsilon(1e-6));
                CHECK(report.worst.j == Approx(report.record.min_j).epsilon(1e-9));
            }
            CHECK(s.counter.warnings.empty());
            CHECK(s.counter.computes["tets"] == 1);
        }
}

TEST_CASE("targets blend, and go with restScale", "[nodes][restshape]") {
    Session s(box(1, "[2, 1, 1]", R"(, "targetWeight": 0.5)", R"(, "restScaleEnvelope": 0.5)") +
              R"(, "wider": {"type": "transform", "inputs": {"mesh": {"from": "mesh.outMesh"}, "scale": [0.5, 3, 1]}},
                  "second": {"type": "zRestShape", "inputs": {"target": {"from": "wider.outMesh"}, "targetWeight": 0.25}})");
    s.set("box", "restShapes", R"([{"from": "shape.outRestShape"}, {"from": "second.outRestShape"}])");
    s.set("flesh", "restScale", "1.21");
    CHECK(misshape(s, 6, 1.1 * solver::Vec3(std::pow(2, 0.25), std::pow(3, 0.25), 1)) < 1e-6);
}

TEST_CASE("a painted target acts where it is painted", "[nodes][restshape]") {
    Session s(
        box(1, "[1, 0.6, 1]", R"(, "weights": {"from": "paint.outWeights"})") +
        R"(, "paint": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "axis": "x",
                  "start": -0.04, "end": 0.04}})");
    const solver::Points before = points(s, 1), after = points(s, 6);
    const auto height = [&](double x) {
        double low = 0, high = 0;
        for (std::size_t v = 0; v < before.size(); ++v)
            if (std::abs(before[v].x() - x) < 1e-9) {
                low = std::min(low, after[v].y());
                high = std::max(high, after[v].y());
            }
        return (high - low) / 0.04;
    };
    CHECK(height(-0.04) == Approx(1).margin(0.08));
    CHECK(height(0.04) == Approx(0.6).margin(0.08));
    CHECK(height(0) == Approx(std::sqrt(0.6)).margin(0.03));
    Session none(box(1, "[1, 0.6, 1]", R"(, "weights": [0])"));
    CHECK(volume(none, 4) == Approx(0.08 * 0.04 * 0.04).epsilon(1e-9));
}

TEST_CASE("a run with targets goes on from what was saved, and an edit runs again from its first key that changed",
          "[nodes][restshape]") {
    const std::string all = box(1, "[1.5, 0.8, 1]", R"(, "targetWeight": {"keys": [[1, 0], [4, 0], [6, 1]]})");
    Session s(all);
    points(s, 8);
    CHECK(s.counter.steps["solver"] == 8);
    const auto bytes = s.evaluator.save_state({s.graph, {"solver", "outMeshes"}, 5});
    Session resumed(all);
    resumed.evaluator.load_state({resumed.graph, {"solver", "outMeshes"}, 5}, bytes);
    CHECK(points(resumed, 8) == points(s, 8));
    s.set("shape", "targetWeight", R"({"keys": [[1, 0], [4, 0], [6, 0.5]]})");
    points(s, 8);
    CHECK(s.counter.steps["solver"] == 12);
    CHECK(s.counter.computes["tets"] == 1);
}

TEST_CASE("targets that do not fit the tissue are refused", "[nodes][restshape]") {
    std::string text;
    Session other(box(1, "[1, 1, 1]") + R"(, "coarse": {"type": "polyCube"})");
    other.set("shape", "target", R"({"from": "coarse.outMesh"})");
    CHECK(codes([&] { other.pull("box", "outBody"); }, &text) == Codes{"FE285"});
    CHECK(text.find("the target of shape has 8 vertices, the tissue's mesh 20") != std::string::npos);
    Session faces(box(1, "[1, 1, 1]") + R"(, "turned": {"type": "polyCube", "inputs": {"subdivisionsHeight": 4}})");
    faces.set("shape", "target", R"({"from": "turned.outMesh"})");
    CHECK(codes([&] { faces.pull("box", "outBody"); }, &text) == Codes{"FE285"});
    CHECK(text.find("other faces") != std::string::npos);
    Session mirrored(box(1, "[1, -1, 1]"));
    CHECK(codes([&] { mirrored.pull("box", "outBody"); }, &text) == Codes{"FE286"});
    CHECK(text.find("inside out") != std::string::npos);
    Session paint(box(1, "[1, 1, 1]", R"(, "weights": [1, 0])"));
    CHECK(codes([&] { paint.pull("box", "outBody"); }) == Codes{"FE204"});
    Session far(box(1, "[200, 1, 1]", R"(, "targetWeight": 3)"));
    CHECK(codes([&] { far.pull("solver", "outMeshes"); }) == Codes{"FE247"});
    Session moving(box(1, "[1, 1, 1]"));
    moving.set("sculpt", "scale", R"({"keys": [[1, [1, 1, 1]], [3, [2, 1, 1]]]})");
    moving.pull("solver", "outMeshes", 1);
    CHECK(codes([&] { moving.pull("solver", "outMeshes", 3); }) == Codes{"FE211"});
}
