// Graph files that may not be read; the others are in tests/tools/mistyped_graph_test.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_text.h"
#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <unistd.h>

using namespace sinew;
namespace fs = std::filesystem;

TEST_CASE("a graph file that its reader may not open is told from one that is not there", "[engine]") {
    const test::TemporaryFolder folder;
    const fs::path file = folder / "graph.json";
    test::write_text(file, "{}");
    fs::permissions(folder.path(), fs::perms::all);
    fs::permissions(file, fs::perms::none);
    const bool is_root = geteuid() == 0; // who may read everything
    if (is_root) REQUIRE(seteuid(65534) == 0);
    const engine::GraphText read = engine::graph_text(file.string());
    if (is_root) REQUIRE(seteuid(0) == 0);
    CHECK(read.code == "IO402");
    CHECK(read.message == "you may not read the graph file");
    CHECK(read.hint == "let yourself read it: chmod u+r, or ask whom it belongs to");
}
