// Files that are none, and names that are no text.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

using namespace sinew::test;
using nlohmann::json;

namespace {

const std::string ball = SINEW_SOURCE_DIR "/graphs/learn/01_hanging_ball.json";

} // namespace

TEST_CASE("a pipe that nobody writes to is refused as mesh, graph and painted map, not waited for", "[tools]") {
    const TemporaryFolder folder;
    for (const char* name : {"pipe.obj", "pipe.json"}) REQUIRE(mkfifo((folder / name).c_str(), 0600) == 0);
    for (const char* name : {"pipe.obj", "pipe.json"})
        for (const char* command : {"check", "run"}) {
            INFO(command << " " << name);
            const Said said = run_program({command, (folder / name).string()});
            CHECK(said.code == 1);
            CHECK((said.out + said.err).find("IO402") != std::string::npos);
            CHECK((said.out + said.err).find("a pipe or a device") != std::string::npos);
        }
    json graph = json::parse(read_text(ball));
    graph["nodes"]["pipe"] = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "pipe.obj").string()}}}};
    write_text(folder / "graph.json", graph.dump());
    const Said said = run_program({"eval", (folder / "graph.json").string(), "pipe.outMesh"});
    CHECK(said.code != 0);
    CHECK(said.err.find("IO402") != std::string::npos);
}

TEST_CASE("pipes, devices and links to nowhere among the frames of a folder are left out and told", "[tools]") {
    const TemporaryFolder folder;
    write_text(folder / "a.0001.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string page = (folder / "page.html").string(), picture = (folder / "picture.png").string();
    for (const char* pipe : {"a.0002.obj", "run.glb", "unfinished.x.json", "view.html"})
        REQUIRE(mkfifo((folder / pipe).c_str(), 0600) == 0);
    std::filesystem::create_symlink("/dev/zero", folder / "a.0003.obj");
    std::filesystem::create_symlink(folder / "gone", folder / "a.0004.obj");
    const Said viewed = run_program({"view", folder.path().string(), "-o", page});
    INFO(viewed.err);
    CHECK(viewed.code == 0);
    CHECK(viewed.err.find(" and 2 more are called as a frame is, but no file that can be read; left out.") !=
          std::string::npos);
    CHECK(viewed.out.find(" 1 frame;") != std::string::npos);
    CHECK(run_program({"snapshot", folder.path().string(), "-o", picture, "--frames", "1"}).code == 0);
    // With nothing else in it there is nothing to show.
    std::filesystem::remove(folder / "a.0001.obj");
    CHECK(run_program({"view", folder.path().string(), "-o", page}).code == 1);
    CHECK(run_program({"snapshot", folder.path().string(), "-o", picture}).code == 2);
}

TEST_CASE("a file whose name is no UTF-8 is checked, run and told of in JSON", "[tools]") {
    const TemporaryFolder folder;
    const std::string name = (folder / "odd\xff.json").string();
    write_text(name, read_text(ball));
    const Said checked = run_program({"check", name, "--json"});
    CHECK(checked.code == 0);
    CHECK(json::parse(checked.out).dump().find("odd\xEF\xBF\xBD.json") != std::string::npos);
    const std::string out = (folder / "o\xfft").string();
    const Said ran = run_program({"run", name, "--frames", "1", "--out", out, "--json", "--report", out + "/r.json"});
    INFO(ran.err);
    CHECK(ran.code == 0);
    CHECK(ran.lines().back().at("event") == "done");
    CHECK(json::parse(read_text(out + "/r.json")).at("frames").size() == 1);
}

TEST_CASE("a pipe that nobody reads is told of when the report is due, and frames are written", "[tools]") {
    const TemporaryFolder folder;
    const std::string pipe = (folder / "pipe").string(), out = (folder / "out").string();
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    const Said said = run_program({"run", ball, "--frames", "1", "--no-cache", "--out", out, "--report", pipe});
    CHECK(said.code == 1);
    CHECK(said.err.find("cannot write '" + pipe + "': nothing reads from this pipe") != std::string::npos);
    CHECK(std::filesystem::exists(out + "/01_hanging_ball.glb"));
}

TEST_CASE("a report does not go over the animation of its run, and a folder has a name", "[tools]") {
    const TemporaryFolder folder;
    const std::string out = (folder / "out").string();
    const auto run = [&](const std::string& into, const std::string& report) {
        return run_program({"run", ball, "--frames", "1", "--no-cache", "--out", into, "--report", report});
    };
    for (const char* name : {"/01_hanging_ball.glb", "/../out/./01_hanging_ball.glb"}) {
        const Said over = run(out, out + name);
        CHECK(over.code == 1);
        CHECK(over.err.find("error [IO420] --report and the animation of --out would be one: ") != std::string::npos);
        CHECK_FALSE(std::filesystem::exists(out + "/01_hanging_ball.glb"));
    }
    CHECK(run(out, out + "/01_hanging_ball.json").code == 0);
    const Said page = run_program(
        {"run", ball, "--frames", "1", "--no-cache", "--out", out, "--open", "--report", out + "/view.html"});
    CHECK(page.code == 1);
    CHECK(page.err.find("--report and the page of --open would be one: ") != std::string::npos);
    std::filesystem::create_symlink("out/01_hanging_ball.glb", folder / "link");
    std::filesystem::remove(out + "/01_hanging_ball.glb");
    CHECK(run(out, (folder / "link").string()).err.find("the animation of --out would be one: ") != std::string::npos);
    for (const char* name : {"/obj/ball.0001.obj", "/ply/ball.0001.ply", "/ball.0001.csv", "/unfinished.0001.json"})
        CHECK(run(out, out + name).err.find("error [IO420] --report and ") != std::string::npos);
    const std::string fresh = (folder / "fresh").string();
    CHECK(run(fresh, fresh).err.find("error [IO420] --report and the folder of --out would be one: ") !=
          std::string::npos);
    const Said unnamed = run(out, "");
    CHECK(unnamed.code == 1);
    CHECK(unnamed.err.find("cannot write '': it has no name") != std::string::npos);
    const Said nowhere = run("", out + "/r.json");
    CHECK(nowhere.code == 2);
    CHECK(nowhere.err.find("--out needs the name of a folder.") != std::string::npos);
}

TEST_CASE("a number that is too large is told of with its line in the file", "[tools]") {
    const TemporaryFolder folder;
    const std::string numbers = (folder / "n.json").string();
    write_text(numbers, "[\"-1e999\",\n 2,\n 1.5,\n -1e999]");
    json graph = json::parse(read_text(ball));
    graph["nodes"]["list"] = {
        {"type", "weights"},
        {"inputs", {{"mesh", {{"from", "ballMesh.outMesh"}}}, {"mode", "file"}, {"file", numbers}}}};
    write_text(folder / "graph.json", graph.dump());
    const Said said = run_program({"eval", (folder / "graph.json").string(), "list.outWeights"});
    CHECK(said.code == 1);
    CHECK(said.err.find("n.json' line 4: -1e999 is too large for a number") != std::string::npos);
}
