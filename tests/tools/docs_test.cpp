// The reference pages that are committed are what the program writes.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

using namespace sinew::test;

TEST_CASE("the reference pages in docs are those that the declarations give", "[tools]") {
    const TemporaryFolder folder;
    REQUIRE(run_program({"docs", folder.path().string()}).code == 0);
    for (const char* page : {"nodes.md", "codes.md", "graph.schema.json"}) {
        INFO(page << ": run `sinew docs docs/reference` after a change of declarations");
        CHECK(read_text(folder / page) == read_text(std::filesystem::path(SINEW_SOURCE_DIR) / "docs/reference" / page));
    }
}
