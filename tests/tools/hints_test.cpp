// Hints through the command line: what is followed to the letter shall cure.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

using namespace sinew::test;
using nlohmann::json;

namespace {

/// A block of tets on a bone, painted; frames 1 to 3.
json tissue_on_bone() {
    return json::parse(R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 3}, "nodes": {
        "m": {"type": "polyCube", "inputs": {"width": 2, "height": 2, "depth": 2}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "m.outMesh"}, "tetSize": 1}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 30000}},
        "t": {"type": "zTissue", "inputs": {"mesh": {"from": "m.outMesh"}, "tets": {"from": "tets.outTets"},
              "materials": [{"from": "flesh.outMaterial"}]}},
        "pm": {"type": "polyCube", "inputs": {"width": 4, "height": 1, "depth": 4}},
        "top": {"type": "transform", "inputs": {"translate": [0, 1.5, 0]}},
        "bt": {"type": "zBone", "inputs": {"mesh": {"from": "pm.outMesh"}, "matrix": {"from": "top.outMatrix"}}},
        "w": {"type": "weights", "inputs": {"mesh": {"from": "m.outMesh"}, "mode": "ramp", "axis": "y", "end": 1}},
        "glue": {"type": "zAttachment", "inputs": {"source": {"from": "t.outBody"}, "target": {"from": "bt.outBody"},
                 "weights": {"from": "w.outWeights"}}},
        "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "bt.outBody"}, {"from": "t.outBody"}],
                   "attachments": [{"from": "glue.outAttachment"}]}}}})");
}

/// What `check` says first, "CODE message | hint".
std::string first_of(const Said& said) {
    for (const json& d : said.lines())
        if (d.contains("code"))
            return d.at("code").get<std::string>() + " " + d.at("message").get<std::string>() + " | " +
                   d.value("hint", "");
    return "nothing";
}

std::string said_of(const json& graph) {
    const TemporaryFolder folder;
    return first_of(run_program({"check", "--fast", "--json", write_graph(folder, graph)}));
}

/// Of the block on its bone with one input in another form.
std::string with(const std::string& node, const std::string& input, const std::string& value) {
    json graph = tissue_on_bone();
    graph["nodes"][node]["inputs"][input] = json::parse(value);
    return said_of(graph);
}

std::string hint_of(const std::string& said) { return said.substr(said.find(" | ") + 3); }

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("gravity and colours as text and with other numbers are told as three numbers", "[tools]") {
    for (const char* typed : {"\"-9.8\"", "\"-9.8 m/s^2\"", "\"9.8 m/s2\""})
        CHECK(hint_of(with("solver", "gravity", typed)) == "write three numbers: [0, -9.8, 0]");
    CHECK(hint_of(with("solver", "gravity", "\"[0,-9.8,0]\"")) == "write [0, -9.8, 0]");
    CHECK(hint_of(with("solver", "gravity", "\"off\"")) == "write [0, 0, 0]");
    CHECK(hint_of(with("top", "rotate", "\"90 deg\"")) ==
          "write three numbers: [90, 0, 0] if it is the first, [90, 90, 90] if all of them are 90");
    CHECK(hint_of(with("top", "translate", "\"5 cm\"")) == "write three numbers: [x, y, z]"); // has no unit
    CHECK(hint_of(with("bt", "colour", "\"0.5\"")) == "write three numbers: [0.5, 0.5, 0.5] if all of them are 0.5");
    CHECK(hint_of(with("bt", "colour", "[1, 0, 0, 1]")) == "write [1, 0, 0]");
    CHECK(with("bt", "colour", "[255, 128, 0]") == "DG013 255 is outside [0, 1] | write [1, 0.502, 0]");
    CHECK(hint_of(with("bt", "colour", "\"255,0,0\"")) == "write [1, 0, 0]");
}

TEST_CASE("a file's name where its content is connected is answered with the node that reads it", "[tools]") {
    const std::string mesh = R"(add "belly": { "type": "meshFile", "inputs": { "file": "belly.obj" } } to the nodes )"
                             R"(and write { "from": "belly.outMesh" })";
    CHECK(with("t", "mesh", R"("belly.obj")") == "DG026 a mesh can only be connected, found text | " + mesh);
    CHECK(with("t", "mesh", R"({"from": "belly.obj"})") == "DG022 there is no node \"belly\" | " + mesh);
    CHECK(hint_of(with("t", "mesh", R"(["belly.obj"])")) == mesh);
    CHECK(has(with("t", "tets", R"("x.msh")"), R"("type": "tetMeshFile", "inputs": { "file": "x.msh" })"));
    CHECK(has(with("t", "mesh", R"("m.obj")"), R"(add "m_file": { "type": "meshFile")")); // m is taken
    CHECK(
        has(with("glue", "weights", R"("paint.json")"),
            R"(add "paint": { "type": "weights", "inputs": { "mesh": { "from": "node.output" }, "mode": "file", )"
            R"("file": "paint.json" } } to the nodes and write { "from": "paint.outWeights" }; mesh: "m.outMesh", )"));
    // And the letter cures: the file that is not there is all that is wrong then.
    json graph = tissue_on_bone();
    graph["nodes"]["belly"] = json::parse(R"({"type": "meshFile", "inputs": {"file": "belly.obj"}})");
    graph["nodes"]["t"]["inputs"]["mesh"] = json::parse(R"({"from": "belly.outMesh"})");
    CHECK(said_of(graph).starts_with("IO401 "));
}

TEST_CASE("connections in another form are answered with the one that fits", "[tools]") {
    CHECK(hint_of(with("glue", "weights", R"("w")")) == "write { \"from\": \"w.outWeights\" }");
    CHECK(hint_of(with("bt", "matrix", R"("top")")) == "write { \"from\": \"top.outMatrix\" }");
    for (const auto& [node, input, from] : {std::tuple{"glue", "weights", "w.outWeights"},
                                            {"flesh", "weights", "w.outWeights"},
                                            {"bt", "matrix", "top.outMatrix"}}) {
        const std::string form = std::string("{ \"from\": \"") + from + "\" }";
        CHECK(with(node, input, "[" + form + "]") ==
              "DG020 takes one value, not a list of connections | write " + form);
    }
    CHECK(with("t", "material", R"({"from": "flesh.outMaterial"})") ==
          "DG024 takes text, but flesh.outMaterial is material | "
          R"(did you mean "materials": [ { "from": "flesh.outMaterial" } ]?)");
    CHECK(with("t", "collisionSets", "1") == "DG012 expected text, found an integer | write \"1\"");
    CHECK(with("t", "collisionSets", "[1, 2]") == "DG012 expected text, found a list | write \"1 2\"");
    CHECK(with("top", "trackName", "3") == "DG012 expected text, found an integer | write \"3\"");
}

TEST_CASE("what is offered for a missing connection can be meant", "[tools]") {
    const auto with_node = [](json graph, const char* node) {
        graph["nodes"]["new"] = json::parse(node);
        return hint_of(said_of(graph));
    };
    // A bone cannot be held.
    CHECK(with_node(tissue_on_bone(), R"({"type": "zHold"})") == "connect it: { \"from\": \"t.outBody\" }");
    // Whose values the solver's weights would hang on.
    json graph = tissue_on_bone();
    graph["nodes"]["glue"]["inputs"]["weights"] = json::parse(R"({"from": "new.outWeights"})");
    CHECK(with_node(graph, R"({"type": "combineWeights", "inputs": {"weights": []}})") ==
          "connect it: [ { \"from\": \"w.outWeights\" } ]");
    // Examples in a documentation are not all that fits.
    CHECK(has(with_node(tissue_on_bone(), R"({"type": "zDelaunayTetMesh"})"), "\"m.outMesh\""));
}

TEST_CASE("includes, types and numbers that cannot be are answered with what can", "[tools]") {
    json graph = tissue_on_bone();
    graph["includes"] = {{"a", "base.json"}};
    CHECK(hint_of(said_of(graph)) == R"(write "a": { "file": "base.json" })");
    graph["includes"] = {"base.json", "rigs/t.json"};
    CHECK(hint_of(said_of(graph)) == R"(write { "base": { "file": "base.json" }, "t_": { "file": "rigs/t.json" } })");
    const TemporaryFolder folder;
    std::string text = tissue_on_bone().dump();
    text.replace(text.find("30000"), 5, "1e-400");
    write_text(folder / "g.json", text);
    CHECK(first_of(run_program({"check", "--json", (folder / "g.json").string()}))
              .starts_with("DG013 1e-400 is too small for a number, so it is 0, and 0 is outside "));
    const std::string file = write_graph(folder, tissue_on_bone());
    CHECK(has(run_program({"check", file, "--set", "flesh.youngsModulus=1e-400"}).err,
              "1e-400 is too small for a number, so it is 0, and 0 is outside "));
    CHECK(has(run_program({"check", file, "--set", "timing.end=5"}).err,
              "hint: it is no node: write \"timing\": { \"end\": 5 } in the graph file, or choose the frames by "));
    // Words of the command line that are too far.
    const auto ends = [&](const std::vector<std::string>& words) {
        const Said said = run_program(words);
        CHECK(said.code == 2);
        return said.err.substr(said.err.rfind("\nsinew ") + 1);
    };
    CHECK(ends({"explain", file, "solver.outMeshes", "--frame", "99999999999"}) ==
          "sinew explain: --frame needs a whole number from -999999999 to 999999999, not '99999999999'. `sinew explain "
          "--help` says more.\n");
    CHECK(ends({"run", file, "--frames", "1-99999999999"}) ==
          "sinew run: frame 99999999999 is too far from 0; frames lie within a billion. `sinew run --help` says "
          "more.\n");
    CHECK(has(run_program({"explain", file, "solver.outMeshes", "--frame", "2", "--no-cache"}).out, "frame: 2\n"));
}

TEST_CASE("a type that is not known and that nothing reads is warned of wherever a graph is evaluated", "[tools]") {
    const TemporaryFolder folder;
    json graph = tissue_on_bone();
    graph["nodes"]["foo"] = {{"type", "zMuscle"}};
    const std::string file = write_graph(folder, graph);
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"snapshot", file, "--frames", "1", "--pull", "t.outMesh", "--size", "32x32",
                                   "--no-cache", "-o", (folder / "p.png").string()},
          {"eval", file, "m.outMesh", "--no-cache"},
          {"explain", file, "m.outMesh", "--no-cache"}}) {
        INFO(words.front());
        CHECK(has(run_program(words).err, "warning [DG010] foo: this program does not know the type \"zMuscle\"\n  "
                                          "hint: correct the type, or take the node out of the graph; `sinew nodes` "
                                          "lists the types\n"));
    }
}

TEST_CASE("check refuses a start from which no run comes to the graph's end", "[tools]") {
    const TemporaryFolder folder;
    json graph = tissue_on_bone();
    graph["nodes"]["solver"]["inputs"]["startFrame"] = -900000000;
    const std::string file = write_graph(folder, graph);
    for (const char* command : {"check", "run"}) {
        const Said said = run_program({command, file, "--no-cache"});
        CHECK(said.code == 1);
        CHECK(has(said.err,
                  "[DG104] solver.startFrame: frame -900000000 is too far before the graph's last, 3\n  hint: "
                  "leave it out to take the graph's, or start at -9999997 or later\n"));
    }
    // By --set it is gone again.
    CHECK(run_program({"check", "--fast", file, "--set", "solver.startFrame=1"}).code == 0);
}
