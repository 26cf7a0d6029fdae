// No command writes over the graph or a file that it reads, by whatever name, and none looks for room too late.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <filesystem>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A bone from `mesh`, and a second graph that is included; frames 1 and 2.
std::string bone_graph(const TemporaryFolder& folder, const std::string& mesh, const std::string& name) {
    write_text(folder / "part.json", R"({"format": "sinew 1", "nodes": {
      "cube": {"type": "polyCube"}, "bone": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}}}}})");
    const json graph = {
        {"format", "sinew 1"},
        {"timing", {{"fps", 24}, {"start", 1}, {"end", 2}}},
        {"includes", {{"left", {{"file", "part.json"}}}}},
        {"nodes",
         {{"shape", {{"type", "meshFile"}, {"inputs", {{"file", mesh}}}}},
          {"bone", {{"type", "zBone"}, {"inputs", {{"mesh", {{"from", "shape.outMesh"}}}}}}},
          {"solver",
           {{"type", "zSolver"},
            {"inputs", {{"bodies", {{{"from", "bone.outBody"}}, {{"from", "left.bone.outBody"}}}}}}}}}}};
    return write_graph(folder, graph, name);
}

constexpr const char* tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Refused with both names, and the file is as it was.
void check_refused(const std::vector<std::string>& words, const fs::path& kept, const std::string& named) {
    const std::string before = read_text(kept);
    const Said said = run_program(words);
    INFO(said.err);
    CHECK(said.code == 1);
    CHECK(has(said.err, "IO420"));
    CHECK(has(said.err, named));
    CHECK(has(said.err, kept.filename().string()));
    CHECK_FALSE(has(said.out, "wrote"));
    CHECK(read_text(kept) == before);
}

} // namespace

TEST_CASE("no command writes over the graph, its includes or what it reads", "[tools]") {
    const TemporaryFolder folder;
    write_text(folder / "bone.obj", tetrahedron);
    const std::string graph = bone_graph(folder, "bone.obj", "g.json"), mesh = (folder / "bone.obj").string(),
                      part = (folder / "part.json").string();
    fs::create_directory(folder / "sub");
    fs::create_symlink(folder / "bone.obj", folder / "sub/alias.png");
    for (const std::vector<std::string>& command : {std::vector<std::string>{"run", graph, "--no-cache", "--report"},
                                                    {"snapshot", graph, "--no-cache", "-o"},
                                                    {"view", graph, "--no-cache", "-o"},
                                                    {"graph", graph, "--svg"}}) {
        const auto to = [&](const std::string& file) {
            std::vector<std::string> words = command;
            words.push_back(file);
            return words;
        };
        check_refused(to(graph), graph, "the graph itself");
        check_refused(to((folder / "sub/../g.json").string()), graph, "the graph itself");
        check_refused(to(mesh), mesh, "shape.file");
        check_refused(to((folder / "sub/alias.png").string()), mesh, "shape.file");
        check_refused(to(part), part, "the graph includes");
    }
    // By way of a second graph that is only compared with.
    write_text(folder / "second.obj", tetrahedron);
    const std::string other = bone_graph(folder, "second.obj", "other.json");
    check_refused({"view", other, "--no-cache", "--against", graph, "-o", mesh}, mesh, "shape.file");
    CHECK(run_program({"graph", graph, "--svg", (folder / "new.svg").string()}).code == 0);
}

TEST_CASE("a run does not write its meshes over those that it reads", "[tools]") {
    const TemporaryFolder folder;
    fs::create_directory(folder / "obj");
    write_text(folder / "obj/bone.0002.obj", tetrahedron);
    const std::string graph = bone_graph(folder, "obj/bone.0002.obj", "g.json"), out = folder.path().string();
    check_refused({"run", graph, "--no-cache", "--format", "obj", "--out", out}, folder / "obj/bone.0002.obj",
                  "shape.file");
    CHECK_FALSE(fs::exists(folder / "obj/bone.0001.obj")); // before anything is written
    // Frame 1 alone goes beside it.
    CHECK(run_program({"run", graph, "--no-cache", "--format", "obj", "--out", out, "--frames", "1"}).code == 0);
    CHECK(read_text(folder / "obj/bone.0002.obj") == tetrahedron);
    // A GLB that is read under the name that the run's would have.
    const std::string made = (folder / "made").string();
    CHECK(run_program({"run", graph, "--no-cache", "--out", made}).code == 0);
    const std::string second = bone_graph(folder, "made/second.glb", "second.json");
    fs::copy_file(folder / "made/g.glb", folder / "made/second.glb");
    check_refused({"run", second, "--no-cache", "--out", made}, folder / "made/second.glb", "shape.file");
}

TEST_CASE("pictures and pages of a folder leave its meshes alone", "[tools]") {
    const TemporaryFolder folder;
    write_text(folder / "bone.obj", tetrahedron);
    const std::string graph = bone_graph(folder, "bone.obj", "g.json"), out = (folder / "out").string();
    CHECK(run_program({"run", graph, "--no-cache", "--format", "obj", "--out", out}).code == 0);
    const fs::path frame = folder / "out/obj/bone.0001.obj";
    check_refused({"snapshot", out, "-o", frame.string()}, frame, "a mesh of the run");
    check_refused({"view", out, "-o", frame.string()}, frame, "a mesh of the run");
}

TEST_CASE("a place where nothing can be made is found before a run", "[tools]") {
    const TemporaryFolder folder;
    write_text(folder / "bone.obj", tetrahedron);
    const std::string graph = bone_graph(folder, "bone.obj", "g.json");
    // Whoever runs this may write there by its permissions, if it is root, and still cannot.
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"view", graph, "--no-cache", "-o", "/proc/x.html"},
          {"snapshot", graph, "--no-cache", "-o", "/proc/x.png"},
          {"run", graph, "--no-cache", "--report", "/proc/x.json"}}) {
        const Said said = run_program(words);
        CHECK(said.code == 1);
        CHECK(has(said.err, "IO405"));
        CHECK(has(said.err, "choose another")); // the check's words, not those of the write
        CHECK_FALSE(has(said.err, "frame 1"));
    }
}
