// Frames that an earlier run has left in the folder are told of, by the run and by what shows the folder.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// As if the folder's files had been written an hour ago.
void make_older(const fs::path& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            fs::last_write_time(entry.path(), fs::file_time_type::clock::now() - std::chrono::hours(1));
}

} // namespace

TEST_CASE("a shorter run of another graph tells of the frames that it leaves", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph()), out = (folder / "out").string();
    const auto run = [&](const std::string& frames, const std::vector<std::string>& more) {
        std::vector<std::string> words{"run", graph, "--no-cache", "--out", out, "--format", "obj", "--frames", frames};
        words.insert(words.end(), more.begin(), more.end());
        const Said said = run_program(words);
        CHECK(said.code == 0);
        return said;
    };
    const auto shown = [&](const char* command) {
        const Said said = run_program({command, out, "-o", (folder / "shown").string()});
        CHECK(said.code == 0);
        return said.err;
    };
    const std::vector<std::string> softer{"--quiet", "--set", "solver.gravity=[0, -5, 0]"};
    CHECK_FALSE(has(run("1-4", {}).err, "IO421"));
    make_older(folder / "out");
    // The same graph: ranges of one run that share a folder.
    CHECK_FALSE(has(run("5-6", {}).err, "IO421"));
    CHECK_FALSE(has(shown("snapshot"), "earlier run"));
    make_older(folder / "out");
    const std::string err = run("1-2", softer).err;
    CHECK(has(err, "warning [IO421] "));
    CHECK(has(err, "12 files of an earlier run, frames 3-6 of ")); // of three bodies
    for (const char* command : {"snapshot", "view"})
        CHECK(has(shown(command), "are from an earlier run of another graph"));
    // Frames of one run alone.
    CHECK_FALSE(
        has(run_program({"snapshot", out, "--frames", "3,5", "-o", (folder / "shown").string()}).err, "earlier run"));
    // In a program's words and in the report.
    const std::string report = (folder / "report.json").string();
    make_older(folder / "out");
    const Said told = run("1-2", {"--json", "--report", report, "--set", "solver.gravity=[0, -4, 0]"});
    bool is_told = false;
    for (const json& line : told.lines()) is_told = is_told || line.value("code", "") == "IO421";
    CHECK(is_told);
    const json warnings = json::parse(read_text(report)).at("warnings");
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].at("code") == "IO421");
    // Whose they are is read from the files: it does not take a second to know.
    const std::vector<std::string> lighter{"--quiet", "--set", "solver.gravity=[0, -6, 0]"};
    CHECK_FALSE(has(run("1-6", softer).err, "IO421"));
    CHECK(has(run("1-2", lighter).err, "12 files of an earlier run, frames 3-6 of "));
}
