// What check doubts: each mistake made once, and the cure that it names.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <filesystem>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

/// A ball of 20 cm that hangs on a plate by its painted top; nothing about it is doubtful.
json ball() {
    return json::parse(R"({"format": "sinew 1", "nodes": {
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
std::string said_of(const json& graph, const std::vector<std::string>& settings = {}, int code = 0) {
    const TemporaryFolder folder;
    std::vector<std::string> words{"check", write_graph(folder, graph), "--json", "--no-cache"};
    for (const std::string& s : settings) words.insert(words.end(), {"--set", s});
    const Said said = run_program(words);
    CHECK(said.code == code);
    std::string out;
    for (const json& d : said.lines())
        if (d.at("event") == "diagnostic")
            out += d.at("code").get<std::string>() + " " + d.value("node", "") + "." + d.value("attribute", "") + ": " +
                   d.at("message").get<std::string>() + " | " + d.value("hint", "") + "\n";
    return out;
}

} // namespace

TEST_CASE("check doubts nothing of a sound graph", "[tools]") { CHECK(said_of(ball()).empty()); }

TEST_CASE("check doubts nothing of the graphs that ship", "[tools]") {
    for (const char* folder : {"graphs/learn", "graphs/demos", "graphs/scenes", "graphs/bench"})
        for (const auto& entry : fs::directory_iterator(fs::path(SINEW_SOURCE_DIR) / folder)) {
            if (entry.path().extension() != ".json") continue;
            INFO(entry.path());
            const Said said = run_program({"check", entry.path().string(), "--json", "--no-cache"});
            CHECK(said.code == 0);
            CHECK(said.out.find("\"code\":\"FE26") == std::string::npos);
        }
}

TEST_CASE("check doubts sizes that no flesh has and names the scale that would give it one", "[tools]") {
    CHECK(said_of(ball(), {"solver.scale=1"}) ==
          "FE261 solver.scale: ball is 20 m long: 20 scene units, 1 a metre | if it is modelled in centimetres, write "
          "\"scale\": 100, which makes it 20 cm\n");
    CHECK(said_of(ball(), {"solver.scale=5000"}) ==
          "FE261 solver.scale: ball is 4 mm long: 20 scene units, 5000 a metre | if it is modelled in centimetres, "
          "write \"scale\": 100, which makes it 20 cm\n");
}

TEST_CASE("check doubts flesh of pascals", "[tools]") {
    CHECK(said_of(ball(), {"flesh.youngsModulus=12"}) ==
          "FE263 flesh.youngsModulus: 12 Pa is softer than any flesh; brain has 500 Pa, a muscle 12 kPa | if "
          "kilopascals are meant, write \"12 kPa\"\n");
    CHECK(said_of(ball(), {"flesh.youngsModulus=gelatin"}).empty()); // asked for by name
}

TEST_CASE("check doubts attachments of whole bodies and names what to paint", "[tools]") {
    json graph = ball();
    graph["nodes"]["grip"]["inputs"].erase("weights");
    CHECK(said_of(graph) == "FE264 grip.weights: ties the whole surface of ball | paint where it holds on: a node "
                            "weights with the mesh of ball, for example with mode near\n");
    // Half as stiff is still everywhere; the least place without is a part.
    CHECK(said_of(graph, {"grip.weights=[0.5]"}).starts_with("FE264 grip.weights: ties the whole surface of ball"));
    // A bone within flesh is held all around.
    graph["nodes"]["grip"]["inputs"]["source"] = {{"from", "plate.outBody"}};
    graph["nodes"]["grip"]["inputs"]["target"] = {{"from", "ball.outBody"}};
    CHECK(said_of(graph, {"grip.maxDistance=100"}).find("FE264") == std::string::npos);
}

TEST_CASE("check doubts tissues that fall", "[tools]") {
    json graph = ball();
    graph["nodes"]["solver"]["inputs"].erase("attachments");
    const std::string falls = "FE260 solver.bodies: ball falls: no chain of attachments ties it to a bone, and nothing "
                              "holds it | attach it to a bone, hold a part of it by zHold, or switch gravity off: "
                              "[0, 0, 0]\n";
    CHECK(said_of(graph) == falls);
    CHECK(said_of(graph, {"solver.gravity=[0, 0, 0]"}).empty());
    CHECK(said_of(graph, {"solver.integrator=QuasiStatic"}, 1).starts_with("FE303 solver.bodies"));
    graph["nodes"]["hold"] = {
        {"type", "zHold"},
        {"inputs", {{"tissue", {{"from", "ball.outBody"}}}, {"weights", {{"from", "top.outWeights"}}}}}};
    graph["nodes"]["solver"]["inputs"]["forces"] = json::array({{{"from", "hold.outForce"}}});
    CHECK(said_of(graph).empty());
    // Tied to what is tied is held, to what falls is not.
    json pair = ball();
    pair["nodes"]["second"] = pair["nodes"]["ball"];
    pair["nodes"]["secondFlesh"] = {{"type", "zMaterial"}, {"inputs", {{"youngsModulus", 30000}}}};
    pair["nodes"]["second"]["inputs"]["materials"][0]["from"] = "secondFlesh.outMaterial";
    pair["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", "second.outBody"}});
    CHECK(said_of(pair).starts_with("FE260 solver.bodies: second falls"));
    pair["nodes"]["glue"] = pair["nodes"]["grip"];
    pair["nodes"]["glue"]["inputs"]["source"]["from"] = "second.outBody";
    pair["nodes"]["glue"]["inputs"]["target"]["from"] = "ball.outBody";
    pair["nodes"]["solver"]["inputs"]["attachments"].push_back({{"from", "glue.outAttachment"}});
    CHECK(said_of(pair).empty());
    // The other way round it ties as well.
    pair["nodes"]["glue"]["inputs"]["source"]["from"] = "ball.outBody";
    pair["nodes"]["glue"]["inputs"]["target"]["from"] = "second.outBody";
    CHECK(said_of(pair).empty());
}

TEST_CASE("check doubts tets far larger than what they fill is thick", "[tools]") {
    json graph = ball();
    graph["nodes"]["ballMesh"] = {{"type", "polyCube"}, // a plate of 2 cm
                                  {"inputs", {{"width", 40}, {"height", 20}, {"depth", 2}, {"subdivisionsHeight", 4}}}};
    const std::string said = said_of(graph, {"tets.tetSize=10"});
    CHECK(said.starts_with("FE262 tets.tetSize: "));
    CHECK(
        said.find("of the surface of ball belongs to parts about 2 thick, less than a quarter of the tets there (10) | "
                  "choose a tetSize of about 2,") != std::string::npos);
    CHECK(said_of(graph, {"tets.tetSize=2"}).empty());
}

TEST_CASE("check doubts scales that mirror", "[tools]") {
    CHECK(said_of(ball(), {"platePlace.scale=[-1, 1, 1]"}) ==
          "FE265 platePlace.scale: the scale mirrors, which turns what is moved inside out: its faces look inwards | "
          "mirror the mesh where it is modelled and turn its faces, or scale by positive numbers and rotate\n");
    CHECK(said_of(ball(), {"platePlace.scale=[-1, -1, 1]"}).empty()); // half a turn
}

TEST_CASE("check names the bone that is attached to but none of the bodies", "[tools]") {
    json graph = ball();
    graph["nodes"]["solver"]["inputs"]["bodies"].erase(0);
    const std::string said = said_of(graph, {}, 1);
    CHECK(said.starts_with("FE209 solver.attachments: the target of grip"));
    CHECK(said.find("zSolver.bodies") != std::string::npos);
}

TEST_CASE("a node of an unknown type is an error of check beside all others", "[tools]") {
    json graph = ball();
    graph["nodes"]["odd"] = {{"type", "zTisue"}};
    CHECK(said_of(graph, {}, 1) == "DG010 odd.: this program does not know the type \"zTisue\" | did you mean "
                                   "\"zTissue\"?\n");
    graph["nodes"]["flesh"]["inputs"]["youngsModulus"] = -1;
    const std::string both = said_of(graph, {}, 1);
    CHECK(both.find("DG010 odd.") != std::string::npos);
    CHECK(both.find("DG013 flesh.youngsModulus") != std::string::npos);
}
