// Contact on the command line: bodies come to rest on each other, the report says how hard they press, and what is
// switched off falls through.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

using namespace sinew::test;
using Catch::Detail::Approx;
using nlohmann::json;

namespace {

/// A cube of one metre, in lattice tets that its surface cuts, above the flat top of a bone at y = 0; a second tissue
/// on it where asked for.
json falling(bool two) {
    json graph = json::parse(R"({
      "format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 40},
      "nodes": {
        "slab": {"type": "polyCube", "inputs": {"width": 6, "height": 1, "depth": 6}},
        "slabPlace": {"type": "transform", "inputs": {"mesh": {"from": "slab.outMesh"}, "translate": [0, -0.5, 0]}},
        "ground": {"type": "zBone", "inputs": {"mesh": {"from": "slabPlace.outMesh"}}},
        "cube": {"type": "polyCube", "inputs": {"subdivisionsWidth": 4, "subdivisionsHeight": 4, "subdivisionsDepth": 4}},
        "place": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0, 0.51, 0]}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "place.outMesh"}, "tetSize": 0.37}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e6, "massDensity": 1000}},
        "block": {"type": "zTissue", "inputs": {
          "mesh": {"from": "place.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "solver": {"type": "zSolver", "inputs": {
          "bodies": [{"from": "ground.outBody"}, {"from": "block.outBody"}],
          "collisionDetection": true, "maxNewtonIterations": 40, "scale": 1, "stiffnessDamping": 0.01}}
      }})");
    if (two) {
        graph["nodes"]["upperPlace"] = json::parse(
            R"({"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0, 1.52, 0], "scale": [0.5, 1, 0.5]}})");
        graph["nodes"]["upper"] = json::parse(
            R"({"type": "zTissue", "inputs": {"mesh": {"from": "upperPlace.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}})");
        graph["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", "upper.outBody"}});
    }
    return graph;
}

json last_frame(const json& graph, std::vector<std::string> more = {}) {
    const TemporaryFolder folder;
    std::vector<std::string> words{"run", write_graph(folder, graph), "--report", (folder / "report.json").string()};
    words.insert(words.end(), more.begin(), more.end());
    const Said said = run_program(words);
    INFO(said.err);
    REQUIRE(said.code == 0);
    return json::parse(read_text(folder / "report.json")).at("frames").back();
}

} // namespace

TEST_CASE("a tissue rests on a bone with its weight, and a second one on it with its own", "[tools][contact]") {
    const json one = last_frame(falling(false));
    CHECK(one.at("converged") == true);
    CHECK(one.at("inverted") == 0);
    CHECK(one.at("terms").at("contact").at("force_N").get<double>() == Approx(9800).epsilon(0.002));
    CHECK(one.at("terms").at("contact").at("max_depth_m").get<double>() == Approx(9800 / 1e6).epsilon(0.1));
    // What presses is the ground's reaction to both and what the upper one presses with.
    const json two = last_frame(falling(true));
    CHECK(two.at("converged") == true);
    CHECK(two.at("terms").at("contact").at("force_N").get<double>() == Approx(9800 + 2 * 0.25 * 9800).epsilon(0.005));
}

TEST_CASE("contact is there where it is switched on alone", "[tools][contact]") {
    const json off = last_frame(falling(false), {"--frames", "1-6", "--set", "solver.collisionDetection=false"});
    CHECK_FALSE(off.at("terms").contains("contact"));
    const json none = last_frame(falling(false), {"--frames", "1-6", "--set", "block.collisions=false"});
    CHECK(none.at("terms").at("contact").at("contacts") == 0);
    const json apart = last_frame(falling(false), {"--frames", "1-6", "--set", "block.collisionSets=\"1\"", "--set",
                                                   "ground.collisionSets=\"2 3\""});
    CHECK(apart.at("terms").at("contact").at("contacts") == 0);
}
