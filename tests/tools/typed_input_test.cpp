// What people type, through the command line.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <fstream>

using namespace sinew::test;
using nlohmann::json;

namespace {

std::string put(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
    return (folder / name).string();
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("units and presets and comments as people type them in the file and by --set", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = put(folder, "g.json", R"(// a soft thing
{ "$schema": "s.json", "format": "sinew 1", "comment": "mine",
  "nodes": { /* the flesh */ "flesh": { "type": "zMaterial", "inputs": {
      "youngsModulus": "15 kPa" } }, "hard": { "type": "zMaterial", "inputs": { "youngsModulus": "skeletalMuscle" } } } })");
    const auto written = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"graph", file, "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const Said said = run_program(words);
        CHECK(said.code == 0);
        return said.out;
    };
    CHECK(run_program({"check", file}).code == 0);
    const std::string plain = written({});
    CHECK(has(plain, "\"youngsModulus\": 15000"));
    CHECK(has(plain, "{\n  // a soft thing\n  \"$schema\": \"s.json\""));
    CHECK(has(plain, "\"comment\": \"mine\""));
    CHECK(has(plain, "/* the flesh */\n    \"flesh\""));
    CHECK(has(written({"--set", "flesh.youngsModulus=30kPa"}), "\"youngsModulus\": 30000"));
    CHECK(has(written({"--set", "flesh.youngsModulus=0.25 MPa"}), "\"youngsModulus\": 250000"));
    const Said wrong = run_program({"check", file, "--set", "flesh.youngsModulus=30km"});
    CHECK(wrong.code == 1);
    CHECK(has(wrong.err, "\"km\" does not convert to \"Pa\""));
}

TEST_CASE("errors of flags end with what is wrong", "[tools]") {
    const Said said = run_program({"snapshot", "g.json", "--frmes", "1"});
    CHECK(said.code == 2);
    CHECK(said.err.starts_with("Usage: sinew snapshot "));
    CHECK(said.err.ends_with(
        "\nsinew snapshot: unknown flag '--frmes'. Did you mean '--frames'? `sinew snapshot --help` says more.\n"));
    CHECK(has(run_program({"run", SINEW_SOURCE_DIR "/graphs/scenes/arm.json", "--frames", "10-1"}).err,
              "'10-1' ends before it begins; write 1-10."));
    CHECK(has(run_program({"run", "g.json", "-j4"}).err, "unknown flag '-j4'. Did you mean '--threads 4'?"));
    CHECK(has(run_program({"run", "g.json", "-f"}).err, "unknown flag '-f'. Did you mean '--frames'?"));
    CHECK(has(run_program({"run", "g.json", "-fast"}).err, "unknown flag '-fast'. `sinew run"));
}

TEST_CASE("a file that is neither graph nor mesh is refused by its ending", "[tools]") {
    const TemporaryFolder folder;
    const Said said = run_program({"check", put(folder, "body.fbx", "Kaydara")});
    CHECK(said.code == 1);
    CHECK(has(said.err, "error [IO404]"));
    CHECK(has(said.err, "'.fbx' is not a surface format that can be read"));
    CHECK(has(said.err, "hint: export it from the program that it is of; .obj, "));
    const Said scene = run_program({"check", put(folder, "body.gltf", R"({"asset": {"version": "2.0"}})")});
    CHECK(scene.code == 1);
    CHECK(has(scene.err,
              "body.gltf: '.gltf' is not a surface format that can be read\n  hint: export it from the program"));
    const Said bare = run_program({"check", put(folder, "body", "solid")});
    CHECK(bare.code == 1);
    CHECK(has(
        bare.err,
        "body: its name has no ending, which tells how it is to be read\n  hint: give it the one that it is: .obj"));
    const Said run = run_program({"run", put(folder, "body.obj", "v 0 0 0\n")});
    CHECK(run.code == 1);
    CHECK(has(run.err, "this is no graph file"));
    const Said none = run_program({"check", (folder / "none.xyz").string()});
    CHECK(has(none.err, "error [IO401]"));
}

TEST_CASE("meshes with a byte order mark or blank lines or strips are read", "[tools]") {
    const TemporaryFolder folder;
    CHECK(run_program({"check", put(folder, "a.obj", "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")}).code == 0);
    CHECK(run_program({"check", put(folder, "a.off", "\n\nOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")}).code == 0);
    const Said strip = run_program(
        {"check", "--json",
         put(folder, "a.ply",
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
             "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
             "0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n")});
    CHECK(strip.lines().at(0).at("triangles") == 2);
}

TEST_CASE("what is wrong in --set is told there and not at the file's value", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = put(folder, "g.json", R"({"format": "sinew 1", "nodes": {
      "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 12000, "poissonsRatio": 0.4}},
      "place": {"type": "transform", "inputs": {"translate": [0, 0, 0]}}}})");
    const auto said_of = [&](const std::string& setting) {
        const Said said = run_program({"check", file, "--set", setting});
        CHECK(said.code == 1);
        CHECK_FALSE(has(said.err, "g.json:"));
        CHECK(said.err.starts_with("--set " + setting + ": error ["));
        return said.err;
    };
    CHECK(has(said_of("place.translate=[0,5]"), "expected 3 numbers, found 2"));
    CHECK(has(said_of("flesh.youngsModulus=-1"), "is outside"));
    for (const char* nothing : {"", "NaN", "-inf"}) {
        const std::string number = std::string("flesh.youngsModulus=") + nothing;
        CHECK(has(said_of(number), "hint: write a finite number, or one with its unit"));
        CHECK(has(said_of(std::string("flesh.poissonsRatio=") + nothing), "hint: write a finite number"));
    }
    CHECK(has(said_of("flesh.youngsModulus=1e400"),
              "error [DG027] flesh.youngsModulus: 1e400 is too large for a number"));
}

TEST_CASE("numbers in --set may begin with a dot or a plus, where no word is asked for", "[tools]") {
    const std::string file = SINEW_SOURCE_DIR "/graphs/learn/02_muscle_pulls.json";
    const auto written = [&](const std::string& setting, const char* node, const char* input) {
        const Said said = run_program({"graph", file, "--json", "--set", setting});
        INFO(said.err);
        return json::parse(said.out).at("nodes").at(node).at("inputs").at(input);
    };
    CHECK(written("flesh.poissonsRatio=.2", "flesh", "poissonsRatio") == 0.2);
    CHECK(written("solver.substeps=+5", "solver", "substeps") == 5);
    CHECK(written("flesh.youngsModulus=.5kPa", "flesh", "youngsModulus") == 500);
    CHECK(has(run_program({"check", file, "--set", "solver.integrator=.2"}).err, "\".2\" is not an option"));
    CHECK(has(run_program({"check", file, "--set", "solver.integrator=2"}).err, "hint: options: BackwardEuler, BDF2"));
}

TEST_CASE("a list or object in --set that is not complete is told where it is wrong", "[tools]") {
    const std::string arm = SINEW_SOURCE_DIR "/graphs/scenes/arm.json";
    const auto said_of = [&](const char* setting) {
        return run_program({"check", "--fast", arm, "--set", setting}).err;
    };
    CHECK(has(said_of("solver.gravity=[0,-9.8,0"),
              "error [DG001] solver.gravity: expected , or ] in a list, the text ends"));
    CHECK(
        has(said_of("solver.gravity={keys:[[1,0]]}"), "error [DG001] solver.gravity: expected a key in quotes, found"));
}

TEST_CASE("numbers out of all reason are refused at the input that holds them", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = write_graph(folder, small_graph());
    for (const std::string& setting :
         {"solver.scale=1e-155", "solver.scale=1e155", "solver.framesPerSecond=1e-9", "solver.framesPerSecond=1e9",
          "plateMesh.width=1e61", "plateMesh.height=1e300"}) {
        CAPTURE(setting);
        const Said said = run_program({"run", file, "--no-cache", "--set", setting});
        CHECK(said.code == 1);
        const std::string input = setting.substr(0, setting.find('='));
        CHECK(has(said.err, "--set " + setting + ": error [DG013] " + input + ": "));
    }
    CHECK(run_program({"check", file, "--set", "solver.scale=1e-3", "--set", "solver.framesPerSecond=1e6"}).code == 0);
}

TEST_CASE("a scene of too many frames is refused before it takes memory", "[tools]") {
    const TemporaryFolder folder;
    nlohmann::json graph = small_graph();
    graph["timing"]["end"] = 999'999'999;
    const std::string file = write_graph(folder, graph);
    for (const std::vector<std::string>& words : {std::vector<std::string>{"check", file},
                                                  {"run", file},
                                                  {"explain", file, "solver.outMeshes"},
                                                  {"view", file, "-o", (folder / "v.html").string()},
                                                  {"snapshot", file, "-o", (folder / "s.png").string()}}) {
        CAPTURE(words.front());
        const Said said = run_program(words);
        CHECK(said.code == 1);
        CHECK(has(said.err, "error [DG009] "));
        CHECK(has(said.err, "; a million are possible"));
    }
}

TEST_CASE("words and vectors that are written as something else are told how they are written", "[tools]") {
    const TemporaryFolder folder;
    const auto said_of = [&](const std::string& nodes) {
        return run_program(
                   {"check", "--fast", put(folder, "g.json", R"({"format": "sinew 1", "nodes": {)" + nodes + "}}")})
            .err;
    };
    CHECK(has(said_of(R"("t": {"type": "zTissue", "inputs": {"material": {"preset": "neohookean"}}})"),
              "has words instead of presets\n  hint: write one without an object, \"NeoHookean\"; words: StVK, "));
    CHECK(has(said_of(R"("s": {"type": "zSolver", "inputs": {"gravity": -9.8}})"),
              "hint: write three numbers: [0, -9.8, 0]\n"));
    CHECK(has(said_of(R"("s": {"type": "zSolver", "inputs": {"gravity": 9.8}})"),
              "hint: write three numbers: [0, -9.8, 0]\n"));
    CHECK(has(said_of(R"("m": {"type": "transform", "inputs": {"translate": 3}})"), "[3, 3, 3] if all of them are 3"));
    // Colours as other programs write them; presets of another attribute; the unit's name as scale.
    CHECK(has(said_of(R"("b": {"type": "zBone", "inputs": {"colour": "#ff8000"}})"), "hint: write [1, 0.502, 0]\n"));
    CHECK(has(said_of(R"("b": {"type": "zBone", "inputs": {"colour": "#0f0"}})"), "hint: write [0, 1, 0]\n"));
    CHECK(has(said_of(R"("b": {"type": "zBone", "inputs": {"colour": "Red"}})"), "hint: write [1, 0, 0]\n"));
    CHECK(has(said_of(R"("b": {"type": "zBone", "inputs": {"colour": "#12345g"}})"), "three numbers: [x, y, z]\n"));
    CHECK(has(said_of(R"("m": {"type": "zMaterial", "inputs": {"massDensity": "bone"}})"),
              "expected number, found text\n  hint: write a number; \"bone\" is a preset of youngsModulus alone\n"));
    CHECK(has(said_of(R"("s": {"type": "zSolver", "inputs": {"scale": "km"}})"), "s.scale: unknown preset \"km\""));
    // All units that `sinew new --unit` takes.
    for (const auto& [unit, scale] :
         {std::pair{"mm", "1000"}, {"dm", "10"}, {"in", "39.37007874015748"}, {"ft", "3.280839895013123"}}) {
        const Said scaled = run_program({"graph", SINEW_SOURCE_DIR "/graphs/scenes/arm.json", "--json", "--set",
                                         std::string("solver.scale=") + unit});
        CHECK(has(scaled.out, std::string("\"scale\": ") + scale));
    }
}

TEST_CASE("a file that is not there is answered by the one that is near", "[tools]") {
    const TemporaryFolder folder;
    put(folder, "biceps_left.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    const auto said_of = [&](const std::string& file) {
        return run_program({"check", put(folder, "g.json",
                                         R"({"format": "sinew 1", "nodes": {"m": {"type": "meshFile", "inputs": )"
                                         R"({"file": ")" +
                                             file + "\"}}}}")})
            .err;
    };
    CHECK(has(said_of("Biceps_Left.obj"), "[IO401] m.file: there is no file \"Biceps_Left.obj\"\n  hint: did you mean "
                                          "\"biceps_left.obj\"?\n"));
    CHECK(has(said_of("bicep_left.obj"), "hint: did you mean \"biceps_left.obj\"?\n"));
    CHECK(has(said_of("./biceps_left.ply"), "hint: did you mean \"./biceps_left.obj\"?\n"));
    CHECK(has(said_of("femur.obj"), "/femur.obj; relative paths start at the graph's folder\n"));
    CHECK(has(said_of("meshes/biceps_left.obj"), "relative paths start at the graph's folder\n"));
}

TEST_CASE("text in UTF-16 is told as that", "[tools]") {
    const TemporaryFolder folder;
    const std::string mark = "\xFF\xFE", wide("v\0 \0", 4);
    CHECK(has(run_program({"check", "--meshes", put(folder, "a.obj", mark + wide)}).err,
              "a.obj is text in UTF-16\n  hint: save it as UTF-8 or plain ASCII\n"));
    CHECK(has(run_program({"check", put(folder, "g.json", mark + std::string("{\0", 2))}).err,
              "error [DG004] the file is written in UTF-16\n  hint: save it as UTF-8\n"));
}

TEST_CASE("a mesh under another format's ending is told as what it is", "[tools]") {
    const TemporaryFolder folder;
    const std::string obj = "# made by hand\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    for (const char* name : {"a.ply", "a.stl", "a.off"}) {
        INFO(name);
        CHECK(has(run_program({"check", put(folder, name, obj)}).err,
                  "\n  hint: it looks like a file that should end in .obj\n"));
    }
    CHECK(has(run_program({"check", put(folder, "b.obj", "ply\nformat ascii 1.0\n")}).err,
              "\n  hint: it looks like a file that should end in .ply\n"));
    CHECK(has(run_program({"check", put(folder, "c.obj", std::string("\x7f\x45\0\1\2", 5))}).err,
              "\n  hint: it is no text, but binary; export it anew\n"));
    CHECK(!has(run_program({"check", put(folder, "d.obj", obj + "nonsense\n")}).err, "hint"));
}
