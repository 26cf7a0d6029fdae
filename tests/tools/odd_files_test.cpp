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
