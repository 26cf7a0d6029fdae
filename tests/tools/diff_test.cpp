// `sinew diff`: what counts as a difference between two graphs, and what does not.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <filesystem>

using namespace sinew::test;
using nlohmann::json;

namespace {

struct Pair {
    TemporaryFolder folder;
    json a = small_graph(), b = small_graph();

    Said diff(const std::vector<std::string>& more = {}) const {
        write_text(folder / "a.json", a.dump());
        write_text(folder / "b.json", b.dump());
        std::vector<std::string> words{"diff", (folder / "a.json").string(), (folder / "b.json").string()};
        words.insert(words.end(), more.begin(), more.end());
        return run_program(words);
    }
    json& input(const std::string& node, const std::string& name) { return b["nodes"][node]["inputs"][name]; }
};

} // namespace

TEST_CASE("order, comments, spelling and defaults written out are no difference", "[tools]") {
    Pair p;
    CHECK(p.diff().code == 0);
    p.input("flesh", "youngsModulus") = "0.02 MPa";
    p.input("flesh", "poissonsRatio") = json::parse("{\"value\": 0.4, \"comment\": \"the default\"}");
    p.b["comment"] = "another";
    p.b["editor"] = {{"positions", {{"flesh", {1, 2}}}}};
    p.input("solver", "startFrame") = 1;
    p.input("solver", "attachments");
    const Said said = p.diff();
    CHECK(said.out == "");
    CHECK(said.code == 0);
    CHECK(said.err == "");
}

TEST_CASE("inputs that differ are told in SI units, nodes and wires by name", "[tools]") {
    Pair p;
    p.input("flesh", "youngsModulus") = "30 kPa";
    p.input("block", "materials") = json::array();
    p.b["nodes"].erase("top");
    p.input("holdTop", "weights") = {{"from", "bottom.outWeights"}};
    p.b["nodes"]["more"] = {{"type", "polyCube"}};
    p.input("holdBottom", "attachmentMode") = "sliding";
    p.b["timing"]["end"] = 7;
    p.input("upperMove", "rotate") = {0, 3, 0};
    p.input("block", "materials") = {{{"from", "flesh.outMaterial"}}, {{"from", "flesh.outMaterial"}}};
    const Said said = p.diff();
    CHECK(said.code == 1);
    CHECK(said.out == R"(timing.end: 6 → 7
- top (weights)
+ more (polyCube)
block.materials: [ { "from": "flesh.outMaterial" } ] → [ { "from": "flesh.outMaterial" }, { "from": "flesh.outMaterial" } ]
flesh.youngsModulus: 20000 Pa → 30000 Pa
holdBottom.attachmentMode: "fixed" → "sliding"
holdTop.weights: { "from": "top.outWeights" } → { "from": "bottom.outWeights" }
upperMove.rotate: { "keys": [[1, [0, 0, 0]], [6, [0, 20, 0]]], "interp": "linear" } deg → [0, 3, 0] deg
)");
    std::vector<json> lines = p.diff({"--json"}).lines();
    CHECK(lines.back() == json::parse(R"({"event": "compared", "same": false, "differences": 8})"));
    CHECK(lines[4] == json::parse(R"({"event": "difference", "kind": "input", "node": "flesh", "attribute":
                                      "youngsModulus", "before": 20000, "after": 30000, "unit": "Pa"})"));
    CHECK(lines[1] == json::parse(R"({"event": "difference", "kind": "removed", "node": "top", "before": "weights",
                                      "after": null})"));
}

TEST_CASE("a node that says the same under another name is renamed, and so are wires to it", "[tools]") {
    Pair p;
    std::string text = p.b.dump();
    const auto rename = [&](const std::string& from, const std::string& to) {
        for (const auto& [old, now] :
             {std::pair("\"" + from + "\":", "\"" + to + "\":"), std::pair("\"" + from + ".", "\"" + to + ".")})
            for (std::size_t at = 0; (at = text.find(old, at)) != std::string::npos; at += now.size())
                text.replace(at, old.size(), now);
    };
    rename("blockMesh", "boxMesh");
    rename("block", "box"); // reads the first, and is read by attachments and solver
    p.b = json::parse(text);
    const Said said = p.diff();
    CHECK(said.out == "block is called box\nblockMesh is called boxMesh\n");
    CHECK(said.code == 1);
    p.input("box", "material") = "NeoHookean"; // says something else: another node
    CHECK(p.diff().out.find("- block (zTissue)\n+ box (zTissue)\nblockMesh is called boxMesh\n") == 0);
}

TEST_CASE("what is included is compared, however it is included", "[tools]") {
    Pair p;
    std::filesystem::create_directories(p.folder / "sub");
    const json part = {{"format", "sinew 1"},
                       {"nodes", {{"m", {{"type", "zMaterial"}, {"inputs", {{"youngsModulus", 5000}}}}}}}};
    write_text(p.folder / "part.json", part.dump());
    write_text(p.folder / "sub/copy.json", part.dump(4));
    p.a["includes"]["x"]["file"] = "part.json";
    p.b["includes"]["x"]["file"] = "sub/copy.json";
    CHECK(p.diff().code == 0);
    p.b["includes"]["x"]["overrides"]["m.youngsModulus"] = "5 kPa";
    CHECK(p.diff().code == 0);
    p.b["includes"]["x"]["overrides"]["m.youngsModulus"] = "6 kPa";
    CHECK(p.diff().out == "x.m.youngsModulus: 5000 Pa → 6000 Pa\n");
    p.b["includes"] = {{"y", {{"file", "part.json"}}}};
    CHECK(p.diff().out == "the include x is called y\n");
    json two = part;
    two["nodes"]["n"] = {{"type", "polyCube"}};
    write_text(p.folder / "part.json", two.dump());
    CHECK(p.diff().out == "the include x is called y\n");
    CHECK(p.diff({"--json"}).lines().front() == json::parse(R"({"event": "difference", "kind": "prefix", "node": "y",
                                                               "before": "x", "after": "y"})"));
    p.b["includes"]["y"]["overrides"]["m.youngsModulus"] = "6 kPa"; // another node, for all that can be told
    CHECK(p.diff().out == "- x.m (zMaterial)\n+ y.m (zMaterial)\nx.n is called y.n\n");
}

TEST_CASE("a graph under a prefix is the same graph with other names, lists and names of bodies too", "[tools]") {
    const TemporaryFolder folder;
    const std::string scene = std::string(SINEW_SOURCE_DIR) + "/graphs/scenes/layers.json"; // picks bodies by name
    const json whole = {{"format", "sinew 1"},
                        {"timing", {{"start", 1}, {"end", 48}}},
                        {"includes", {{"all", {{"file", scene}}}}},
                        {"nodes", json::object()}};
    write_text(folder / "t.json", whole.dump());
    const Said said = run_program({"diff", (folder / "t.json").string(), scene, "--json"});
    CHECK(said.code == 1);
    std::size_t renamed = 0;
    for (const json& line : said.lines()) {
        if (line["event"] != "difference" || line["kind"] == "timing") continue;
        ++renamed;
        CHECK(line["kind"] == "renamed");
        CHECK(line["before"] == "all." + line["after"].get<std::string>());
    }
    CHECK(renamed == 52);
}

TEST_CASE("files are compared by what is in them", "[tools]") {
    Pair p;
    const auto mesh = [](const std::string& file) { return json{{"type", "meshFile"}, {"inputs", {{"file", file}}}}; };
    write_text(p.folder / "1.obj", "v 0 0 0\n");
    write_text(p.folder / "2.obj", "v 0 0 0\n");
    write_text(p.folder / "3.obj", "v 0 0 1\n");
    p.a["nodes"]["f"] = mesh("1.obj");
    p.b["nodes"]["f"] = mesh("2.obj");
    CHECK(p.diff().code == 0);
    p.b["nodes"]["f"] = mesh("3.obj");
    const Said said = p.diff();
    CHECK(said.code == 1);
    CHECK(said.out.find("f.file: ") == 0);
}

TEST_CASE("diff tells graphs that are wrong from graphs that differ", "[tools]") {
    Pair p;
    p.input("flesh", "poissonsRatio") = 7;
    const Said said = p.diff();
    CHECK(said.code == 2);
    CHECK(said.err.find("DG013") != std::string::npos);
    CHECK(said.out == "");
    CHECK(run_program({"diff", (p.folder / "a.json").string(), (p.folder / "none.json").string()}).code == 2);
    CHECK(run_program({"diff", (p.folder / "a.json").string()}).code == 2);
}

TEST_CASE("a list that is not set differs as the empty one that it stands for", "[tools]") {
    Pair p;
    p.input("top", "values") = {1, 0};
    CHECK(p.diff().out == "top.values: [] → [1, 0]\n");
    const json listed = p.diff({"--json"}).lines().front();
    CHECK(listed["before"] == json::array());
    CHECK(listed["after"] == json({1, 0}));
    p.input("top", "values") = {{"from", "bottom.outWeights"}};
    CHECK(p.diff({"--json"}).lines().front()["before"] == json::array());
    std::swap(p.a, p.b);
    CHECK(p.diff({"--json"}).lines().front()["after"] == json::array());
}
