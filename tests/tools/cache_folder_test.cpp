// A cache folder that is full, spoiled, left by killed programs, or shared with files of others.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <tuple>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

struct Ran {
    int simulated = 0, reused = 0;
    std::string said;
};

Ran run(const std::string& graph, const fs::path& cache, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"run", graph, "--json", "--cache", cache.string()});
    const Said said = run_program(more);
    INFO(said.err);
    REQUIRE(said.code == 0);
    return {said.lines().back().at("frames_simulated"), said.lines().back().at("frames_reused"), said.out + said.err};
}

std::vector<fs::path> files(const fs::path& folder, const std::string& ending) {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ending) out.push_back(entry.path());
    return out;
}

/// Frames that explain says are there.
int valid_frames(const std::string& graph, const fs::path& cache) {
    const json told =
        run_program({"explain", graph, "solver.outMeshes", "--json", "--cache", cache.string()}).lines().at(0);
    int out = 0;
    for (const std::string range : told.at("valid_frames")) { // "1-4", "7", "none"
        if (range == "none") continue;
        const std::size_t dash = range.find('-');
        const int first = std::stoi(range);
        out += (dash == std::string::npos ? first : std::stoi(range.substr(dash + 1))) - first + 1;
    }
    return out;
}

int count(const std::string& text, const std::string& part) {
    int out = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++out;
    return out;
}

/// 40 frames that take some 2.9 MB.
std::string long_graph(const TemporaryFolder& folder) {
    json graph = small_graph();
    graph["timing"]["end"] = 40;
    graph["nodes"]["blockMesh"]["inputs"]["subdivisionsHeight"] = 40;
    return write_graph(folder, graph);
}

void age(const fs::path& file) { fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(72)); }

} // namespace

TEST_CASE("files of others in a cache folder stay, whatever their names and their age", "[tools]") {
    const TemporaryFolder folder;
    const fs::path cache = folder / "cache";
    fs::create_directories(cache);
    const std::string key(32, 'a');
    const std::vector<std::string> names{
        "shot1.frame", "foo.rows",        "render.warnings", "a.kept",
        ".frame",      key + "-b.rows",   key + "0.frame",   "A" + key.substr(1) + ".kept",
        "notes.txt",   ".x.frame.1-1.tmp"};
    for (const std::string& name : names) {
        std::ofstream(cache / name) << std::string(300'000, 'x');
        age(cache / name);
    }
    fs::create_symlink(folder / "elsewhere", cache / (key + ".kept"));
    run(long_graph(folder), cache, {"--cache-size", "1 MB"}); // room has to be made
    const json info = run_program({"cache", "info", cache.string(), "--json"}).lines().at(0);
    CHECK(info.at("bytes") <= 1'000'000);
    CHECK(info.at("frames") == files(cache, ".frame").size() - 2); // not those two
    CHECK(run_program({"cache", "clean", cache.string()}).code == 0);
    for (const std::string& name : names) {
        INFO(name);
        CHECK(fs::exists(cache / name));
    }
    CHECK(fs::is_symlink(cache / (key + ".kept")));
    CHECK(files(cache, ".frame").size() == 2);
}

TEST_CASE("a run that is larger than the cache finds again what fits", "[tools]") {
    const TemporaryFolder folder;
    const fs::path cache = folder / "cache";
    const std::string graph = long_graph(folder);
    const std::vector<std::string> size{"--cache-size", "2 MB"};
    CHECK(run(graph, cache, size).simulated == 40);
    const int there = static_cast<int>(files(cache, ".frame").size());
    CHECK(there > 10);
    CHECK(there < 38);
    CHECK(valid_frames(graph, cache) == there);
    const Ran again = run(graph, cache, size);
    CHECK(again.reused >= there - 4); // of those at the end, which go first, some went again
    CHECK(valid_frames(graph, cache) == static_cast<int>(files(cache, ".frame").size()));
    CHECK(run(graph, cache, size).reused == again.reused);
    CHECK(valid_frames(graph, cache) == static_cast<int>(files(cache, ".frame").size()));
    // What was reached last is there, so that a killed run goes on from it.
    CHECK(run(graph, cache, {"--cache-size", "2 MB", "--frames", "40-40"}).simulated == 0);
}

TEST_CASE("what is known of the inputs is kept again where it is gone or damaged", "[tools]") {
    const TemporaryFolder folder;
    const fs::path cache = folder / "cache";
    const std::string graph = write_graph(folder, small_graph());
    CHECK(run(graph, cache).simulated == 6);
    CHECK(valid_frames(graph, cache) == 6);
    for (const bool is_gone : {true, false}) {
        for (const fs::path& rows : files(cache, ".rows"))
            is_gone ? static_cast<void>(fs::remove(rows)) : fs::resize_file(rows, 20);
        CHECK(valid_frames(graph, cache) == 0);
        CHECK(run(graph, cache).reused == 6);
        CHECK(valid_frames(graph, cache) == 6);
    }
}

TEST_CASE("what killed programs left unfinished in a cache is removed when it is old, and counted before", "[tools]") {
    const TemporaryFolder folder;
    const fs::path cache = folder / "cache";
    const std::string graph = write_graph(folder, small_graph());
    run(graph, cache);
    const std::string key(32, 'b'), gone = std::to_string(1 << 30);
    const fs::path old = cache / ("." + key + ".frame." + gone + "-7.tmp"),
                   fresh = cache / ("." + key + ".kept." + gone + "-7.tmp"),
                   alive = cache / ("." + key + ".frame.1-1.tmp");
    const auto leave = [&] {
        for (const fs::path& file : {old, fresh, alive}) std::ofstream(file) << "half of a frame";
        age(old), age(alive);
    };
    leave();
    const auto bytes = [&] {
        return run_program({"cache", "info", cache.string(), "--json"}).lines().at(0).at("bytes").get<int>();
    };
    const int with = bytes();
    fs::remove(old);
    CHECK(bytes() == with - 15);
    leave();
    run(graph, cache, {"--set", "flesh.youngsModulus=12345"});
    CHECK_FALSE(fs::exists(old));
    CHECK((fs::exists(fresh) && fs::exists(alive)));
    leave();
    CHECK(run_program({"cache", "clean", cache.string()}).code == 0);
    CHECK_FALSE(fs::exists(old));
    CHECK((fs::exists(fresh) && fs::exists(alive)));
    age(fresh), fs::remove(alive);
    CHECK(run_program({"cache", "clean", cache.string()}).code == 0);
    CHECK_FALSE(fs::exists(cache));
}

TEST_CASE("damaged frames of one kind are told in one warning", "[tools]") {
    const TemporaryFolder folder;
    const fs::path cache = folder / "cache";
    const std::string graph = write_graph(folder, small_graph());
    run(graph, cache);
    const auto spoil = [&](auto&& how) {
        for (const fs::path& frame : files(cache, ".frame")) how(frame);
        return run(graph, cache);
    };
    const Ran cut = spoil([](const fs::path& frame) { fs::resize_file(frame, fs::file_size(frame) - 1); });
    CHECK(cut.simulated == 6);
    CHECK(count(cut.said, "IO406") == 1);
    CHECK(count(cut.said, "its length is wrong") == 1);
    CHECK(count(cut.said, "nothing to do: it is replaced, and so are others of which the same holds") == 1);
    CHECK(run(graph, cache).said.find("IO406") == std::string::npos);
}

TEST_CASE("explain tells frames of another processor's kernels from those that were never there", "[tools]") {
    const TemporaryFolder folder;
    const fs::path cache = folder / "cache";
    const std::string graph = write_graph(folder, small_graph());
    const auto why = [&] {
        return run_program({"explain", graph, "solver.outMeshes", "--frame", "3", "--json", "--cache", cache.string()})
            .lines()
            .at(0)
            .at("because")
            .get<std::string>();
    };
    const std::string others = "what is kept of frame 1 is of another build of Sinew, of another processor's kernels, "
                               "or of a run that differs before it";
    CHECK(why().find(others) == std::string::npos);
    const char* before = std::getenv("OPENBLAS_CORETYPE");
    const std::string kernel = before && std::string(before) == "Nehalem" ? "Sandybridge" : "Nehalem",
                      old = before ? before : "";
    setenv("OPENBLAS_CORETYPE", kernel.c_str(), 1);
    run(graph, cache);
    before ? setenv("OPENBLAS_CORETYPE", old.c_str(), 1) : unsetenv("OPENBLAS_CORETYPE");
    CHECK(why().find(others) != std::string::npos);
}
