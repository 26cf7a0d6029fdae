// What libsinew shows to others: the functions of its header, all of them and nothing else.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <regex>
#include <set>
#include <sstream>

using sinew::test::read_text;
using sinew::test::TemporaryFolder;

TEST_CASE("libsinew exports the functions of sinew.h and nothing else", "[embed]") {
    const TemporaryFolder folder;
    const std::string out = (folder / "symbols").string();
    REQUIRE(std::system(("nm -D --defined-only --format=posix '" SINEW_LIBRARY "' > '" + out + "'").c_str()) == 0);
    std::set<std::string> exported, declared;
    std::istringstream lines(read_text(out));
    for (std::string line; std::getline(lines, line);) exported.insert(line.substr(0, line.find(' ')));
    const std::string header = read_text(SINEW_SOURCE_DIR "/tools/c/sinew.h");
    const std::regex function(R"(SINEW_API [a-z0-9_ *]+[ *](sinew_[a-z_]+)\()");
    for (std::sregex_iterator m(header.begin(), header.end(), function), end; m != end; ++m) declared.insert((*m)[1]);
    CHECK(declared.size() == 26);
    CHECK(exported == declared);
}
