// Attachments from the graph: modes that are keyed, what an edit of them computes anew, goals.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include <algorithm>
#include <cmath>

using namespace bench;

namespace {

/// A cube under a wide plate, 1 cm off, with `tie` as the attributes of its attachment.
std::string hanging(const std::string& tie, const std::string& solver = "") {
    return R"("mesh": {"type": "polyCube", "inputs": {"width": 0.1, "height": 0.1, "depth": 0.1, "subdivisionsWidth": 2, "subdivisionsHeight": 2, "subdivisionsDepth": 2}},
        "slab": {"type": "polyCube", "inputs": {"width": 4, "height": 0.1, "depth": 4}},
        "above": {"type": "transform", "inputs": {"mesh": {"from": "slab.outMesh"}, "translate": [0, 0.11, 0]}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "above.outMesh"}}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e6}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": 0.05}},
        "cube": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "top": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "axis": "y", "start": 0.049, "end": 0.05}},
        "tie": {"type": "zAttachment", "inputs": {"source": {"from": "cube.outBody"}, "target": {"from": "bone.outBody"}, "weights": {"from": "top.outWeights"}, "stiffness": 1e8)" +
           tie + R"(}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "maxNewtonIterations": 40, "gravity": [2, -9.8, 0],
            "bodies": [{"from": "bone.outBody"}, {"from": "cube.outBody"}], "attachments": [{"from": "tie.outAttachment"}])" +
           solver + "}}";
}

solver::Vec3 centre(Session& s, double frame) {
    solver::Vec3 sum = solver::Vec3::Zero();
    const solver::Points points = *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[1].points;
    for (const solver::Vec3& p : points) sum += p;
    return sum / static_cast<double>(points.size());
}

} // namespace

TEST_CASE("a keyed attachment holds, slides and lets go", "[nodes]") {
    Session s(hanging(R"(, "attachmentMode": {"keys": [[1, "fixed"], [5, "sliding"], [15, "none"]]})"));
    const double h = 1.0 / 24;
    CHECK(std::abs(centre(s, 4).x()) < 1e-3);
    CHECK(std::abs(centre(s, 4).y()) < 1e-3);
    // Backward Euler from rest under 2 m/s^2, ten steps of it: x = a h^2 n (n + 1) / 2.
    CHECK(centre(s, 14).x() == Approx(2 * h * h * 55).epsilon(0.02));
    CHECK(std::abs(centre(s, 14).y()) < 1e-3);
    const double fall = centre(s, 17).y() - 2 * centre(s, 16).y() + centre(s, 15).y();
    CHECK(fall / (h * h) == Approx(-9.8).epsilon(0.01));
    const auto terms = [&](double frame) { return s.get<nodes::SolveReport>("solver", "outReport", frame).terms; };
    const auto has = [&](double frame, const char* term) {
        const std::vector<std::string> all = terms(frame);
        return std::find(all.begin(), all.end(), term) != all.end();
    };
    CHECK((has(4, "attachment") && !has(4, "sliding")));
    CHECK((!has(10, "attachment") && has(10, "sliding")));
    CHECK((!has(16, "attachment") && !has(16, "sliding")));
    CHECK(s.get<nodes::SolveReport>("solver", "outReport", 10).attachments == 1);
    CHECK(s.get<nodes::SolveReport>("solver", "outReport", 16).attachments == 0);
    CHECK(s.counter.warnings.empty());
}

TEST_CASE("a key on an attachment's mode runs again from its frame on, not before", "[nodes]") {
    Session s(hanging(""));
    s.pull("solver", "outMeshes", 12);
    CHECK(s.counter.steps["solver"] == 12);
    const solver::Vec3 before = centre(s, 8);
    s.set("tie", "attachmentMode", R"({"keys": [[1, "fixed"], [9, "none"]]})");
    s.pull("solver", "outMeshes", 12);
    CHECK(s.counter.steps["solver"] == 12 + 4);
    CHECK(centre(s, 8) == before);
    CHECK(centre(s, 12).y() < -0.05);
    CHECK(s.counter.steps["solver"] == 12 + 4);
}

TEST_CASE("QuasiStatic does not take sliding for a tie", "[nodes]") {
    std::string text;
    CHECK(codes(hanging(R"(, "attachmentMode": "sliding")", R"(, "integrator": "QuasiStatic")"), "solver", "outMeshes",
                &text, 2) == Codes{"FE303"});
    CHECK(text.find("cube floats") != std::string::npos);
}

TEST_CASE("a goal draws each point to the same point", "[nodes]") {
    const auto goal = [](const std::string& mesh, const std::string& inputs) {
        return R"("mesh": {"type": "polyCube", "inputs": {"width": 0.1, "height": 0.1, "depth": 0.1, "subdivisionsWidth": 2, "subdivisionsHeight": 2, "subdivisionsDepth": 2}},
        "moved": {"type": "transform", "inputs": {"mesh": {"from": ")" +
               mesh +
               R"(.outMesh"}, "translate": {"keys": [[1, [0, 0, 0]], [2, [0.3, 0.1, 0]]]}, "rotate": {"keys": [[1, [0, 0, 0]], [2, [0, 50, 0]]]}}},
        "other": {"type": "polyCube", "inputs": {"width": 0.1, "height": 0.1, "depth": 0.1, "subdivisionsWidth": 4, "subdivisionsHeight": 1, "subdivisionsDepth": 2}},
        "goal": {"type": "zBone", "inputs": {"mesh": {"from": "moved.outMesh"}}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e4}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": 0.05}},
        "cube": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "tie": {"type": "zGoalAttachment", "inputs": {"source": {"from": "cube.outBody"}, "target": {"from": "goal.outBody"})" +
               inputs + R"(}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "maxNewtonIterations": 60, "solverToleranceFactor": 1e-2, "gravity": [0, 0, 0], "integrator": "QuasiStatic",
            "bodies": [{"from": "goal.outBody"}, {"from": "cube.outBody"}], "attachments": [{"from": "tie.outAttachment"}]}})";
    };
    // Rigid motion costs nothing: the cube arrives exactly.
    Session s(goal("mesh", ""));
    const nodes::MeshList all = s.get<nodes::MeshList>("solver", "outMeshes", 2);
    double farthest = 0;
    for (std::size_t v = 0; v < all.meshes[1].points->size(); ++v)
        farthest = std::max(farthest, ((*all.meshes[1].points)[v] - (*all.meshes[0].points)[v]).norm());
    CHECK(farthest < 1e-6);
    std::string text;
    CHECK(codes(goal("other", ""), "solver", "outMeshes", &text, 1) == Codes{"FE217"});
    CHECK(text.find("cube has 26 vertices and goal has 30") != std::string::npos);
    CHECK(codes(goal("mesh", R"(, "weights": [0])"), "solver", "outMeshes", &text, 1) == Codes{"FE212"});
}
