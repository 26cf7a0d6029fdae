// Never a frame twice: what a later process finds of the frames that an earlier one simulated, or was killed over.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

struct Ran {
    std::vector<std::string> digests;
    int simulated = 0, reused = 0;
    std::string said;
};

Ran read(const Said& said) {
    Ran out;
    out.said = said.out + said.err;
    INFO(said.err);
    REQUIRE(said.code == 0);
    for (const json& line : said.lines())
        if (line.at("event") == "frame") out.digests.push_back(line.at("digest"));
    out.simulated = said.lines().back().at("frames_simulated");
    out.reused = said.lines().back().at("frames_reused");
    return out;
}

Ran run(const std::string& graph, const fs::path& cache, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"run", graph, "--json"};
    if (cache.empty())
        words.emplace_back("--no-cache");
    else
        words.insert(words.end(), {"--cache", cache.string()});
    words.insert(words.end(), more.begin(), more.end());
    return read(run_program(words));
}

std::vector<fs::path> files(const fs::path& folder, const std::string& ending) {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ending) out.push_back(entry.path());
    return out;
}

std::uintmax_t size_of(const fs::path& folder) {
    std::uintmax_t sum = 0;
    for (const auto& entry : fs::directory_iterator(folder)) sum += entry.file_size();
    return sum;
}

} // namespace

TEST_CASE("a second run simulates nothing and gives the same bits", "[tools]") {
    for (const char* scheme : {"BackwardEuler", "BDF2", "TR-BDF2", "QuasiStatic"}) {
        const TemporaryFolder folder;
        const std::string graph = write_graph(folder, small_graph());
        const std::vector<std::string> set{"--set", "solver.integrator=" + std::string(scheme)};
        const auto with_out = [&](const std::string& name) {
            std::vector<std::string> words = set;
            words.insert(words.end(), {"--out", (folder / name).string(), "--format", "obj"});
            return words;
        };
        const Ran alone = run(graph, {}, set);
        const Ran first = run(graph, folder / "cache", with_out("a")),
                  second = run(graph, folder / "cache", with_out("b"));
        INFO(scheme);
        CHECK((first.simulated == 6 && first.reused == 0));
        CHECK((second.simulated == 0 && second.reused == 6));
        CHECK(first.digests == alone.digests);
        CHECK(second.digests == alone.digests);
        CHECK(files(folder / "cache", ".frame").size() == 6);
        int compared = 0;
        for (const auto& entry : fs::recursive_directory_iterator(folder / "a"))
            if (entry.is_regular_file()) {
                CHECK(read_text(entry.path()) == read_text(folder / "b" / fs::relative(entry.path(), folder / "a")));
                ++compared;
            }
        CHECK(compared == 18);
        // Going on from a state on disk: bits of a run in one piece.
        REQUIRE(run(graph, folder / "half", {"--set", set[1], "--frames", "1-4"}).simulated == 4);
        const Ran rest = run(graph, folder / "half", set);
        CHECK((rest.simulated == 2 && rest.reused == 4));
        CHECK(rest.digests == alone.digests);
    }
}

TEST_CASE("a key that changes simulates again from its frame on, and explain names it", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    auto& modulus = graph["nodes"]["flesh"]["inputs"]["youngsModulus"];
    modulus = json::parse(R"({"keys": [[1, 20000], [4, 20000], [5, 20000], [6, 20000]], "interp": "step"})");
    const std::string file = write_graph(folder, graph);
    const Ran before = run(file, folder / "cache");
    REQUIRE(before.simulated == 6);
    modulus["keys"][2][1] = 30000;
    write_graph(folder, graph);
    const json why = run_program({"explain", file, "solver.outMeshes", "--frame", "6", "--json", "--cache",
                                  (folder / "cache").string()})
                         .lines()
                         .at(0);
    CHECK(why.at("readiness") == "would run");
    CHECK(why.at("changed_plugs") == json::array({"flesh.youngsModulus"}));
    CHECK(why.at("because").get<std::string>().find("would be simulated, unless what differs comes to the same for "
                                                    "solver; what is kept of frame 5 differs in") != std::string::npos);
    CHECK(why.at("steps").at("first_frame") == 5);
    CHECK(why.at("steps").at("last_frame") == 6);
    CHECK(why.at("valid_frames") == json::array({"1-4"}));
    const Ran after = run(file, folder / "cache");
    CHECK((after.simulated == 2 && after.reused == 4));
    CHECK(after.digests == run(file, {}).digests);
    CHECK(after.digests[3] == before.digests[3]);
    CHECK(after.digests[4] != before.digests[4]);
    // An input of the solver's own is named as well.
    const std::string keyed = R"(solver.gravity={"keys": [[1, [0, -9.8, 0]], [3, [0, -9.8, 0]], [4, [0, -5, 0]]],
                                 "interp": "step"})";
    for (const auto& [input, changed, first] :
         {std::tuple{keyed, "solver.gravity", 4}, {std::string("solver.substeps=2"), "solver.substeps", 1}}) {
        const json own = run_program({"explain", file, "solver.outMeshes", "--frame", "6", "--json", "--set", input,
                                      "--cache", (folder / "cache").string()})
                             .lines()
                             .at(0);
        CAPTURE(own.dump());
        CHECK(own.at("changed_plugs") == json::array({changed}));
        CHECK(own.at("steps").at("first_frame") == first);
    }
    // Of several that are kept the one is compared with that differs least, not the one that came last.
    const std::vector<std::string> two{"--set", "solver.substeps=2", "--set", "solver.gravity=[0, -1, 0]"};
    CHECK(run(file, folder / "cache", two).simulated == 6);
    const json least = run_program({"explain", file, "solver.outMeshes", "--frame", "6", "--json", "--set",
                                    "solver.substeps=3", "--cache", (folder / "cache").string()})
                           .lines()
                           .at(0);
    CAPTURE(least.dump());
    CHECK(least.at("changed_plugs") == json::array({"solver.substeps"}));
    CHECK(least.at("because").get<std::string>().find("what is kept of frame 2 differs in solver.substeps; ") !=
          std::string::npos);
    // And back: the frames of before are still there.
    modulus["keys"][2][1] = 20000;
    write_graph(folder, graph);
    const Ran back = run(file, folder / "cache");
    CHECK((back.simulated == 0 && back.reused == 6 && back.digests == before.digests));
    // What is only looked at changes nothing.
    CHECK(run(file, folder / "cache", {"--set", "block.appearance=fat", "--set", "block.colour=[0, 0, 1]"}).simulated ==
          0);
}

TEST_CASE("outputs that are not kept are made from the kept states", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["rider"] = {
        {"type", "zEmbedder"},
        {"inputs", {{"solved", {{"from", "solver.outSolved"}}}, {"body", {{"from", "block.outBody"}}}}}};
    const std::string file = write_graph(folder, graph);
    const std::vector<std::string> pull{"--pull", "rider.outMeshes"};
    const Ran alone = run(file, {}, pull);
    CHECK(run(file, folder / "cache").simulated == 6);
    const Ran riding = run(file, folder / "cache", pull);
    CHECK(riding.simulated == 0);
    CHECK(riding.digests == alone.digests);
}

TEST_CASE("a killed run leaves its frames, and the next one goes on bit for bit", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["timing"]["end"] = 60;
    const std::string file = write_graph(folder, graph);
    const std::vector<std::string> whole = run(file, {}).digests;
    REQUIRE(whole.size() == 60);
    const fs::path cache = folder / "cache";
    int there = 0;
    for (int kills = 0; kills < 5; ++kills) {
        {
            const Program program({"run", file, "--cache", cache.string(), "--quiet"});
            const int wanted = there + 4 + 3 * kills;
            for (int waited = 0; waited < 60000; ++waited) { // an instrumented program takes long
                if (fs::exists(cache) && static_cast<int>(files(cache, ".frame").size()) >= wanted) break;
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            program.signal(SIGKILL);
        }
        const int now = static_cast<int>(files(cache, ".frame").size());
        CHECK(now > there);
        there = now;
    }
    const Ran last = run(file, cache);
    CHECK(last.digests == whole);
    CHECK(last.reused >= there - 1); // the one that was being written may not have become one
    CHECK(last.simulated == 60 - last.reused);
    for (const auto& entry : fs::directory_iterator(cache)) {
        const std::string ending = entry.path().extension();
        CHECK((ending == ".frame" || ending == ".rows" || ending == ".warnings"));
    }
}

TEST_CASE("a later run goes on bit for bit where a bone's mesh moves or grows", "[tools]") {
    // A muscle on a bone that grows and moves through its mesh: tied, sliding over a painted part, or in contact.
    const auto graph = [](const std::string& mode) {
        json g = json::parse(R"({"format": "sinew 1", "timing": {"start": 1, "end": 5, "fps": 24}, "nodes": {
            "boneMesh": {"type": "polyCube", "inputs": {"width": 4, "height": 1, "depth": 2, "subdivisionsWidth": 4, "subdivisionsDepth": 2}},
            "grows": {"type": "transform", "inputs": {"mesh": {"from": "boneMesh.outMesh"},
                "scale": {"keys": [[1, [1, 1, 1]], [5, [1.3, 1.1, 1.3]]]}, "translate": {"keys": [[1, [0, 0, 0]], [5, [0.3, 0.05, 0]]]}}},
            "bone": {"type": "zBone", "inputs": {"mesh": {"from": "grows.outMesh"}, "contactStiffness": 1e7}},
            "fleshMesh": {"type": "polyCube", "inputs": {"width": 3.9, "height": 0.8, "depth": 1.9, "subdivisionsWidth": 4, "subdivisionsHeight": 2, "subdivisionsDepth": 2}},
            "over": {"type": "transform", "inputs": {"mesh": {"from": "fleshMesh.outMesh"}, "translate": [0, 0.92, 0]}},
            "tets": {"type": "zTet", "inputs": {"mesh": {"from": "over.outMesh"}, "tetSize": 0.7}},
            "matter": {"type": "zMaterial"},
            "flesh": {"type": "zTissue", "inputs": {"mesh": {"from": "over.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "matter.outMaterial"}]}},
            "tie": {"type": "zAttachment", "inputs": {"source": {"from": "flesh.outBody"}, "target": {"from": "bone.outBody"}, "stiffness": 1e6}},
            "solver": {"type": "zSolver", "inputs": {"scale": 100, "bodies": [{"from": "bone.outBody"}, {"from": "flesh.outBody"}]}}}})");
        json& solver = g["nodes"]["solver"]["inputs"];
        if (mode == "contact")
            solver["collisionDetection"] = true, g["nodes"].erase("tie");
        else
            g["nodes"]["tie"]["inputs"]["attachmentMode"] = mode,
            solver["attachments"] = {{{"from", "tie.outAttachment"}}};
        if (mode == "sliding") {
            g["nodes"]["part"] = json::parse(
                R"({"type": "weights", "inputs": {"mesh": {"from": "boneMesh.outMesh"}, "mode": "ramp", "axis": "x", "start": 1.2, "end": 0.8}})");
            g["nodes"]["tie"]["inputs"]["targetWeights"] = {{"from", "part.outWeights"}};
        }
        return g;
    };
    for (const char* mode : {"fixed", "sliding", "contact"}) {
        INFO(mode);
        const TemporaryFolder folder;
        const std::string file = write_graph(folder, graph(mode));
        const Ran alone = run(file, {});
        run(file, folder / "cache", {"--frames", "1-3"});
        const Ran later = run(file, folder / "cache");
        CHECK((later.reused == 3 && later.simulated == 2));
        CHECK(later.digests == alone.digests);
    }
}

TEST_CASE("damaged frames are told once and made anew", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = write_graph(folder, small_graph());
    const fs::path cache = folder / "cache";
    const Ran whole = run(file, cache);
    std::size_t spoiled = 0;
    for (const fs::path& frame : files(cache, ".frame")) {
        std::string bytes = read_text(frame);
        if (spoiled == 0) bytes.resize(bytes.size() / 2);
        if (spoiled == 1) bytes[200] ^= 1; // of what it tells
        if (spoiled == 2) bytes.clear();
        if (++spoiled > 3) continue;
        std::ofstream(frame, std::ios::binary | std::ios::trunc) << bytes;
    }
    const Ran mended = run(file, cache);
    CHECK(mended.digests == whole.digests);
    CHECK(mended.said.find("IO406") != std::string::npos);
    CHECK(mended.simulated >= 3);
    const Ran again = run(file, cache);
    CHECK(again.said.find("IO406") == std::string::npos);
    CHECK(again.digests == whole.digests);
    // Rows that end in the middle of one.
    for (const fs::path& rows : files(cache, ".rows")) fs::resize_file(rows, fs::file_size(rows) - 5);
    CHECK(run(file, cache).digests == whole.digests);
}

TEST_CASE("a damaged state is missed only by who goes on from it", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = write_graph(folder, small_graph());
    const Ran whole = run(file, {});
    const fs::path cache = folder / "cache";
    run(file, cache, {"--frames", "1-4"});
    std::vector<fs::path> frames = files(cache, ".frame");
    REQUIRE(frames.size() == 4);
    // The start's, which is the largest, is used with each; of the others the last counts as used longest ago.
    std::sort(frames.begin(), frames.end(),
              [](const fs::path& a, const fs::path& b) { return fs::file_size(a) > fs::file_size(b); });
    std::sort(frames.begin() + 1, frames.end(),
              [](const fs::path& a, const fs::path& b) { return fs::last_write_time(a) > fs::last_write_time(b); });
    std::string bytes = read_text(frames.back());
    bytes.back() ^= 1;
    std::ofstream(frames.back(), std::ios::binary | std::ios::trunc) << bytes;
    const Ran shown = run(file, cache, {"--frames", "1-4"});
    CHECK((shown.reused == 4 && shown.said.find("IO406") == std::string::npos));
    const Ran later = run(file, cache);
    CHECK(later.said.find("IO406") != std::string::npos);
    CHECK(later.simulated == 3);
    CHECK(later.digests == whole.digests);
}

TEST_CASE("a run whose frames are all there makes nothing again, and says what the first one said", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    // Points of the flesh lie beside the tets, which zTissue tells; nothing holds the second block, which is doubted.
    graph["nodes"]["tets"] =
        json::parse(R"({"type": "zTet", "inputs": {"mesh": {"from": "inner.outMesh"}, "tetSize": 1}})");
    graph["nodes"]["inner"] = json::parse(R"({"type": "polyCube", "inputs": {"width": 2, "height": 7, "depth": 2}})");
    graph["nodes"]["block"]["inputs"]["tets"] = {{"from", "tets.outTets"}};
    graph["nodes"]["loose"] = json::parse(
        R"({"type": "zTissue", "inputs": {"mesh": {"from": "blockMesh.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}})");
    graph["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", "loose.outBody"}});
    // A sheet whose edges would crumple.
    graph["nodes"]["sheetMesh"] = json::parse(R"({"type": "polyPlane", "inputs": {"width": 2, "height": 2}})");
    graph["nodes"]["taut"] =
        json::parse(R"({"type": "zMaterial", "inputs": {"shearStiffness": 10, "surfaceTension": 11}})");
    graph["nodes"]["sheet"] = json::parse(
        R"({"type": "zCloth", "inputs": {"mesh": {"from": "sheetMesh.outMesh"}, "materials": [{"from": "taut.outMaterial"}]}})");
    graph["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", "sheet.outBody"}});
    const std::string file = write_graph(folder, graph);
    const fs::path cache = folder / "cache", report = folder / "report.json";
    const auto look = [&](const std::vector<std::string>& more = {}) {
        std::vector<std::string> words{"--report", report.string()};
        words.insert(words.end(), more.begin(), more.end());
        run(file, cache, words);
        const json told = json::parse(read_text(report));
        std::vector<std::string> warnings;
        for (const json& w : told.at("warnings")) warnings.push_back(w.dump());
        std::sort(warnings.begin(), warnings.end());
        return std::pair(told.at("computed").size(), warnings);
    };
    const auto [computed, said] = look();
    CHECK(computed > 5);
    const auto has = [&](const char* code) {
        return std::any_of(said.begin(), said.end(), [&](const std::string& w) { return w.find(code) != w.npos; });
    };
    CHECK((has("FE260") && has("FE246") && has("FE316")));
    CHECK(look() == std::pair(std::size_t{0}, said));
    // Another value is looked at anew, and so is the graph where its file has changed.
    CHECK(look({"--set", "flesh.youngsModulus=30kPa"}).first > 0);
    CHECK(look() == std::pair(std::size_t{0}, said));
    fs::last_write_time(file, fs::last_write_time(file) + std::chrono::seconds(5));
    CHECK(look().first > 0);
    CHECK(look() == std::pair(std::size_t{0}, said));
    // Damaged, it is found anew.
    for (const fs::path& kept : files(cache, ".warnings")) std::ofstream(kept, std::ios::trunc) << "x";
    CHECK(look().second == said);
}

TEST_CASE("a folder that frames cannot be written to is told once", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = write_graph(folder, small_graph());
    std::ofstream(folder / "file") << "not a folder";
    const Ran said = run(file, folder / "file");
    CHECK(said.digests == run(file, {}).digests);
    const std::size_t at = said.said.find("IO407");
    REQUIRE(at != std::string::npos);
    CHECK(said.said.find("IO407", at + 1) == std::string::npos);
    for (const fs::path& within : {folder / "file", folder / "file" / "more" / "of it"}) {
        const Said told = run_program({"run", file, "--cache", within});
        INFO(told.err);
        CHECK(told.err.find("no frames are kept on disk: '" + (folder / "file").string() +
                            "' is a file, but a folder is needed\n  hint: name a folder by --cache\n") !=
              std::string::npos);
    }
    // As the folder beside a graph is called whose own name is just not too long.
    const std::string name(246, 'g');
    const Said told = run_program({"run", file, "--cache", (folder / (name + ".sinew-cache")).string()});
    CHECK(told.code == 0);
    CHECK(told.err.find("the name of the folder '" + (folder / (name + ".sinew-cache")).string() +
                        "' is longer than 255 bytes\n  hint: name a folder by --cache\n") != std::string::npos);
}

TEST_CASE("two processes share a folder", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["timing"]["end"] = 30;
    const std::string file = write_graph(folder, graph);
    const std::string cache = (folder / "cache").string();
    Program one({"run", file, "--json", "--cache", cache}), two({"run", file, "--json", "--cache", cache});
    const int code_one = one.exit_code(), code_two = two.exit_code();
    const Ran a = read({code_one, one.out(), one.err()}), b = read({code_two, two.out(), two.err()});
    CHECK(a.digests == b.digests);
    CHECK(run(file, cache).simulated == 0);
}

TEST_CASE("frames that are more than the cache may take are not kept, nor told as damaged", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["blockMesh"]["inputs"]["subdivisionsHeight"] = 1500;
    const std::string file = write_graph(folder, graph);
    const fs::path cache = folder / "cache", large = folder / "large";
    const Ran whole = run(file, large);
    std::uintmax_t start = 0;
    for (const fs::path& frame : files(large, ".frame")) start = std::max(start, fs::file_size(frame));
    CHECK(start > 1'000'000);
    for (int time = 0; time < 2; ++time) {
        const Ran small = run(file, cache, {"--cache-size", "1 MB"});
        CHECK(small.digests == whole.digests);
        CHECK(small.said.find("IO406") == std::string::npos);
        CHECK(size_of(cache) <= 1'000'000);
    }
}

TEST_CASE("the cache keeps to its size where a frame is a good part of it", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["timing"]["end"] = 12;
    graph["nodes"]["tets"] = {{"type", "zTet"},
                              {"inputs", {{"mesh", {{"from", "blockMesh.outMesh"}}}, {"tetSize", 0.8}}}};
    graph["nodes"]["block"]["inputs"]["tets"] = {{"from", "tets.outTets"}};
    const std::string file = write_graph(folder, graph);
    const fs::path cache = folder / "cache";
    run(file, cache, {"--cache-size", "1 MB"});
    std::uintmax_t largest = 0;
    for (const fs::path& frame : files(cache, ".frame")) largest = std::max(largest, fs::file_size(frame));
    CHECK(largest > 200'000);
    CHECK(size_of(cache) <= 1'000'000);
    CHECK(size_of(cache) > 500'000);
}

TEST_CASE("the cache keeps to its size, says what it holds, and is cleaned", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["timing"]["end"] = 40;
    graph["nodes"]["blockMesh"]["inputs"]["subdivisionsHeight"] = 40;
    const std::string file = write_graph(folder, graph);
    const fs::path cache = folder / "cache";
    const Ran whole = run(file, {}), small = run(file, cache, {"--cache-size", "1 MB"});
    CHECK(small.digests == whole.digests);
    CHECK(size_of(cache) <= 1'000'000);
    CHECK(size_of(cache) > 500'000);
    const std::size_t kept = files(cache, ".frame").size();
    CHECK(kept < 40);
    CHECK(run(file, cache, {"--cache-size", "1 MB"}).digests == whole.digests);
    CHECK(run_program({"run", file, "--cache-size", "nothing"}).code == 2);

    run(file, folder / "all");
    const json info = run_program({"cache", "info", (folder / "all").string(), "--json"}).lines().at(0);
    CHECK(info.at("frames") == 40);
    CHECK(info.at("bytes") == size_of(folder / "all"));
    std::ofstream(folder / "all/mine.txt") << "of somebody else";
    CHECK(run_program({"cache", "clean", (folder / "all").string()}).code == 0);
    CHECK(fs::exists(folder / "all/mine.txt"));
    CHECK(files(folder / "all", ".frame").empty());
    CHECK(run_program({"cache", "clean", cache.string()}).code == 0);
    CHECK_FALSE(fs::exists(cache));
    CHECK(run_program({"cache", "info", file}).out.find("nothing is kept") != std::string::npos);
    CHECK(run_program({"cache", "empty", file}).code == 2);
    CHECK(run_program({"cache", "info", (folder / "nowhere").string()}).code == 2);
}
