// What fuzzing found, and what it begins with, goes through the readers again: refused with words, or read.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/targets/targets.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace fs = std::filesystem;
using namespace sinew::fuzz;

namespace {

const fs::path here = SINEW_SOURCE_DIR "/tests/fuzz";

std::vector<fs::path> files_of(const fs::path& folder) {
    std::vector<fs::path> out;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) out.push_back(entry.path());
    std::sort(out.begin(), out.end());
    return out;
}

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

} // namespace

TEST_CASE("what fuzzing found is refused or read") {
    for (const fs::path& folder : files_of(here / "found")) {
        if (!fs::is_directory(folder)) continue;
        const Target* target = find_target(folder.filename().string());
        INFO(folder);
        REQUIRE(target);
        // An empty one is that of a fuzzer at work, for what it may find.
        for (const fs::path& file : files_of(folder)) {
            INFO(file);
            CHECK_NOTHROW(target->run(bytes_of(file)));
        }
    }
}

TEST_CASE("every fuzz target takes the empty input, and knows its name") {
    std::set<std::string_view> names;
    for (const Target& target : all_targets()) {
        INFO(target.name);
        CHECK(names.insert(target.name).second);
        CHECK(find_target(target.name) == &target);
        CHECK_NOTHROW(target.run(""));
        CHECK_NOTHROW(target.run(std::string(1, '\0')));
    }
    CHECK(find_target("none") == nullptr);
}
