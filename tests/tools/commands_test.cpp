// The other commands from the outside.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"
#include "tools/cli/commands.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace sinew::test;
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Width and height from the header of a PNG.
std::pair<int, int> png_size(const std::string& bytes) {
    REQUIRE(bytes.size() > 100);
    REQUIRE(bytes.substr(1, 3) == "PNG");
    const auto number = [&bytes](std::size_t at) {
        int out = 0;
        for (std::size_t i = 0; i < 4; ++i) out = out << 8 | static_cast<unsigned char>(bytes[at + i]);
        return out;
    };
    return {number(16), number(20)};
}

} // namespace

TEST_CASE("usage errors exit with 2 and say what was meant", "[tools]") {
    CHECK(run_program({}).code == 2);
    const Said command = run_program({"rum"});
    CHECK(command.code == 2);
    CHECK(has(command.err, "Did you mean 'run'?"));
    const Said flag = run_program({"run", "g.json", "--frmes", "1"});
    CHECK(flag.code == 2);
    CHECK(has(flag.err, "Did you mean '--frames'?"));
    CHECK(has(flag.err, "Usage: sinew run GRAPH"));
    CHECK(run_program({"run"}).code == 2);
    CHECK(run_program({"nodes", "zTisue"}).code == 2);
    CHECK(run_program({"bench", "nothing"}).code == 2);
    CHECK(run_program({"bench", "cantilever", "file.obj"}).code == 2);
    CHECK(run_program({"bench", "meshing"}).code == 2);
    CHECK(run_program({"bench", "meshing", "file.obj", "--parts", "0"}).code == 2);
}

TEST_CASE("help and version go to the output, with exit code 0", "[tools]") {
    CHECK(has(run_program({"--help"}).out, "snapshot"));
    CHECK(run_program({"--version"}).out.starts_with("sinew "));
    for (const sinew::cli::Command& c : sinew::cli::all_commands()) {
        const std::string command(c.name);
        INFO(command);
        const Said said = run_program({command, "--help"});
        CHECK(said.code == 0);
        CHECK(has(said.out, "Example:\n  sinew " + command));
        CHECK(said.err.empty());
    }
}

TEST_CASE("check sums up a right graph", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    const Said said = run_program({"check", graph});
    CHECK(said.code == 0);
    CHECK(has(said.out, "13 nodes, 3 bodies, "));
    CHECK(said.beside_work().empty());
    CHECK(run_program({"check", graph, "--json"}).lines().back().at("bodies") == 3);
    CHECK(has(run_program({"check", graph, "--fast"}).out, "13 nodes\n"));
}

TEST_CASE("check names every problem at once, in the order of the file, each once", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["top"]["inputs"] =
        json::parse(R"({ "mode": "list", "mesh": { "from": "blockMesh.outMesh" }, "values": [1, 2] })");
    graph["nodes"]["block"]["inputs"].erase("materials");
    const Said said = run_program({"check", write_graph(folder, graph), "--json"});
    CHECK(said.code == 1);
    std::vector<std::string> found;
    int line = 0;
    for (const json& d : said.lines()) {
        CHECK(d.at("event") == "diagnostic");
        CHECK(d.at("line") >= line);
        line = d.at("line");
        found.push_back(d.at("node").get<std::string>() + " " + d.at("code").get<std::string>());
    }
    CHECK(std::count(found.begin(), found.end(), "block FE206") == 1);
    CHECK(std::count(found.begin(), found.end(), "top FE204") == 1);
    CHECK(found.size() == 2);
}

TEST_CASE("a missing graph file is one clear error", "[tools]") {
    const Said said = run_program({"check", "/nowhere/graph.json"});
    CHECK(said.code == 1);
    CHECK(has(said.err, "IO401"));
    CHECK(has(said.err, "/nowhere/graph.json"));
}

TEST_CASE("eval prints meshes by size, box and digest, and numbers as they are", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    const Said mesh = run_program({"eval", graph, "plateMesh.outMesh"});
    CHECK(mesh.code == 0);
    CHECK(has(mesh.out, "vertices: 8"));
    CHECK(has(mesh.out, "min: -3.0 -0.5 -3.0"));
    CHECK(has(mesh.out, "digest: "));
    const json moved = run_program({"eval", graph, "upperMove.outMatrix", "--frame", "6", "--json"}).lines().front();
    CHECK(moved.at("type") == "matrix");
    CHECK(moved.at("value").at(0).at(3) == 0.5);
    const json bodies = run_program({"eval", graph, "solver.outMeshes", "--frame", "2", "--json"}).lines().front();
    CHECK(bodies.at("value").at("block").at("faces") == 40);
    const Said unknown = run_program({"eval", graph, "plateMesh.outMsh"});
    CHECK(unknown.code == 2);
    CHECK(has(unknown.err, "Did you mean 'outMesh'?"));
    CHECK(has(run_program({"eval", graph, "plateMsh.outMesh"}).err, "Did you mean 'plateMesh'?"));
}

TEST_CASE("eval prints volumes of what is solid, and lengths of curves", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["tets"] =
        json::parse(R"({"type": "zTet", "inputs": {"mesh": {"from": "blockMesh.outMesh"}, "tetSize": 1.7}})");
    graph["nodes"]["line"] =
        json::parse(R"({"type": "curve", "inputs": {"points": [0, 0, 0, 3, 0, 0, 3, 4, 0, 3, 4, 0.5]}})");
    const std::string file = write_graph(folder, graph);
    const json tets = run_program({"eval", file, "tets.outTets", "--json"}).lines().front().at("value");
    CHECK(tets.at("solid_volume").get<double>() == Approx(4 * 8 * 4).epsilon(1e-6)); // tets reach beyond the block
    const json box = tets.at("box");
    double around = 1;
    for (std::size_t c = 0; c < 3; ++c) around *= box.at("max").at(c).get<double>() - box.at("min").at(c).get<double>();
    CHECK(around > 1.2 * 128);
    const json line = run_program({"eval", file, "line.outCurve", "--json"}).lines().front().at("value");
    CHECK(line.at("points") == 4);
    CHECK(line.at("length").get<double>() == Approx(7.5).epsilon(1e-15));
}

TEST_CASE("eval prints all that a material says, of flesh and of cloth", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["flesh"]["inputs"].update(json::parse(
        R"({"volumeConservation": 1e5, "pressure": 3, "surfaceTension": 4, "tensileStiffness": 500, "clothMassDensity": 0.4})"));
    const std::string file = write_graph(folder, graph);
    const json said = run_program({"eval", file, "flesh.outMaterial", "--json"}).lines().front().at("value");
    CHECK((said.at("volumeConservation") == 1e5 && said.at("pressure") == 3 && said.at("surfaceTension") == 4));
    CHECK((said.at("cloth").at("tensileStiffness") == 500 && said.at("cloth").at("clothMassDensity") == 0.4));
    const json body = run_program({"eval", file, "block.outBody", "--json"}).lines().front().at("value");
    CHECK(body.at("materials").at(0).at("volumeConservation") == 1e5);
}

TEST_CASE("bodies of one name in two outputs that are pulled are all written", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["second"] = graph["nodes"]["solver"];
    graph["nodes"]["second"]["inputs"]["gravity"] = {0, 0, 0};
    graph["nodes"]["second_lower"] = graph["nodes"]["lower"]; // as the other one might be called
    graph["nodes"]["second"]["inputs"]["bodies"].push_back({{"from", "second_lower.outBody"}});
    const std::string file = write_graph(folder, graph);
    const auto alone = [&](const std::string& solver) {
        const std::string out = (folder / solver).string();
        CHECK(run_program({"run", file, "--quiet", "--frames", "2,6", "--pull", solver + ".outMeshes", "--format",
                           "obj", "--out", out})
                  .code == 0);
        return read_text(folder / solver / "obj/block.0006.obj");
    };
    const auto places = [](const std::string& obj) { return obj.substr(obj.find("\nv ")); };
    const std::string first = places(alone("solver")), other = places(alone("second"));
    REQUIRE(first != other);
    for (const char* format : {"obj", "glb"}) {
        CHECK(run_program({"run", file, "--quiet", "--frames", "2,6", "--pull", "solver.outMeshes", "--pull",
                           "second.outMeshes", "--format", format, "--out", (folder / "both").string()})
                  .code == 0);
    }
    CHECK(places(read_text(folder / "both/obj/block.0006.obj")) == first);
    CHECK(places(read_text(folder / "both/obj/second_block.0006.obj")) == other);
    std::string glb = read_text(folder / "both/small.glb");
    for (const char* name : {"\"block\"", "\"second_block\"", "\"lower\"", "\"second_lower\"", "\"second_lower_2\""})
        CHECK(glb.find(name) != std::string::npos);
}

TEST_CASE("every kind of output of a scene can be printed", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    for (const char* plug : {"block.outBody", "lower.outBody", "flesh.outMaterial", "holdTop.outAttachment",
                             "top.outWeights", "solver.outReport", "solver.outSolved"}) {
        INFO(plug);
        const Said said = run_program({"eval", graph, plug, "--json"});
        CHECK(said.code == 0);
        CHECK_FALSE(said.lines().front().at("value").empty());
    }
}

TEST_CASE("a force is printed with the bodies that it acts on and its values by name", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["wind"] = json::parse(R"({ "type": "uniformField", "inputs": {
        "magnitude": 7, "direction": [0, 0, 2], "bodies": [ { "from": "block.outBody" } ] } })");
    graph["nodes"]["everywhere"] = json::parse(R"({ "type": "dragField" })");
    const std::string file = write_graph(folder, graph);
    const json wind = run_program({"eval", file, "wind.outForce", "--json"}).lines().front().at("value");
    CHECK(wind.at("term") == "field");
    CHECK(wind.at("bodies") == 1);
    CHECK(wind.at("magnitude") == 7);
    CHECK(wind.at("direction z") == 2);
    const Said all = run_program({"eval", file, "everywhere.outForce"});
    CHECK(has(all.out, "bodies: all tissues of the solver"));
}

TEST_CASE("check looks at each node of a long chain once, and still finds all that is wrong", "[tools]") {
    const TemporaryFolder folder;
    // Node by node from its begin, with all that each needs, this would be 200 million look-ups.
    json graph = {{"format", "sinew 1"}, {"nodes", {{"mesh", {{"type", "polyCube"}}}}}};
    std::string last;
    for (int i = 0; i < 20000; ++i) {
        json inputs = {{"translate", {0, 0.001, 0}}};
        if (!last.empty()) inputs["offsetParentMatrix"] = {{"from", last + ".outMatrix"}};
        last = "t" + std::to_string(i);
        graph["nodes"][last] = {{"type", "transform"}, {"inputs", inputs}};
    }
    graph["nodes"]["bone"] = {
        {"type", "zBone"},
        {"inputs", {{"mesh", {{"from", "mesh.outMesh"}}}, {"matrix", {{"from", last + ".outMatrix"}}}}}};
    const Said right = run_program({"check", write_graph(folder, graph)});
    CHECK(right.code == 0);
    CHECK(right.out.find("right, 20002 nodes") != std::string::npos);

    // Wrong at an end, wrong upstream of an end, and wrong where nothing is connected.
    json three = small_graph();
    three["nodes"]["top"]["inputs"]["mode"] = "file";
    three["nodes"]["ring"] = {{"type", "polyHelix"}, {"inputs", {{"radius", 5}}}};
    three["nodes"]["ringBone"] = {{"type", "zBone"}, {"inputs", {{"mesh", {{"from", "ring.outMesh"}}}}}};
    three["nodes"]["alone"] = {{"type", "polyHelix"}, {"inputs", {{"coils", 1e8}}}};
    const Said wrong = run_program({"check", write_graph(folder, three)});
    CHECK(wrong.code == 1);
    for (const char* place : {"top.", "ring.radius", "alone.coils"}) {
        INFO(wrong.err);
        CHECK(wrong.err.find(place) != std::string::npos);
    }
}

TEST_CASE("explain computes nothing and says why it would", "[tools]") {
    const TemporaryFolder folder;
    const Said said =
        run_program({"explain", write_graph(folder, small_graph()), "solver.outMeshes", "--frame", "4", "--json"});
    CHECK(said.code == 0);
    const json verdict = said.lines().front();
    CHECK(verdict.at("readiness") != "ready");
    CHECK_FALSE(verdict.at("because").get<std::string>().empty());
    CHECK(verdict.at("valid_frames").empty());
    // A new process has no frame, so it is certain what would run and where it begins.
    CHECK(verdict.at("readiness") == "would run");
    CHECK(verdict.at("steps") == json({{"first_frame", 1.0}, {"last_frame", 4.0}}));
    CHECK(verdict.at("first_plug") == "plateMesh.outMesh");
    const std::string because = verdict.at("because");
    CHECK(because.find("frames 1 to 4 would be simulated") != std::string::npos);
    CHECK(because.find("first plateMesh.outMesh (polyCube) must be evaluated") != std::string::npos);
}

TEST_CASE("explain names the plug that differs from what is kept on disk", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["tets"] = json::parse(R"({ "type": "zTet", "inputs": {
        "mesh": { "from": "blockMesh.outMesh" }, "tetSize": 2, "cacheTetMesh": true } })");
    graph["nodes"]["block"]["inputs"]["tets"] = {{"from", "tets.outTets"}};
    const std::string file = write_graph(folder, graph);
    const auto explain = [&](std::vector<std::string> more) {
        std::vector<std::string> words{"explain", file, "tets.outTets", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const Said said = run_program(words);
        CHECK(said.code == 0);
        return said.lines().front();
    };
    const json before = explain({});
    CHECK(before.at("readiness") == "would run");
    CHECK(before.at("first_plug") == "blockMesh.outMesh");
    REQUIRE(run_program({"eval", file, "tets.outTets"}).code == 0);
    const json kept = explain({});
    CHECK(kept.at("readiness") == "ready");
    CHECK(kept.at("because") == "the value is kept on disk");
    CHECK(explain({"--no-cache"}).at("readiness") == "would run");
    CHECK(explain({"--set", "tets.tetSize=2"}).at("readiness") == "ready");
    const json differs = explain({"--set", "tets.tetSize=1.5", "--set", "blockMesh.width=5"});
    CHECK(differs.at("readiness") == "would run");
    CHECK(differs.at("changed_plugs") == json({"blockMesh.width", "tets.tetSize"}));
    // What stands downstream of it is told the same reason.
    const Said later = run_program({"explain", file, "block.outBody", "--json", "--set", "tets.tetSize=1.5"});
    const json block = later.lines().front();
    CHECK(block.at("because").get<std::string>().find("must be evaluated") != std::string::npos);
    CHECK(block.at("changed_plugs") == json({"tets.tetSize"}));
}

TEST_CASE("nodes lists and explains every type, for people and for programs", "[tools]") {
    CHECK(has(run_program({"nodes"}).out, "zSolver"));
    CHECK(has(run_program({"nodes", "zTissue"}).out, "compressionResistance"));
    const json all = json::parse(run_program({"nodes", "--json"}).out);
    CHECK(all.size() > 10);
    for (const json& type : all) {
        INFO(type.at("name"));
        CHECK(type.at("outputs").size() > 0);
        CHECK(run_program({"nodes", type.at("name")}).code == 0);
    }
    CHECK(json::parse(run_program({"nodes", "--schema"}).out).contains("$schema"));
}

TEST_CASE("a graph can be drawn, and written again as the same graph", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    const Said dot = run_program({"graph", graph, "--dot"});
    CHECK(dot.out.starts_with("digraph"));
    CHECK(has(dot.out, "\"block\" -> \"solver\""));
    const Said written = run_program({"graph", graph, "--json"});
    REQUIRE(written.code == 0);
    write_text(folder / "again.json", written.out);
    const auto value = [](const std::string& file) {
        return run_program({"eval", file, "solver.outMeshes", "--frame", "3", "--json"}).lines().front();
    };
    CHECK(value((folder / "again.json").string()) == value(graph));
    CHECK(run_program({"graph", graph}).code == 2);
}

TEST_CASE("a snapshot is made from a folder of OBJ files or from a graph", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph()), out = (folder / "out").string(),
                      png = (folder / "p.png").string();
    REQUIRE(run_program({"run", graph, "--out", out, "--format", "obj"}).code == 0);
    REQUIRE(run_program({"snapshot", out, "--frames", "1,6", "--size", "320x160", "-o", png}).code == 0);
    CHECK(png_size(read_text(png)) == std::pair(320, 160));
    const std::string other = (folder / "q.png").string();
    REQUIRE(run_program({"snapshot", graph, "--frames", "1,6", "--size", "320x160", "-o", other}).code == 0);
    CHECK(png_size(read_text(other)) == std::pair(320, 160));
    CHECK(read_text(png).size() > 4000); // a blank picture of this size has a tenth of that

    const Said missing = run_program({"snapshot", out, "--frames", "7", "-o", png});
    CHECK(missing.code == 2);
    CHECK(has(missing.err, "it has 1 to 6"));
    CHECK(run_program({"snapshot", folder.path().string(), "-o", png}).code == 2);
    CHECK(run_program({"snapshot", out, "--view", "behind", "-o", png}).code == 2);
    CHECK(run_program({"snapshot", out, "--size", "12", "-o", png}).code == 2);
}

TEST_CASE("the cantilever prints one JSON line a run, or a table with the same digests", "[tools]") {
    const Said said = run_program({"bench", "cantilever", "--n", "8", "--E", "1e5,1e6", "--steps", "20", "--json"});
    REQUIRE(said.code == 0);
    const auto lines = said.lines();
    REQUIRE(lines.size() == 2);
    for (const json& line : lines) {
        for (const char* key :
             {"bench", "n", "tets", "E", "threads", "law", "steps", "tip_y", "s_per_step_median", "newton_per_step",
              "assembly_ms", "factor_ms", "solve_ms", "residual_max", "unconverged", "digest"})
            CHECK(line.contains(key));
        CHECK(line.at("tets") == 192);
        CHECK(line.at("unconverged") == 0);
    }
    CHECK(lines[0].at("tip_y") < lines[1].at("tip_y"));
    const Said table = run_program({"bench", "cantilever", "--n", "8", "--E", "1e5,1e6", "--steps", "20"});
    CHECK(table.code == 0);
    CHECK(table.out.starts_with("tets"));
    CHECK(std::count(table.out.begin(), table.out.end(), '\n') == 4);
    for (const json& line : lines) CHECK(has(table.out, line.at("digest").get<std::string>()));
}

TEST_CASE("a quick cantilever is small, unless a size is given", "[tools]") {
    const auto sizes = [](std::vector<std::string> more) {
        std::vector<std::string> words{"bench", "cantilever", "--quick", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        std::vector<std::pair<int, int>> out; // tets, steps
        for (const json& line : run_program(words).lines()) out.emplace_back(line.at("tets"), line.at("steps"));
        return out;
    };
    CHECK(sizes({}) == std::vector<std::pair<int, int>>{{192, 3}, {192, 3}});
    CHECK(sizes({"--n", "4,12", "--E", "1e5", "--steps", "2"}) == std::vector<std::pair<int, int>>{{24, 2}, {648, 2}});
    CHECK(run_program({"bench", "cantilever", "--n", "8,9"}).code == 2);
    CHECK(run_program({"bench", "cantilever", "--n", "8", "--E", "0"}).code == 2);
}

TEST_CASE("bench says what each benchmark does, with an example, and refuses flags that it would not read", "[tools]") {
    const std::string help = run_program({"bench", "--help"}).out;
    for (const std::string name :
         {"cantilever", "meshing", "accuracy", "convergence", "work-precision", "levers", "scaling", "idle-cost",
          "graphs", "hard", "scene", "contact", "elements", "report"}) {
        INFO(name);
        CHECK(has(help, name + ":"));
        CHECK(has(help, "sinew bench " + name + " "));
    }
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{"accuracy", "--n", "8"},
                                                                                       {"cantilever", "--only", "E"},
                                                                                       {"meshing", "--quick", "a.obj"},
                                                                                       {"scaling", "--law", "StVK"}}) {
        std::vector<std::string> all{"bench"};
        all.insert(all.end(), words.begin(), words.end());
        const Said said = run_program(all);
        INFO(words[0]);
        CHECK(said.code == 2);
        CHECK(has(said.err, "has no " + words[1]));
        CHECK(said.out.empty());
    }
    for (const std::string name :
         {"scaling", "levers", "work-precision", "convergence", "accuracy", "idle-cost", "graphs", "hard"}) {
        const Said said = run_program({"bench", name, "--only", "no such thing"});
        INFO(name);
        CHECK(said.code == 2);
        CHECK(has(said.err, "no such thing"));
    }
}

TEST_CASE("a bench that could not write its files says so before it measures", "[tools]") {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "in the way";
    const std::string blocked = (folder / "file" / "out").string();
    for (const std::string name : {"convergence", "work-precision", "scaling", "report"}) {
        INFO(name);
        const Said said = run_program({"bench", name, "--quick", "-o", blocked + (name == "report" ? "/page.md" : "")});
        CHECK(said.code != 0);
        CHECK(has(said.err, "IO405"));
        CHECK(has(said.err, "--output"));
        CHECK_FALSE(has(said.err, "measuring"));
        CHECK(said.out.empty());
    }
    CHECK(has(run_program({"bench", "--help"}).out, "multiples of 4"));
}

namespace {

void check_graphs_of(const char* folder, int least) {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(fs::path(SINEW_SOURCE_DIR) / folder)) {
        if (entry.path().extension() != ".json") continue;
        INFO(entry.path());
        ++count;
        const Said check = run_program({"check", entry.path().string()});
        CHECK(check.code == 0);
        CHECK(check.beside_work().empty());
        const Said run = run_program({"run", entry.path().string(), "--frames", "1-3", "--quiet", "--strict"});
        CHECK(run.code == 0);
        CHECK(run.err.empty());
    }
    CHECK(count >= least);
}

} // namespace

TEST_CASE("the graphs to learn from are right and run", "[tools]") { check_graphs_of("graphs/learn", 5); }

TEST_CASE("the graphs that show effects are right and run", "[tools]") { check_graphs_of("graphs/demos", 9); }
