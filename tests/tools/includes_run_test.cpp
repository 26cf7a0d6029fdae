// Graphs that include graphs, through the command line: what runs again after an edit of an included file, --set,
// explain, and what is said of errors.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <filesystem>

using namespace sinew::test;
using nlohmann::json;

namespace {

/// small_graph() with its soft block and its plates in files of their own.
struct SplitGraph {
    TemporaryFolder folder;
    json top, part;

    SplitGraph() {
        part = small_graph();
        top = {{"format", "sinew 1"},
               {"timing", part["timing"]},
               {"includes", {{"in", {{"file", "parts/part.json"}}}}},
               {"nodes", json::object()}};
        json solver = part["nodes"]["solver"];
        part["nodes"].erase("solver");
        for (auto& [name, input] : solver["inputs"].items())
            if (input.is_array())
                for (json& entry : input)
                    if (entry.is_object() && entry.contains("from"))
                        entry["from"] = "in." + entry["from"].get<std::string>();
        top["nodes"]["solver"] = solver;
        std::filesystem::create_directories(folder / "parts");
        save();
    }
    void save() const {
        write_text(folder / "top.json", top.dump(2));
        write_text(folder / "parts/part.json", part.dump(2));
    }
    std::string path() const { return (folder / "top.json").string(); }
    /// {simulated, reused} frames of a run.
    std::pair<int, int> run(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> words{
            "run", path(), "--quiet", "--report", (folder / "r.json").string(), "--cache", (folder / "cache").string()};
        words.insert(words.end(), more.begin(), more.end());
        const Said said = run_program(words);
        INFO(said.err);
        REQUIRE(said.code == 0);
        const json totals = json::parse(read_text(folder / "r.json"))["totals"];
        return {totals["frames_simulated"], totals["frames_reused"]};
    }
};

using Frames = std::pair<int, int>;

} // namespace

TEST_CASE("an edit in an included file runs again only what changed", "[tools]") {
    SplitGraph g;
    CHECK(g.run() == Frames{6, 0});
    CHECK(g.run() == Frames{0, 6}); // in a new process
    // The same nodes in one file find the same frames: names and files are no part of what frames are known by.
    write_text(g.folder / "whole.json", small_graph().dump());
    const Said whole = run_program({"run", (g.folder / "whole.json").string(), "--quiet", "--cache",
                                    (g.folder / "cache").string(), "--report", (g.folder / "w.json").string()});
    REQUIRE(whole.code == 0);
    CHECK(json::parse(read_text(g.folder / "w.json"))["totals"]["frames_reused"] == 6);
    g.part["nodes"]["flesh"]["comment"] = "no change";
    g.part["nodes"]["unused"] = {{"type", "polyCube"}};
    g.save();
    CHECK(g.run() == Frames{0, 6});
    g.part["nodes"]["flesh"]["inputs"]["youngsModulus"] = {{"keys", {{1, 20000}, {4, 20000}, {5, 30000}}},
                                                           {"interp", "step"}};
    g.save();
    CHECK(g.run() == Frames{2, 4}); // up to frame 4 the material is what it was
    g.part["nodes"]["flesh"]["inputs"]["youngsModulus"]["keys"][2][1] = 40000;
    g.save();
    CHECK(g.run() == Frames{2, 4});
    // The same as an override, and by --set.
    g.part["nodes"]["flesh"]["inputs"]["youngsModulus"]["keys"][2][1] = 50000;
    g.top["includes"]["in"]["overrides"]["flesh.youngsModulus"] = {{"keys", {{1, 20000}, {4, 20000}, {5, 40000}}},
                                                                   {"interp", "step"}};
    g.save();
    CHECK(g.run() == Frames{0, 6});
    CHECK(g.run({"--set",
                 R"(in.flesh.youngsModulus={"keys": [[1, 20000], [4, 20000], [5, 30000]], "interp": "step"})"}) ==
          Frames{0, 6});
}

TEST_CASE("commands name included nodes by prefix and name", "[tools]") {
    const SplitGraph g;
    const Said check = run_program({"check", g.path(), "--no-cache"});
    CHECK(check.code == 0);
    CHECK(check.out.find("3 bodies") != std::string::npos);
    const Said eval = run_program({"eval", g.path(), "in.block.outBody", "--no-cache"});
    CHECK(eval.code == 0);
    const Said explain = run_program({"explain", g.path(), "solver.outMeshes", "--frame", "3", "--no-cache"});
    CHECK(explain.code == 0);
    const Said dot = run_program({"graph", g.path(), "--dot"});
    CHECK(dot.out.find("\"in.block\"") != std::string::npos);
    const Said written = run_program({"graph", g.path(), "--json", "--set", "in.flesh.poissonsRatio=0.4"});
    const json graph = json::parse(written.out);
    CHECK(graph["includes"]["in"] == json::parse(R"({"file": "parts/part.json",
                                                     "overrides": {"flesh.poissonsRatio": 0.4}})"));
    CHECK(graph["nodes"].size() == 1);
    const Said near = run_program({"eval", g.path(), "in.blok.outBody"});
    CHECK(near.code == 2);
    CHECK(near.err.find("in.block") != std::string::npos);
    const Said run = run_program({"run", g.path(), "--frames", "1-2", "--quiet", "--no-cache", "--out",
                                  (g.folder / "out").string(), "--format", "obj"});
    CHECK(run.code == 0);
    CHECK(std::filesystem::exists(g.folder / "out"));
}

TEST_CASE("errors in included files are told with both files", "[tools]") {
    SplitGraph g;
    g.part["nodes"]["flesh"]["inputs"]["poissonsRatio"] = 3;
    g.save();
    const Said said = run_program({"run", g.path(), "--quiet", "--no-cache"});
    CHECK(said.code == 1);
    CHECK(said.err.find("parts/part.json:") != std::string::npos);
    CHECK(said.err.find("included by " + g.path() + ":") != std::string::npos);
    CHECK(said.err.find("in.flesh.poissonsRatio") != std::string::npos);
}
