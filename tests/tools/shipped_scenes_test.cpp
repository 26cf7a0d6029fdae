// The graphs of contact and attachments that ship in graphs/scenes run without a warning, converge, and are as their
// comments say; all that ships is in the list of graphs/README.md.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <filesystem>

using namespace sinew::test;
namespace fs = std::filesystem;

namespace {

const std::string root = SINEW_SOURCE_DIR;

} // namespace

TEST_CASE("the scenes of contact and attachments are right and run", "[tools][contact]") {
    for (const char* name : {"arm_collisions", "attachments", "one_of_each_attachment", "goal_fish", "collisions",
                             "one_of_each_collision"}) {
        INFO(name);
        const std::string graph = root + "/graphs/scenes/" + name + ".json";
        const Said check = run_program({"check", graph, "--no-cache"});
        CHECK(check.code == 0);
        CHECK(check.beside_work().empty());
        const Said run = run_program({"run", graph, "--frames", "1-3", "--quiet", "--strict", "--no-cache"});
        CHECK(run.code == 0);
        CHECK(run.err.empty());
    }
}

TEST_CASE("every graph that ships is in the list of graphs/README.md", "[tools]") {
    const std::string list = read_text(root + "/graphs/README.md");
    int count = 0;
    for (const char* folder : {"learn", "demos", "scenes", "bench"})
        for (const auto& entry : fs::directory_iterator(root + "/graphs/" + folder)) {
            if (entry.path().extension() != ".json") continue;
            ++count;
            INFO(entry.path());
            CHECK(list.find("(" + std::string(folder) + "/" + entry.path().filename().string() + ")") !=
                  std::string::npos);
        }
    CHECK(count > 30);
}
