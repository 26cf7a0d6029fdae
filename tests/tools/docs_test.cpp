// The reference pages that are committed are what the program writes, and what terms measure is explained.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/all_terms.h"
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <map>
#include <sstream>

using namespace sinew::test;

TEST_CASE("the reference pages in docs are those that the declarations give", "[tools]") {
    const TemporaryFolder folder;
    REQUIRE(run_program({"docs", folder.path().string()}).code == 0);
    for (const char* page : {"nodes.md", "codes.md", "graph.schema.json"}) {
        INFO(page << ": run `sinew docs docs/reference` after a change of declarations");
        CHECK(read_text(folder / page) == read_text(std::filesystem::path(SINEW_SOURCE_DIR) / "docs/reference" / page));
    }
}

TEST_CASE("docs/concepts/report.md says what each term measures", "[tools]") {
    std::istringstream page(read_text(std::filesystem::path(SINEW_SOURCE_DIR) / "docs/concepts/report.md"));
    std::map<std::string, std::string> rows; // by term
    for (std::string line; std::getline(page, line);)
        if (line.starts_with("| `")) rows[line.substr(3, line.find('`', 3) - 3)] = line;
    for (const sinew::solver::TermType* type : sinew::solver::all_terms())
        for (const sinew::solver::Measure& m : type->measures) {
            INFO(m.term << " " << m.name);
            const std::string& row = rows[std::string(m.term)];
            CHECK(row.find("`" + std::string(m.name) + "`") != std::string::npos);
        }
}
