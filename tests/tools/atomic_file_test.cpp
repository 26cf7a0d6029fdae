// Files are whole or not there at all.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/diagnostics.h"
#include "tests/tools/file_size_limit.h"
#include "tests/tools/temporary_folder.h"
#include "tools/cli/atomic_file.h"

#include <catch2/catch.hpp>
#include <thread>
#include <vector>

using namespace sinew;
using cli::write_file;
using test::FileSizeLimit;
namespace fs = std::filesystem;

namespace {

std::size_t entries(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

std::string code_of(const fs::path& path, const std::string& bytes) {
    try {
        write_file(path, bytes);
    } catch (const engine::Failure& e) {
        return e.diagnostics().front().code;
    }
    return "written";
}

} // namespace

TEST_CASE("a file is written with the folders that it needs", "[tools]") {
    const test::TemporaryFolder folder;
    write_file(folder / "a/b/c.txt", "hello");
    CHECK(test::read_text(folder / "a/b/c.txt") == "hello");
    CHECK(entries(folder / "a/b") == 1);
}

TEST_CASE("an older file is replaced as a whole", "[tools]") {
    const test::TemporaryFolder folder;
    write_file(folder / "x", std::string(100000, 'a'));
    write_file(folder / "x", "short");
    CHECK(test::read_text(folder / "x") == "short");
    CHECK(entries(folder.path()) == 1);
}

TEST_CASE("a write that fails half-way leaves the older file and nothing else", "[tools]") {
    const test::TemporaryFolder folder;
    write_file(folder / "x", "older");
    {
        const FileSizeLimit limit(4096);
        CHECK(code_of(folder / "x", std::string(1 << 20, 'n')) == "IO405");
        CHECK(code_of(folder / "y", std::string(1 << 20, 'n')) == "IO405");
    }
    CHECK(test::read_text(folder / "x") == "older");
    CHECK(entries(folder.path()) == 1);
}

TEST_CASE("a place that cannot be written to is named with its reason", "[tools]") {
    const test::TemporaryFolder folder;
    fs::create_directory(folder / "is_a_folder");
    CHECK(code_of(folder / "is_a_folder", "x") == "IO405");
    write_file(folder / "is_a_file", "x");
    CHECK(code_of(folder / "is_a_file/y", "x") == "IO405");
    CHECK(entries(folder.path()) == 2);
    CHECK(entries(folder / "is_a_folder") == 0);
}

TEST_CASE("writers of one file at the same time leave one whole file", "[tools]") {
    const test::TemporaryFolder folder;
    std::vector<std::thread> writers;
    for (char c = 'a'; c < 'e'; ++c)
        writers.emplace_back([&folder, c] {
            for (int i = 0; i < 20; ++i) write_file(folder / "x", std::string(20000, c));
        });
    for (std::thread& w : writers) w.join();
    const std::string text = test::read_text(folder / "x");
    CHECK(text == std::string(20000, text.front()));
    CHECK(entries(folder.path()) == 1);
}

TEST_CASE("a device stays a device, and a symbolic link stays a link to the new content", "[tools]") {
    const test::TemporaryFolder folder;
    write_file("/dev/null", "nothing");
    CHECK(fs::is_character_file("/dev/null"));
    test::write_text(folder / "real.txt", "old");
    fs::create_symlink("real.txt", folder / "link.txt");
    write_file(folder / "link.txt", "new");
    CHECK(fs::is_symlink(folder / "link.txt"));
    CHECK(test::read_text(folder / "real.txt") == "new");
}
