// zTissue.collisionShape on the command line: what is written, what is said.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

#include <set>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

/// The block, 4 wide, in a box as collision shape.
json graph_with_shape(double width) {
    json graph = small_graph();
    graph["nodes"]["shape"] = {
        {"type", "polyCube"},
        {"inputs", {{"width", width}, {"height", 8.2}, {"depth", 4.2}, {"subdivisionsHeight", 4}}}};
    graph["nodes"]["block"]["inputs"]["collisionShape"] = {{"from", "shape.outMesh"}};
    return graph;
}

} // namespace

TEST_CASE("the collision surface is written under its body's name when asked for, and not otherwise", "[tools]") {
    const TemporaryFolder folder;
    json graph = graph_with_shape(4.2);
    graph["nodes"]["skin"] = {{"type", "zEmbedder"},
                              {"inputs",
                               {{"solved", {{"from", "solver.outSolved"}}},
                                {"body", {{"from", "block.outBody"}}},
                                {"meshes", {{{"from", "blockMesh.outMesh"}}}}}}};
    const std::string path = write_graph(folder, graph);
    const auto written = [&](std::vector<std::string> pulls) {
        const fs::path out = folder / ("out" + std::to_string(pulls.size()));
        std::vector<std::string> words{"run", path, "--frames", "1-2", "--format", "obj", "--out", out.string()};
        words.insert(words.end(), pulls.begin(), pulls.end());
        CHECK(run_program(words).code == 0);
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(out / "obj")) {
            const std::string name = entry.path().filename().string();
            names.insert(name.substr(0, name.find('.')));
        }
        return names;
    };
    using Names = std::set<std::string>;
    CHECK(written({}) == Names{"block", "lower", "upper"});
    CHECK(written({"--pull", "skin.outMeshes", "--pull", "skin.outCollisionMeshes"}) ==
          Names{"blockMesh", "block_collision"});
}

TEST_CASE("what is wrong with a collision surface is said once a run, not once a frame", "[tools]") {
    const TemporaryFolder folder;
    json graph = graph_with_shape(4.2);
    // Vertices far out beside others that are not, and a tissue that is evaluated anew at every frame.
    graph["nodes"]["place"] = {{"type", "transform"},
                               {"inputs", {{"mesh", {{"from", "shape.outMesh"}}}, {"translate", {0, 5, 0}}}}};
    graph["nodes"]["block"]["inputs"]["collisionShape"] = {{"from", "place.outMesh"}};
    graph["nodes"]["flesh"]["inputs"]["youngsModulus"] = {{"keys", {{1, 20000}, {6, 30000}}}};
    const Said said = run_program({"run", write_graph(folder, graph), "--frames", "1-4", "--json"});
    CHECK(said.code == 0);
    int told = 0;
    for (const json& line : said.lines()) told += line.at("event") == "diagnostic" && line.at("code") == "FE239";
    CHECK(told == 1);
}
