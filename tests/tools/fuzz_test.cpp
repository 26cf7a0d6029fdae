// A few dozen inputs of tests/fuzz: spoiled graphs, mesh files and GLBs, whose outcomes are known.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>

using namespace sinew::test;
using nlohmann::json;

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) // whose programs take more memory than is a finding
TEST_CASE("spoiled graphs, meshes and GLBs are told apart from good ones, whatever was done to them", "[tools]") {
    const TemporaryFolder folder;
    const std::string counts = (folder / "counts").string();
    const std::string command = "python3 '" SINEW_SOURCE_DIR "/tests/fuzz/run' --program '" SINEW_PROGRAM
                                "' --quick --graphs 20 --meshes 40 --glbs 12 --json --kept '" +
                                (folder / "findings").string() + "' > '" + counts + "'";
    CHECK(std::system(command.c_str()) == 0); // no finding
    // By the exit codes of the commands that were run on an input: 1 is what the program refused with a diagnostic.
    CHECK(json::parse(read_text(counts)) == json::parse(R"({
      "graphs": {"0 0 0": 5, "1": 15}, "meshes": {"0": 8, "1": 32}, "glbs": {"0 1": 5, "1": 7}})"));
}
#endif

TEST_CASE("what fuzzing begins with can be made of the graphs and files that there are", "[tools]") {
    const TemporaryFolder folder;
    const std::string counts = (folder / "counts").string();
    const std::string command = "cd '" SINEW_SOURCE_DIR "/tests/fuzz' && python3 -B -c '"
                                "import json, sys, samples, seeds\n"
                                "right, broken = samples.graphs(False)\n"
                                "made = {k: len(v) for k, v in seeds.all_seeds(sys.argv[1]).items()}\n"
                                "print(json.dumps([len(right), len(broken), made]))' '" SINEW_PROGRAM "' > '" +
                                counts + "' 2> /dev/null";
    REQUIRE(std::system(command.c_str()) == 0);
    const json made = json::parse(read_text(counts));
    std::size_t learn = 0;
    for (const auto& entry : std::filesystem::directory_iterator(SINEW_SOURCE_DIR "/graphs/learn"))
        learn += entry.path().extension() == ".json";
    CHECK(made[0] == learn + 1); // and the arm
    CHECK(made[1] > 50);
    for (const auto& [target, count] : made[2].items()) {
        INFO(target);
        CHECK(count > 0);
    }
    CHECK(made[2].size() == 21);
}
