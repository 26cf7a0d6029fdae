// What cannot be written or removed is told of what it is, and counts for nothing.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <vector>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

TEST_CASE("a mesh that cannot be written is told of its own frame, which is not among the finished ones", "[tools]") {
    const int failing = GENERATE(3, 6); // in the middle, and the last one
    const TemporaryFolder folder;
    const fs::path out = folder / "out", report = folder / "report.json";
    char name[32];
    std::snprintf(name, sizeof name, "block.%04d.ply", failing);
    fs::create_directories(out / "ply" / name / "in_its_place");
    const Said said = run_program({"run", write_graph(folder, small_graph()), "--no-cache", "--out", out.string(),
                                   "--format", "ply", "--report", report.string()});
    INFO(said.err);
    CHECK(said.code == 1);
    CHECK(said.err.find("[IO405]") != std::string::npos);
    const json told = json::parse(read_text(report));
    CHECK(told.at("error").at("code") == "IO405");
    CHECK(told.at("error").at("frame") == failing);
    std::vector<int> frames, wanted;
    for (const json& frame : told.at("frames")) frames.push_back(frame.at("frame"));
    for (int frame = 1; frame < failing; ++frame) wanted.push_back(frame);
    CHECK(frames == wanted);
    const json mark = json::parse(read_text(out / "unfinished.0001.json"));
    CHECK(mark.at("error").at("frame") == failing);
}

TEST_CASE("an animation that cannot be written leaves the report of its frames", "[tools]") {
    const TemporaryFolder folder;
    const fs::path out = folder / "out", report = folder / "report.json";
    fs::create_directories(out / "small.glb" / "in_its_place");
    const Said said = run_program(
        {"run", write_graph(folder, small_graph()), "--no-cache", "--out", out.string(), "--report", report.string()});
    INFO(said.err);
    CHECK(said.code == 1);
    CHECK(said.err.find("[IO405]") == said.err.rfind("[IO405]")); // told once
    CHECK(said.err.find("small.glb") != std::string::npos);
    const json told = json::parse(read_text(report));
    CHECK(told.at("error").at("code") == "IO405");
    CHECK(told.at("frames").size() == 6);
    CHECK(json::parse(read_text(out / "unfinished.0001.json")).at("error").at("code") == "IO405");
}

TEST_CASE("cleaning a cache counts what was removed, and tells what was not", "[tools]") {
    const TemporaryFolder folder;
    const fs::path cache = folder / "cache";
    const std::string kept_name = std::string(32, 'a') + ".frame";
    fs::create_directories(cache / kept_name / "in_its_place"); // cannot be removed as a file is
    write_text(cache / (std::string(32, 'b') + ".frame"), "12345");
    const Said said = run_program({"cache", "clean", cache.string(), "--json"});
    INFO(said.out << said.err);
    CHECK(said.code == 1);
    const json told = said.lines().front();
    CHECK(told.at("frames") == 1);
    CHECK(told.at("bytes") == 5);
    CHECK(told.at("removed") == false);
    const Said again = run_program({"cache", "clean", cache.string()});
    CHECK(again.code == 1);
    CHECK(again.out.find("nothing was removed") != std::string::npos);
    CHECK(again.err.find("[IO405] cannot remove '" + (cache / kept_name).string() + "': ") != std::string::npos);
}

TEST_CASE("frames before the start are the start, which is simulated for the first of them", "[tools]") {
    const TemporaryFolder folder;
    const Said said =
        run_program({"run", write_graph(folder, small_graph()), "--no-cache", "--frames", "-3,-2,1", "--json"});
    CHECK(said.code == 0);
    const json done = said.lines().back();
    CHECK(done.at("frames") == 3);
    CHECK(done.at("frames_simulated") == 1);
    CHECK(done.at("frames_reused") == 2);
}
