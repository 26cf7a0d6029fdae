// Runs of many frames: memory that stays within --memory, animations that are too large, what a killed run leaves, and
// motion that ends before the run does.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/glb_checker.h"
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <set>
#include <thread>

using namespace sinew::test;
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

std::set<std::string> names_in(const fs::path& folder) {
    std::set<std::string> out;
    if (fs::is_directory(folder))
        for (const auto& entry : fs::directory_iterator(folder)) out.insert(entry.path().filename().string());
    return out;
}

/// The small graph, its plate to and fro over so many frames.
json looped(int frames) {
    json graph = small_graph();
    graph["timing"]["end"] = frames;
    json& inputs = graph["nodes"]["upperMove"]["inputs"];
    inputs["translate"]["keys"] = json::array();
    inputs.erase("rotate");
    for (int f = 1, i = 0; f <= frames + 5; f += 5, ++i)
        inputs["translate"]["keys"].push_back({f, {0, i % 2 ? 4.7 : 4.5, 0}});
    return graph;
}

std::string said_of(const Said& said) {
    std::string out;
    for (const json& d : said.lines())
        if (d.at("event") == "diagnostic")
            out += d.at("code").get<std::string>() + " " + d.value("node", "") + "." + d.value("attribute", "") + ": " +
                   d.at("message").get<std::string>() + " | " + d.value("hint", "") + "\n";
    return out;
}

} // namespace

TEST_CASE("a run within --memory keeps to it, simulates nothing twice and gives the same bits", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, looped(150));
    const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
        const std::string out = (folder / name).string();
        std::vector<std::string> words{"run", graph, "--out", out, "--report", out + "/r.json", "--open", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const Said said = run_program(words);
        INFO(said.err);
        CHECK(said.code == 0);
        CHECK(said_of(said).empty());
        std::vector<std::string> digests;
        for (const json& line : said.lines())
            if (line.at("event") == "frame") digests.push_back(line.at("digest"));
        CHECK(digests.size() == 150);
        return std::pair(digests, json::parse(read_text(out + "/r.json")).at("totals"));
    };
    const auto [usual, all] = run("usual", {});
    const auto [tight, few] = run("tight", {"--memory", "1 MB"});
    CHECK(usual == tight);
    CHECK(all.at("kept_bytes") > 1'500'000); // or the budget would not be felt
    CHECK(few.at("memory_bytes") == 1'000'000);
    CHECK(few.at("kept_bytes") <= 1'000'000);
    CHECK(few.at("kept_bytes") > 500'000);
    CHECK(few.at("frames_simulated") == all.at("frames_simulated"));
    CHECK(few.at("made_again") == 0);
    CHECK(read_text(folder / "usual/small.glb") == read_text(folder / "tight/small.glb"));
}

TEST_CASE("the option --memory takes sizes with a unit and says exactly what is wrong with others", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    for (const char* good : {"500MB", "2 GB", "1.5gib", "3000kB", "2097152 B"})
        CHECK(run_program({"eval", graph, "plateMesh.outMesh", "--memory", good}).code == 0);
    for (const char* bad : {"2", "GB", "", "two GB", "-3 GB", "1e400 GB", "1..2GB", "5 miles"}) {
        const Said said = run_program({"eval", graph, "plateMesh.outMesh", "--memory", bad});
        CHECK(said.code == 2);
        CHECK(said.err.find("--memory needs a size with its unit, for example 500MB or \"2 GB\", not '" +
                            std::string(bad) + "'.") != std::string::npos);
    }
    CHECK(run_program({"run", graph, "--memory", "999 kB"}).err.find("--memory needs at least 1 MB, not '999 kB'.") !=
          std::string::npos);
    const Said large = run_program({"run", graph, "--memory", "9000 TB"});
    CHECK(large.code == 2);
    CHECK(large.err.find("--memory 9000 TB is more than there is: ") != std::string::npos);
    fs::create_directory(folder / "out");
    CHECK(run_program({"view", (folder / "out").string(), "--memory", "2 GB"}).code == 2);
    for (const char* command : {"run", "eval", "check", "view", "snapshot"})
        CHECK(run_program({command, "--help"}).out.find("--memory SIZE") != std::string::npos);
}

TEST_CASE("an animation that no GLB can hold is refused before the first step and before anything is written",
          "[tools]") {
    const TemporaryFolder folder;
    const std::string out = (folder / "out").string();
    // 40,000 frames: a table of 40,000 times 39,999 weights is 6.4 GB by itself.
    const Said said = run_program({"run", write_graph(folder, looped(40000)), "--out", out, "--json"});
    CHECK(said.code == 1);
    const std::string text = said_of(said);
    CHECK(text.starts_with("IO405 .: the animation of 40000 frames needs "));
    CHECK(text.find(", and a GLB file cannot hold more than 4.3 GB | at most 3") != std::string::npos);
    CHECK_FALSE(fs::exists(out));
    for (const json& line : said.lines()) CHECK(line.at("event") != "frame");
    // As meshes it could be written, and without --out nothing is.
    CHECK(run_program({"run", write_graph(folder, looped(5)), "--out", out, "--format", "obj"}).code == 0);
}

TEST_CASE("a body that turns out to deform and then no longer fits ends the run there", "[tools]") {
    const TemporaryFolder folder;
    json graph = looped(40000);
    graph["nodes"]["carried"] = {{"type", "zEmbedder"},
                                 {"inputs",
                                  {{"solved", {{"from", "solver.outSolved"}}},
                                   {"body", {{"from", "block.outBody"}}},
                                   {"meshes", json::array({{{"from", "blockMesh.outMesh"}}})}}}};
    const std::string out = (folder / "out").string();
    const Said said = run_program(
        {"run", write_graph(folder, graph), "--pull", "carried.outMeshes", "--out", out, "--report", out + "/r.json"});
    INFO(said.err);
    CHECK(said.code == 1);
    CHECK(said.err.find("the animation of 40000 frames needs") != std::string::npos);
    const json report = json::parse(read_text(out + "/r.json"));
    CHECK(report.at("error").at("code") == "IO405");
    CHECK(report.at("error").at("frame") < 5);
    CHECK(Glb(read_text(folder / "out/small.glb")).problems().empty()); // of the frames so far
}

TEST_CASE("a run that is killed leaves its mark alone, and the next one takes what others have left", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, looped(20000)), out = (folder / "out").string();
    {
        Program program({"run", graph, "--out", out, "--format", "glb,obj"});
        for (int waited = 0; waited < 12000 && names_in(folder / "out/obj").size() < 9; ++waited)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        program.signal(SIGKILL);
        CHECK(program.exit_code() == -1 - SIGKILL);
    }
    CHECK(names_in(out) == std::set<std::string>{"obj", "unfinished.0001.json"});
    // Where files cannot be without a name, a temporary one stays. Processes of this number there are none.
    const std::string gone = ".small.glb.2147483000-7.tmp", fresh = ".small.glb.2147483001-7.tmp",
                      alive = ".small.glb." + std::to_string(getpid()) + "-7.tmp", other = ".else.glb.2147483000-7.tmp";
    for (const std::string& name : {gone, fresh, alive, other}) {
        write_text(folder / ("out/" + name), "half");
        if (name != fresh)
            fs::last_write_time(folder / ("out/" + name), fs::file_time_type::clock::now() - std::chrono::hours(2));
    }
    CHECK(run_program({"run", graph, "--out", out, "--frames", "1-3"}).code == 0);
    const std::set<std::string> left = names_in(out);
    CHECK(left.contains("small.glb"));
    CHECK_FALSE(left.contains(gone));
    for (const std::string& name : {fresh, alive, other}) CHECK(left.contains(name));
}

TEST_CASE("keyed motion that does not reach over the run is warned about", "[tools]") {
    const TemporaryFolder folder;
    const auto check = [&](const json& translate, int last = 6) {
        json graph = small_graph();
        graph["timing"]["end"] = last;
        graph["nodes"]["upperMove"]["inputs"].erase("rotate");
        graph["nodes"]["upperMove"]["inputs"]["translate"] = translate;
        return said_of(run_program({"check", write_graph(folder, graph), "--json"}));
    };
    const auto keys = [](std::initializer_list<std::pair<double, double>> all) {
        json out = {{"keys", json::array()}};
        for (const auto& [frame, y] : all) out["keys"].push_back({frame, {0, y, 0}});
        return out;
    };
    CHECK(check(keys({{1, 4.5}, {6, 4.7}})).empty());
    CHECK(check(keys({{1, 4.5}, {6, 4.7}}), 7) ==
          "FE266 upperMove.translate: the keyed motion ends at frame 6, the run at frame 7; in between it stands still "
          "| key what it does up to frame 7, the same value again where it is to hold, or run other frames\n");
    CHECK(check(keys({{1, 4.5}, {5.5, 4.7}})).empty()); // less than a frame
    CHECK(check(keys({{3, 4.5}, {6, 4.7}})) ==
          "FE266 upperMove.translate: the keyed motion begins at frame 3, the run at frame 1; in between it stands "
          "still | key what it does up to frame 1, the same value again where it is to hold, or run other frames\n");
    CHECK(
        check(keys({{2, 4.5}, {3, 4.6}, {4.5, 4.7}}))
            .starts_with("FE266 upperMove.translate: the keyed motion lasts from frame 2 to 4.5, the run from 1 to 6; "
                         "before and after it stands still |"));
    // What never changes, what says that it holds, and steps, which hold by nature.
    CHECK(check(keys({{2, 4.5}})).empty());
    CHECK(check(keys({{2, 4.5}, {3, 4.5}})).empty());
    CHECK(check(keys({{2, 4.5}, {3, 4.5}, {4, 4.7}, {5, 4.7}})).empty());
    json steps = keys({{2, 4.5}, {4, 4.7}});
    steps["interp"] = "step";
    CHECK(check(steps).empty());
}

TEST_CASE("keyed numbers are warned about where the run goes beyond the timing that they were keyed for", "[tools]") {
    const TemporaryFolder folder;
    json graph = looped(20);
    graph["timing"]["end"] = 6;
    graph["nodes"]["holdTop"]["inputs"]["envelope"] = {{"keys", {{1, 0.5}, {6, 1}}}};
    const auto said = [&](const std::string& frames) {
        return said_of(run_program({"run", write_graph(folder, graph), "--frames", frames, "--json"}));
    };
    CHECK(said("1-6").empty());
    CHECK(said("1-9").starts_with("FE333 .: frames 7-9 lie outside of the graph's timing, 1 to 6: "));
    CHECK(said("1-9").find("\nFE266 holdTop.envelope: the keyed value ends at frame 6, the run at frame 9") !=
          std::string::npos);
    graph["nodes"]["holdTop"]["inputs"]["envelope"] = {{"keys", {{1, 0.5}, {4, 1}}}}; // on, and left so
    CHECK(said("1-9").find("FE266") == std::string::npos);
}

TEST_CASE("keys of which the timing has none are warned about", "[tools]") {
    const TemporaryFolder folder;
    json graph = looped(20);
    graph["timing"]["end"] = 6;
    const auto said = [&](const json& keys) {
        graph["nodes"]["holdTop"]["inputs"]["envelope"] = {{"keys", keys}};
        return said_of(run_program({"check", write_graph(folder, graph), "--json"}));
    };
    CHECK(
        said({{100, 0.5}, {120, 1}}) ==
        "FE266 holdTop.envelope: the keyed value lasts from frame 100 to 120, the graph's timing from 1 to 6: it stays "
        "as it is at its first key throughout | move the keys to the frames of the timing, or set timing.start and "
        "timing.end to theirs\n");
    CHECK(said({{-9, 0.5}, {0, 1}})
              .find("from frame -9 to 0, the graph's timing from 1 to 6: it stays as it is at its "
                    "last key throughout | ") != std::string::npos);
    CHECK(said({{6, 0.5}, {12, 1}}).empty()); // it begins where the timing ends
    // A run-up is simulated, so keys act there.
    graph["nodes"]["solver"]["inputs"]["startFrame"] = -9;
    CHECK(said({{-9, 0.5}, {0, 1}})
              .starts_with("DG031 solver.startFrame: -9 differs from the graph's timing.start, 1: 10 frames before the "
                           "graph's first are simulated too | leave it out to take the graph's, unless they are meant "
                           "as a run-up to it\n"));
    CHECK(said({{-9, 0.5}, {0, 1}}).find("FE266") == std::string::npos);
    const json moves = graph["nodes"]["upperMove"];
    graph["nodes"]["upperMove"]["inputs"]["translate"] = {{"keys", {{-9, {0, 3, 0}}, {0, {0, 0, 0}}}}};
    CHECK(said({{-9, 0.5}, {0, 1}}).find("FE266") == std::string::npos);
    CHECK(said({{-20, 0.5}, {-10, 1}})
              .find("from frame -20 to -10, the graph's timing from 1 to 6, its run-up from -9: it stays as it is at "
                    "its last key throughout | ") != std::string::npos);
    graph["nodes"]["solver"]["inputs"].erase("startFrame");
    graph["nodes"]["upperMove"] = moves;
    CHECK(said({{100, 1}, {120, 1}}).empty());
    // A switch holds by nature, but not if it never comes.
    const auto switched = [&](const json& keys) {
        graph["nodes"]["block"]["inputs"]["enable"] = {{"keys", keys}};
        return said({{1, 0.5}, {6, 1}});
    };
    CHECK(switched({{20, true}, {30, false}})
              .find("FE266 block.enable: the keyed value lasts from frame 20 to 30, the graph's timing from 1 to 6: it "
                    "stays as it is at its first key throughout | ") != std::string::npos);
    CHECK(switched({{1, false}, {30, true}}).find("FE266") == std::string::npos);
    graph["timing"]["end"] = 1; // nobody says for how long it is
    CHECK(switched({{20, true}, {30, false}}).find("FE266 block.enable") == std::string::npos);
}

TEST_CASE("recorded motion that does not reach over the run is warned about once a file", "[tools]") {
    const TemporaryFolder folder;
    json track = {{"frames", json::array()}};
    for (int f = 1; f <= 11; ++f) {
        const json moved = {1, 0, 0, 0, 0, 1, 0, 4.5 + 0.01 * f, 0, 0, 1, 0, 0, 0, 0, 1};
        const json still = {1, 0, 0, 0, 0, 1, 0, -4.5, 0, 0, 1, 0, 0, 0, 0, 1};
        track["frames"].push_back({{"frame", f}, {"grip", 0.1 * f}, {"bones", {{"upper", moved}, {"lower", still}}}});
    }
    write_text(folder / "motion.json", track.dump());
    const auto check = [&](const json& follows, int last) {
        json graph = small_graph();
        graph["timing"]["end"] = last;
        graph["nodes"]["upperMove"]["inputs"] = follows;
        graph["nodes"]["upperMove"]["inputs"]["track"] = "motion.json";
        graph["nodes"]["upperMove"]["inputs"]["trackName"] = "upper";
        graph["nodes"]["lowerMove"]["inputs"] = {{"track", "motion.json"}, {"trackName", "lower"}}; // never moves
        graph["nodes"]["grip"] = {{"type", "trackChannel"}, {"inputs", {{"file", "motion.json"}, {"channel", "grip"}}}};
        graph["nodes"]["holdTop"]["inputs"]["envelope"] = {{"from", "grip.outValue"}};
        return said_of(run_program({"check", write_graph(folder, graph), "--json"}));
    };
    CHECK(check(json::object(), 11).empty());
    CHECK(check(json::object(), 12) ==
          "FE266 grip.file: the recorded motion ends at frame 11, the run at frame 12; in between it stands "
          "still, as 1 more that follows this file | run the frames that it has, record more, or follow another "
          "motion\n");
    // Two samples a frame: 11 samples are over at frame 6. The channel, at its own rate, is not.
    CHECK(check({{"trackRate", 2}}, 11) ==
          "FE266 upperMove.track: the recorded motion ends at frame 6, the run at frame 11; in between it stands still "
          "| run the frames that it has, record more, or follow another motion\n");
    CHECK(check({{"trackOffset", -4}}, 11)
              .starts_with("FE266 upperMove.track: the recorded motion begins at frame 5, the run at frame 1; "));
    CHECK(check({{"trackOffset", 4}}, 7).empty());
    // Recorded at 48 frames a second, and nobody says how many of them go to one of the graph's 24.
    track["fps"] = 48;
    write_text(folder / "motion.json", track.dump());
    CHECK(check(json::object(), 11) == "FE334 grip.file: the motion was recorded at 48 frames a second, the graph runs "
                                       "at 24: it goes 2 times too slow "
                                       "| write \"rate\": 2, or 1 if one of its frames is to be one of the graph's\n");
    for (const double near : {24.0, 23.976}) {
        track["fps"] = near;
        write_text(folder / "motion.json", track.dump());
        CHECK(check(json::object(), 11).empty());
    }
}

TEST_CASE("output that cannot be written is told, whatever the command", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    const std::vector<std::string> commands{"--help",
                                            "--version",
                                            "help run",
                                            "nodes",
                                            "nodes zTet --json",
                                            "check " + graph,
                                            "check --json " + graph,
                                            "graph --dot " + graph,
                                            "eval " + graph + " plateMesh.outMesh",
                                            "explain " + graph + " solver.outMeshes",
                                            "run " + graph + " --frames 1",
                                            "run " + graph + " --frames 1 --json",
                                            "bench accuracy --help"};
    for (const std::string& words : commands) {
        INFO(words);
        const std::string err = (folder / "err").string();
        std::string line = SINEW_PROGRAM;
        line += " " + words + " > /dev/full 2> " + err;
        const int status = std::system(line.c_str());
        CHECK(WEXITSTATUS(status) == 1);
        CHECK(read_text(err).find("sinew: the output could not be written: No space left on device\n") !=
              std::string::npos);
    }
}
