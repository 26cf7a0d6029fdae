// The main job on real anatomy: the arm of graphs/scenes, up to the first full flexion of the elbow (frame 33).
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/nodes/bench.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>

using namespace sinew;

namespace {

const std::string folder = std::string(SINEW_SOURCE_DIR) + "/graphs/scenes/";

nlohmann::json read_json(const std::string& path) {
    std::ifstream in(path);
    REQUIRE(in);
    return nlohmann::json::parse(in);
}

/// "triceps_long" -> "tricepsLong", as the graph names its nodes.
std::string node_name(const std::string& file_name) {
    std::string out;
    for (std::size_t i = 0; i < file_name.size(); ++i)
        if (file_name[i] == '_')
            out += static_cast<char>(std::toupper(file_name[++i]));
        else
            out += file_name[i];
    return out;
}

struct Arm {
    std::shared_ptr<const engine::Graph> graph = engine::load_graph(nodes::make_registry(), folder + "arm.json").graph;
    engine::Evaluator evaluator;
    std::map<std::string, std::size_t> body; // by node name
    explicit Arm(int threads)
        : evaluator({}, threads) {
        const auto& list = std::get<std::vector<engine::Plug>>(graph->find("solver")->inputs.find("bodies")->second);
        for (std::size_t i = 0; i < list.size(); ++i) body[list[i].node] = i;
    }
    nodes::MeshList meshes(int frame) {
        return evaluator.pull({graph, {"solver", "outMeshes"}, double(frame)}).as<nodes::MeshList>();
    }
    nodes::SolveReport report(int frame) {
        return evaluator.pull({graph, {"solver", "outReport"}, double(frame)}).as<nodes::SolveReport>();
    }
    const solver::Points& points(const nodes::MeshList& meshes, const std::string& name) {
        return *meshes.meshes[body.at(name)].points;
    }
};

solver::Vec3 mean(const solver::Points& points, const std::vector<int>& vertices) {
    solver::Vec3 sum = solver::Vec3::Zero();
    for (const int v : vertices) sum += points[static_cast<std::size_t>(v)];
    return sum / static_cast<double>(vertices.size());
}

/// Length from origin to insertion, and the largest radius of gyration of a twelfth of it.
std::pair<double, double> length_and_girth(const solver::Points& points, const solver::Vec3& from,
                                           const solver::Vec3& to) {
    const double length = (to - from).norm();
    const solver::Vec3 axis = (to - from) / length;
    double girth = 0;
    for (int slice = 0; slice < 12; ++slice) {
        solver::Points across;
        for (const solver::Vec3& p : points) {
            const double s = (p - from).dot(axis) / length * 12;
            if (s >= slice && s < slice + 1) across.push_back(p - from - (p - from).dot(axis) * axis);
        }
        if (across.size() < 8) continue;
        solver::Vec3 centre = solver::Vec3::Zero();
        for (const solver::Vec3& p : across) centre += p / static_cast<double>(across.size());
        double squares = 0;
        for (const solver::Vec3& p : across) squares += (p - centre).squaredNorm() / static_cast<double>(across.size());
        girth = std::max(girth, std::sqrt(squares));
    }
    return {length, girth};
}

} // namespace

TEST_CASE("the arm flexes: converged, nothing inverted, muscles on their bones, the biceps short and thick") {
    Arm arm(0);
    const nlohmann::json attachments = read_json(folder + "arm_ziva/attachments.json")["attachments"];
    const nlohmann::json motion = read_json(folder + "arm_ziva/motion/arm_performance_A.json")["frames"];
    const nodes::MeshList rest = arm.meshes(1);
    int factorizations = 0, linear_iterations = 0, newton = 0;
    for (int frame = 2; frame <= 33; ++frame) {
        const nodes::MeshList meshes = arm.meshes(frame);
        const nodes::SolveReport report = arm.report(frame);
        INFO("frame " << frame);
        CHECK(report.record.converged);
        CHECK(report.record.inverted == 0);
        if (frame > 2) {
            factorizations += report.record.factorizations, newton += report.record.newton_iterations;
            linear_iterations += report.record.linear_iterations;
        }
        const nlohmann::json& bones = motion[static_cast<std::size_t>(frame) - 1]["bones"];
        for (const nlohmann::json& a : attachments) {
            const std::string target = a["target"], muscle = node_name(a["muscle"]);
            if (!bones.contains(target)) continue; // muscle to tendon
            const std::vector<double> m = bones[target];
            // What is painted ends at its rim: those points are held from one side only, or not at all.
            const std::vector<int> painted = a["vertices"];
            std::set<int> inner(painted.begin(), painted.end());
            for (const solver::Triangle& t : rest.meshes[arm.body.at(muscle)].topology->triangles)
                if (std::any_of(t.begin(), t.end(),
                                [&](int v) { return std::find(painted.begin(), painted.end(), v) == painted.end(); }))
                    for (const int v : t) inner.erase(v);
            double worst = 0, worst_inner = 0;
            for (const int v : painted) {
                const solver::Vec3& p = arm.points(rest, muscle)[static_cast<std::size_t>(v)];
                solver::Vec3 expected;
                for (int r = 0; r < 3; ++r) {
                    const std::size_t row = 4 * static_cast<std::size_t>(r);
                    expected[r] = m[row] * p[0] + m[row + 1] * p[1] + m[row + 2] * p[2] + m[row + 3];
                }
                const double off = (arm.points(meshes, muscle)[static_cast<std::size_t>(v)] - expected).norm();
                worst = std::max(worst, off);
                if (inner.contains(v)) worst_inner = std::max(worst_inner, off);
            }
            INFO(muscle << " on " << target);
            CHECK(worst_inner < 0.07); // centimetres
            CHECK(worst < 0.3);
        }
    }
    // A rig of stiff ends is solved by iterations on a factor that serves several of Newton's.
    CHECK(factorizations > 0);
    CHECK(factorizations <= 0.75 * newton);
    CHECK(linear_iterations >= newton);
    CHECK(linear_iterations <= 8 * newton);
    const std::vector<int> origin = attachments[0]["vertices"], insertion = attachments[1]["vertices"];
    const auto measure = [&](const nodes::MeshList& meshes) {
        const solver::Points& biceps = arm.points(meshes, "biceps");
        return length_and_girth(biceps, mean(biceps, origin), mean(biceps, insertion));
    };
    const auto [length_rest, girth_rest] = measure(rest);
    const auto [length_flexed, girth_flexed] = measure(arm.meshes(33));
    CHECK(length_flexed < 0.9 * length_rest);
    CHECK(girth_flexed > 1.08 * girth_rest);
}

TEST_CASE("the arm gives the same bits with one and two threads") {
    Arm one(1), two(2);
    for (const int frame : {8, 20}) {
        const auto digest = [&](Arm& arm) {
            return arm.evaluator.pull({arm.graph, {"solver", "outMeshes"}, double(frame)}).digest();
        };
        CHECK(digest(one) == digest(two));
    }
}
