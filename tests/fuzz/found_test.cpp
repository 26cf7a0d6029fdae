// What fuzzing found, and what it begins with, goes through the readers again: refused with words, or read.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/targets/targets.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
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

/// Of a pack as kept_inputs.py writes it.
std::vector<std::string_view> inputs_in(std::string_view pack) {
    std::vector<std::string_view> out;
    while (!pack.empty()) {
        std::uint64_t length = 0;
        REQUIRE(pack.size() >= sizeof length);
        std::memcpy(&length, pack.data(), sizeof length);
        pack.remove_prefix(sizeof length);
        REQUIRE(pack.size() >= length);
        out.push_back(pack.substr(0, length));
        pack.remove_prefix(length);
    }
    return out;
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

TEST_CASE("what fuzzing has grown is refused or read") {
    std::size_t packs = 0;
    for (const Target& target : all_targets()) {
        const std::string pack = bytes_of(here / "corpus" / (std::string(target.name) + ".pack"));
        packs += !pack.empty();
        std::size_t number = 0;
        for (const std::string_view input : inputs_in(pack)) {
            INFO(target.name << ", input " << number++);
            CHECK_NOTHROW(target.run(input));
        }
    }
    CHECK(packs == all_targets().size());
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
