// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/temporary_folder.h"
#include "tools/cli/print.h"
#include "tools/cli/unfinished.h"

#include <catch2/catch.hpp>

using namespace sinew::cli;
using sinew::test::TemporaryFolder;

TEST_CASE("a run's mark says what it was to give, and goes when it is through", "[tools]") {
    const TemporaryFolder folder;
    UnfinishedRun run{"arm.json", 1, 24, 24, {}, false};
    mark_unfinished(folder.path(), run);
    REQUIRE(find_unfinished(folder.path()).size() == 1);
    CHECK(find_unfinished(folder.path())[0].is_alive); // this very process
    CHECK(find_unfinished(folder.path())[0].last == 24);
    run.error = RunError{3, "FE302", "solver", "it broke \xff"};
    mark_unfinished(folder.path(), run);
    const auto failed = find_unfinished(folder.path());
    REQUIRE(failed.size() == 1);
    CHECK_FALSE(failed[0].is_alive);
    REQUIRE(failed[0].error);
    CHECK(failed[0].error->frame == 3);
    CHECK(failed[0].error->code == "FE302");

    mark_unfinished(folder.path(), {"arm.json", 30, 40, 11, RunError{31, "", "", "cancelled"}, false});
    mark_finished(folder.path(), {"arm.json", 1, 24, 24, {}, false});
    REQUIRE(find_unfinished(folder.path()).size() == 1); // another range has its own
    CHECK(find_unfinished(folder.path())[0].first == 30);
    mark_finished(folder.path(), {"arm.json", 1, 48, 48, {}, false}); // a later run over all frames clears it
    CHECK(find_unfinished(folder.path()).empty());
    sinew::test::write_text(folder / "unfinished.0001.json", "{\"first\": \"x\"}");
    CHECK(find_unfinished(folder.path()).empty());
}

TEST_CASE("links to files are escaped", "[tools]") {
    CHECK(file_url("/tmp/a.html") == "file:///tmp/a.html");
    CHECK(file_url("/tmp/sp ace#1%41?/ü.html") == "file:///tmp/sp%20ace%231%2541%3F/%C3%BC.html");
}
