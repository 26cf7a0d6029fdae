// A few dozen inputs of tests/fuzz: spoiled graphs, mesh files and GLBs, whose outcomes are known.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <cstdlib>

using namespace sinew::test;
using nlohmann::json;

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
