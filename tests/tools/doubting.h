// What check says of a small graph with something wrong in it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace sinew::test {

/// A ball of 20 cm that hangs on a plate by its painted top; nothing about it is doubtful.
inline nlohmann::json ball() {
    return nlohmann::json::parse(R"({"format": "sinew 1", "nodes": {
      "ballMesh": {"type": "polySphere", "inputs": {"radius": 10, "subdivisionsAxis": 12, "subdivisionsHeight": 12}},
      "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 20000}},
      "tets": {"type": "zTet", "inputs": {"mesh": {"from": "ballMesh.outMesh"}, "tetSize": 8}},
      "ball": {"type": "zTissue", "inputs": {"mesh": {"from": "ballMesh.outMesh"},
        "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
      "plateMesh": {"type": "polyCube", "inputs": {"width": 10, "height": 1, "depth": 10}},
      "platePlace": {"type": "transform", "inputs": {"translate": [0, 10, 0]}},
      "plate": {"type": "zBone", "inputs": {"mesh": {"from": "plateMesh.outMesh"},
        "matrix": {"from": "platePlace.outMatrix"}}},
      "top": {"type": "weights", "inputs": {"mesh": {"from": "ballMesh.outMesh"}, "mode": "ramp", "axis": "y",
        "start": 8, "end": 9}},
      "grip": {"type": "zAttachment", "inputs": {"source": {"from": "ball.outBody"},
        "target": {"from": "plate.outBody"}, "weights": {"from": "top.outWeights"}}},
      "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "plate.outBody"}, {"from": "ball.outBody"}],
        "attachments": [{"from": "grip.outAttachment"}], "scale": 100}}}})");
}

/// What `check` says of the graph with these --set, "CODE node.attribute: message | hint" a line.
inline std::string all_said_of(const nlohmann::json& graph, const std::vector<std::string>& settings = {},
                               int code = 0) {
    const TemporaryFolder folder;
    std::vector<std::string> words{"check", write_graph(folder, graph), "--json", "--no-cache"};
    for (const std::string& s : settings) words.insert(words.end(), {"--set", s});
    const Said said = run_program(words);
    CHECK(said.code == code);
    std::string out;
    for (const nlohmann::json& d : said.lines())
        if (d.at("event") == "diagnostic")
            out += d.at("code").get<std::string>() + " " + d.value("node", "") + "." + d.value("attribute", "") + ": " +
                   d.at("message").get<std::string>() + " | " + d.value("hint", "") + "\n";
    return out;
}

/// The same but for nodes that nothing reads: most tests take a connection away or put another in its place, and what
/// is left without readers is a test of its own.
inline std::string said_of(const nlohmann::json& graph, const std::vector<std::string>& settings = {}, int code = 0) {
    std::istringstream all(all_said_of(graph, settings, code));
    std::string out;
    for (std::string line; std::getline(all, line);)
        if (!line.starts_with("FE330")) out += line + "\n";
    return out;
}

} // namespace sinew::test
