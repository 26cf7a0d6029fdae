// The arm with tets made fine by paint: where they are fine, and that it moves like the arm.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/nodes/bench.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace bench;

namespace {

const std::string folder = std::string(SINEW_SOURCE_DIR) + "/graphs/scenes/";
const std::vector<std::pair<std::string, std::string>> muscles = { // node, mesh file
    {"biceps", "biceps"},
    {"brachialis", "brachialis"},
    {"coracobrachialis", "coracobrachialis"},
    {"tricepsLong", "triceps_long"},
    {"tricepsLateral", "triceps_lateral"},
    {"tricepsMedial", "triceps_medial"},
    {"tricepsTendon", "triceps_tendon"}};

nlohmann::json read_json(const std::string& path) {
    std::ifstream in(path);
    REQUIRE(in);
    return nlohmann::json::parse(in);
}

std::shared_ptr<const engine::Graph> scene(const std::string& name) {
    return engine::load_graph(nodes::make_registry(), folder + name).graph;
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Mean edge of the tets whose middle lies within a tet size of a painted vertex, and of those farther away.
struct EdgeLengths {
    double near = 0, far = 0;
    int tets_near = 0, tets_far = 0;
};

EdgeLengths edge_lengths(const solver::TetMesh& tets, const solver::Points& painted, double size) {
    EdgeLengths out;
    for (const auto& tet : tets.tets) {
        const auto v = [&](std::size_t k) { return tets.vertices[at(tet[k])]; };
        const solver::Vec3 middle = (v(0) + v(1) + v(2) + v(3)) / 4;
        double distance = std::numeric_limits<double>::max(), sum = 0;
        for (const solver::Vec3& p : painted) distance = std::min(distance, (p - middle).norm());
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j) sum += (v(i) - v(j)).norm() / 6;
        (distance < size ? out.near : out.far) += sum;
        ++(distance < size ? out.tets_near : out.tets_far);
    }
    out.near /= out.tets_near;
    out.far /= out.tets_far;
    return out;
}

} // namespace

TEST_CASE("the refined arm's tets are fine at its tendons and attachments and coarse in the bellies", "[nodes][arm]") {
    const auto graph = scene("arm_refined.json"), plain = scene("arm.json");
    engine::Evaluator evaluator;
    std::size_t count = 0, plain_count = 0;
    for (const auto& [muscle, file] : muscles) {
        INFO(muscle);
        const auto tets = evaluator.pull({graph, {muscle + "Tets", "outTets"}, 1}).as<nodes::TetMeshValue>().mesh;
        const auto surface = evaluator.pull({graph, {muscle + "Mesh", "outMesh"}, 1}).as<nodes::Mesh>().points;
        const auto& paint = std::get<engine::Plug>(graph->find(muscle + "Tets")->inputs.find("weights")->second);
        const auto weights = evaluator.pull({graph, paint, 1}).as<engine::NumberList>();
        solver::Points painted;
        for (std::size_t v = 0; v < surface->size(); ++v)
            if (weights.at(v) > 0) painted.push_back((*surface)[v]);
        const auto& size = std::get<engine::Value>(graph->find(muscle + "Tets")->inputs.find("tetSize")->second);
        const EdgeLengths edges = edge_lengths(*tets, painted, size.as<double>());
        CAPTURE(edges.near, edges.far, edges.tets_near, edges.tets_far);
        CHECK(edges.tets_near > 50);
        CHECK(edges.tets_far > 5); // the medial head grows from the bone nearly everywhere
        CHECK(edges.near < 0.7 * edges.far);
        count += tets->tets.size();
        plain_count +=
            evaluator.pull({plain, {muscle + "Tets", "outTets"}, 1}).as<nodes::TetMeshValue>().mesh->tets.size();
    }
    CAPTURE(count, plain_count);
    CHECK(std::abs(double(count) / double(plain_count) - 1) < 0.2); // about as many as the arm has
}

TEST_CASE("the refined arm's paint covers every attachment of its muscles to bones and tendons", "[nodes][arm]") {
    const auto graph = scene("arm_refined.json");
    engine::Evaluator evaluator;
    const nlohmann::json file = read_json(folder + "arm_ziva/attachments.json");
    for (const nlohmann::json& a : file["attachments"]) {
        const std::string of = a["muscle"];
        const auto muscle = std::find_if(muscles.begin(), muscles.end(), [&](const auto& m) { return m.second == of; });
        REQUIRE(muscle != muscles.end());
        const auto& paint = std::get<engine::Plug>(graph->find(muscle->first + "Tets")->inputs.find("weights")->second);
        const auto weights = evaluator.pull({graph, paint, 1}).as<engine::NumberList>();
        INFO(of << " at " << std::string(a["target"]));
        int bare = 0;
        for (const int v : a["vertices"].get<std::vector<int>>()) bare += !(weights[at(v)] > 0);
        CHECK(bare == 0);
    }
}

TEST_CASE("the refined arm moves as the arm does, converged and with no tet inverted", "[nodes][arm]") {
    const auto refined = scene("arm_refined.json"), plain = scene("arm.json");
    engine::Evaluator evaluator;
    constexpr int last = 28;
    for (int frame = 2; frame <= last; ++frame) {
        INFO("frame " << frame);
        const auto report = evaluator.pull({refined, {"solver", "outReport"}, double(frame)}).as<nodes::SolveReport>();
        CHECK(report.record.converged);
        CHECK(report.record.inverted == 0);
    }
    const auto meshes = [&](const auto& graph, int frame) {
        return evaluator.pull({graph, {"solver", "outMeshes"}, double(frame)}).template as<nodes::MeshList>().meshes;
    };
    const auto rest = meshes(plain, 1), a = meshes(plain, last), b = meshes(refined, last);
    const auto& bodies = std::get<std::vector<engine::Plug>>(plain->find("solver")->inputs.find("bodies")->second);
    REQUIRE(a.size() == bodies.size());
    REQUIRE(b.size() == bodies.size());
    double difference = 0, way = 0;
    for (std::size_t body = 0; body < bodies.size(); ++body) {
        const auto is_it = [&](const auto& m) { return m.first == bodies[body].node; };
        if (std::none_of(muscles.begin(), muscles.end(), is_it)) continue;
        const solver::Points &p = *a[body].points, &q = *b[body].points, &r = *rest[body].points;
        REQUIRE(p.size() == q.size());
        double apart = 0, moved = 0;
        for (std::size_t v = 0; v < p.size(); ++v) apart += (p[v] - q[v]).norm(), moved += (p[v] - r[v]).norm();
        difference = std::max(difference, apart / static_cast<double>(p.size()));
        way = std::max(way, moved / static_cast<double>(p.size()));
    }
    CAPTURE(difference, way);
    CHECK(difference < 0.3); // centimetres, on average over the vertices of any muscle
    CHECK(way > 3 * difference);
}
