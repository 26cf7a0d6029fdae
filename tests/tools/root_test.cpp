// --root DIR: what graphs and options name stays in a folder.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <array>
#include <catch2/catch.hpp>
#include <chrono>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

const std::string cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// A closed box.
std::string box_obj(std::array<int, 3> from, std::array<int, 3> to) {
    std::string out;
    for (int i = 0; i < 8; ++i)
        out += "v " + std::to_string((i & 1 ? to : from)[0]) + " " + std::to_string((i & 2 ? to : from)[1]) + " " +
               std::to_string((i & 4 ? to : from)[2]) + "\n";
    return out + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

/// jobs/graph.json, which reads jobs/m.obj; secret.obj beside jobs.
struct Jobs {
    TemporaryFolder folder;
    const fs::path root = folder / "jobs";
    Jobs() {
        fs::create_directories(root / "parts");
        write_text(root / "m.obj", cube);
        write_text(folder / "secret.obj", cube);
        write_text(folder / "outside.json", R"({"format": "sinew 1", "nodes": {}})");
    }
    std::string graph(const std::string& mesh, const json& includes = json::object()) const {
        json g = {{"format", "sinew 1"}, {"nodes", {{"body", {{"type", "meshFile"}, {"inputs", {{"file", mesh}}}}}}}};
        if (!includes.empty()) g["includes"] = includes;
        write_text(root / "graph.json", g.dump(1));
        return (root / "graph.json").string();
    }
    Said run(std::vector<std::string> words) const {
        words.insert(words.end(), {"--root", root.string()});
        return run_program(words);
    }
    /// A refusal with code IO410 that names these.
    /// \param code of `diff` and `fmt --check`, for which 1 is an answer, 2
    void refused(const Said& said, const std::vector<std::string>& names, int code = 1) const {
        INFO(said.out << said.err);
        CHECK(said.code == code);
        CHECK(said.err.find("[IO410]") != std::string::npos);
        CHECK(said.err.find("leads out of the root '" + fs::canonical(root).string() + "'") != std::string::npos);
        CHECK(said.err.find("Name a file within the root") != std::string::npos);
        for (const std::string& name : names) CHECK(said.err.find(name) != std::string::npos);
    }
};

} // namespace

TEST_CASE("meshes outside of the root are refused with node, attribute and path", "[tools]") {
    const Jobs j;
    CHECK(j.run({"check", j.graph("m.obj")}).code == 0);
    CHECK(j.run({"eval", j.graph("m.obj"), "body.outMesh", "--no-cache"}).code == 0);
    j.refused(j.run({"check", j.graph("../secret.obj")}), {"body.file", "../secret.obj"});
    const std::string absolute = (j.folder / "secret.obj").string();
    j.refused(j.run({"eval", j.graph(absolute), "body.outMesh", "--no-cache"}), {"body.file", absolute});
    fs::create_symlink("../secret.obj", j.root / "link.obj");
    j.refused(j.run({"run", j.graph("link.obj"), "--pull", "body.outMesh", "--no-cache"}), {"body.file", "link.obj"});
    CHECK(run_program({"eval", j.graph("link.obj"), "body.outMesh", "--no-cache"}).code == 0); // without a root
    j.refused(j.run({"eval", j.graph("m.obj"), "body.outMesh", "--no-cache", "--set", "body.file=../secret.obj"}),
              {"body.file", "../secret.obj"});
    // What is not there is not told apart from what is.
    j.refused(j.run({"check", j.graph("../nothing.obj")}), {"body.file", "../nothing.obj"});
    j.refused(j.run({"check", absolute}), {absolute});
}

TEST_CASE("numbered files and included graphs stay within the root", "[tools]") {
    const Jobs j;
    for (int frame = 1; frame <= 2; ++frame) write_text(j.root / ("s." + std::to_string(frame) + ".obj"), cube);
    json g = {{"format", "sinew 1"},
              {"timing", {{"start", 1}, {"end", 2}}},
              {"nodes", {{"body", {{"type", "meshSequence"}, {"inputs", {{"file", "s.#.obj"}}}}}}}};
    write_text(j.root / "graph.json", g.dump());
    const std::vector<std::string> words{"run", (j.root / "graph.json").string(), "--pull", "body.outMesh",
                                         "--no-cache"};
    CHECK(j.run(words).code == 0);
    fs::remove(j.root / "s.2.obj");
    fs::create_symlink("../secret.obj", j.root / "s.2.obj");
    j.refused(j.run(words), {"body.file", "s.2.obj"});
    g["nodes"]["body"]["inputs"]["file"] = "../#.obj";
    write_text(j.root / "graph.json", g.dump());
    j.refused(j.run(words), {"body.file", "../#.obj"});

    write_text(j.root / "parts/part.json", R"({"format": "sinew 1", "nodes": {"n": {"type": "meshFile",
        "inputs": {"file": "../../secret.obj"}}}})");
    j.refused(j.run({"check", j.graph("m.obj", {{"p", {{"file", "../outside.json"}}}})}), {"p", "outside.json"});
    j.refused(j.run({"check", j.graph("m.obj", {{"p", {{"file", "parts/part.json"}}}})}),
              {"p.n.file", "../../secret.obj"});
    j.refused(j.run({"check", (j.folder / "outside.json").string()}), {"outside.json"});
}

TEST_CASE("nothing is written outside of the root", "[tools]") {
    const Jobs j;
    const std::string graph = j.graph("m.obj");
    const std::vector<std::string> pull{"run", graph, "--pull", "body.outMesh", "--format", "obj", "--no-cache"};
    const auto with = [&](std::vector<std::string> more) {
        std::vector<std::string> words = pull;
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    CHECK(j.run(with({"--out", (j.root / "out").string(), "--report", (j.root / "out/r.json").string()})).code == 0);
    CHECK(fs::exists(j.root / "out/obj/body.0001.obj"));
    const std::string outside = (j.folder / "out").string();
    j.refused(j.run(with({"--out", outside})), {"--out", outside});
    j.refused(j.run(with({"--out", (j.root / "out").string(), "--report", outside + "/r.json"})),
              {"--report", outside});
    j.refused(j.run(with({"--out", (j.root / "../out").string()})), {"--out"});
    j.refused(j.run({"run", graph, "--pull", "body.outMesh", "--cache", outside}), {"--cache", outside});
    j.refused(j.run({"graph", graph, "--svg", outside + ".svg"}), {outside + ".svg"});
    j.refused(j.run({"graph", graph, "--svg", outside + "/there/is/none.svg"}), {"--svg", outside});
    j.refused(j.run({"view", graph, "-o", outside + ".html"}), {"--output", outside + ".html"});
    j.refused(j.run({"snapshot", graph, "-o", outside + ".png"}), {"--output", outside + ".png"});
    CHECK_FALSE(fs::exists(outside));
    // A link in the output folder leads nowhere either.
    fs::remove_all(j.root / "out/obj");
    fs::create_directory(j.folder / "elsewhere");
    fs::create_directory_symlink("../../elsewhere", j.root / "out/obj");
    j.refused(j.run(with({"--out", (j.root / "out").string()})), {"out/obj/body.0001.obj"});
    CHECK(fs::is_empty(j.folder / "elsewhere"));
}

TEST_CASE("whether files of an earlier run are of the same graph is not asked of what lies outside of the root",
          "[tools]") {
    const Jobs j;
    const fs::path out = j.root / "out", link = out / "obj/body.0007.obj", moved = j.folder / "moved.obj";
    const std::vector<std::string> words{"run", j.graph("m.obj"), "--pull",     "body.outMesh", "--format",
                                         "obj", "--out",          out.string(), "--no-cache",   "--quiet"};
    CHECK(j.run(words).err.empty());
    fs::rename(out / "obj/body.0001.obj", moved);
    fs::last_write_time(moved, fs::file_time_type::clock::now() - std::chrono::hours(1));
    fs::create_symlink(moved, link);
    CHECK(run_program(words).err.empty()); // its mark says that the same graph made it
    const Said said = j.run(words);
    CHECK(said.code == 0);
    CHECK(said.err.find("[IO421]") != std::string::npos);
}

TEST_CASE("diff reads neither graphs, includes nor meshes outside of the root", "[tools]") {
    const Jobs j;
    const std::string other = (j.root / "other.json").string(), absolute = (j.folder / "secret.obj").string();
    const auto diff = [&](const std::string& graph) { return j.run({"diff", other, graph}); };
    j.graph("m.obj");
    fs::copy_file(j.root / "graph.json", other);
    CHECK(diff(j.graph("m.obj")).code == 0);
    fs::create_symlink("../secret.obj", j.root / "link.obj");
    for (const std::string& mesh : {std::string("../secret.obj"), absolute, std::string("link.obj")}) {
        j.refused(diff(j.graph(mesh)), {"graph.json:", "body.file", mesh}, 2);
        CHECK(run_program({"diff", other, j.graph(mesh)}).code == 0); // without a root: the same content
    }
    j.refused(diff(j.graph("../nothing.obj")), {"body.file", "../nothing.obj"}, 2);
    fs::create_symlink("../outside.json", j.root / "link.json");
    const std::string outside = (j.folder / "outside.json").string();
    for (const std::string& part : {std::string("../outside.json"), outside, std::string("link.json")})
        j.refused(diff(j.graph("m.obj", {{"p", {{"file", part}}}})),
                  {"graph.json:", " p: ", fs::path(part).filename().string()}, 2);
    j.refused(diff(outside), {outside}, 2);
    // Of numbered files each counts.
    for (const char* name : {"s.1.obj", "t.1.obj", "t.2.obj"}) write_text(j.root / name, cube);
    fs::create_symlink("../secret.obj", j.root / "s.2.obj");
    const auto numbered = [&](const std::string& name, const std::string& files) {
        const json g = {{"format", "sinew 1"},
                        {"nodes", {{"body", {{"type", "meshSequence"}, {"inputs", {{"file", files}}}}}}}};
        write_text(j.root / name, g.dump());
        return (j.root / name).string();
    };
    const std::vector<std::string> words{"diff", numbered("s.json", "s.#.obj"), numbered("t.json", "t.#.obj")};
    CHECK(run_program(words).code == 0);
    j.refused(j.run(words), {"s.2.obj"}, 2);
}

TEST_CASE("fmt, cache and docs stay within the root", "[tools]") {
    const Jobs j;
    const std::string outside = (j.folder / "outside.json").string(), before = read_text(outside);
    fs::create_symlink("../outside.json", j.root / "link.json");
    for (const std::string& file : {outside, (j.root / "../outside.json").string(), (j.root / "link.json").string()}) {
        j.refused(j.run({"fmt", file}), {file});
        j.refused(j.run({"fmt", "--check", file}), {file}, 2);
    }
    CHECK(read_text(outside) == before);
    // Nothing but the text itself is read of a graph that names what lies outside.
    const std::string graph = j.graph("../secret.obj", {{"p", {{"file", "../outside.json"}}}});
    CHECK(j.run({"fmt", graph}).code == 0);
    CHECK(j.run({"fmt", "--check", graph}).code == 0);

    const fs::path kept = j.folder / "kept";
    fs::create_directory(kept);
    write_text(kept / "0123456789abcdef0123456789abcdef.frame", "x");
    j.refused(j.run({"cache", "info", outside}), {outside});
    j.refused(j.run({"cache", "clean", kept.string()}), {kept.string()});
    j.refused(j.run({"cache", "info", (j.folder / "none").string()}), {"none"}); // there or not is not told
    fs::create_directory_symlink("../kept", j.root / "graph.sinew-cache");
    j.refused(j.run({"cache", "clean", graph}), {"graph.sinew-cache"});
    j.refused(j.run({"cache", "clean", (j.root / "graph.sinew-cache").string()}), {"graph.sinew-cache"});
    CHECK(fs::exists(kept / "0123456789abcdef0123456789abcdef.frame"));
    CHECK(j.run({"cache", "info", (j.root / "parts").string()}).code == 0);

    j.refused(j.run({"docs", (j.folder / "docs").string()}), {(j.folder / "docs").string()});
    CHECK_FALSE(fs::exists(j.folder / "docs"));
    CHECK(j.run({"docs", (j.root / "docs").string()}).code == 0);
    fs::remove(j.root / "docs/codes.md");
    fs::create_symlink("../../codes.md", j.root / "docs/codes.md");
    j.refused(j.run({"docs", (j.root / "docs").string()}), {"docs/codes.md"});
    CHECK_FALSE(fs::exists(j.folder / "codes.md"));
}

TEST_CASE("new reads no meshes and no motion from outside of the root, and writes within", "[tools]") {
    const Jobs j;
    // A bar on two boxes, twice: within the root and outside.
    for (const fs::path& place : {j.root, j.folder / "others"}) {
        fs::create_directories(place / "bones");
        fs::create_directories(place / "muscles");
        write_text(place / "bones/upper.obj", box_obj({0, 0, 10}, {2, 2, 14}));
        write_text(place / "bones/lower.obj", box_obj({0, 0, -4}, {2, 2, 0}));
        write_text(place / "muscles/bar.obj", box_obj({0, 0, 0}, {2, 2, 10}));
        write_text(place / "motion.json", R"({"fps": 24, "frames": [{"frame": 1, "bones": {
            "upper": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}}]})");
    }
    const auto in = [&](const char* name) { return (j.root / name).string(); };
    const auto other = [&](const char* name) { return (j.folder / "others" / name).string(); };
    const std::string out = in("rig.json"), outside = (j.folder / "rig.json").string();
    const auto rig = [&](const std::string& bones, const std::string& muscles, std::vector<std::string> more = {}) {
        std::vector<std::string> words{"new", "rig", bones, muscles, "--unit", "cm", "-o", out};
        words.insert(words.end(), more.begin(), more.end());
        return j.run(words);
    };

    j.refused(rig(other("bones"), other("muscles")), {other("bones"), other("muscles")}); // both told at once
    j.refused(rig(in("bones"), other("muscles/bar.obj")), {"bar.obj"});
    j.refused(rig(in("bones"), other("none.obj")), {"none.obj"}); // there or not is not told
    j.refused(rig(in("bones"), in("muscles"), {"--bones", other("bones")}), {other("bones")});
    j.refused(rig(in("bones"), in("muscles"), {"--motion", other("motion.json")}), {"--motion", other("motion.json")});
    j.refused(j.run({"new", "rig", in("bones"), in("muscles"), "-o", outside}), {"--out", outside});
    j.refused(j.run({"new", "muscle", in("bones/upper.obj"), other("muscles"), "-o", out}),
              {"the muscle", other("muscles")});
    j.refused(
        j.run({"new", "layers", in("muscles"), "--bones", in("bones"), "--skin", other("muscles/bar.obj"), "-o", out}),
        {other("muscles/bar.obj")});
    fs::create_symlink("../../others/muscles/bar.obj", j.root / "muscles/link.obj");
    j.refused(rig(in("bones"), in("muscles")), {"link.obj"});
    fs::remove(j.root / "muscles/link.obj");
    CHECK_FALSE(fs::exists(out));
    CHECK_FALSE(fs::exists(outside));

    const Said made = rig(in("bones"), in("muscles"), {"--motion", in("motion.json")});
    INFO(made.out << made.err);
    CHECK(made.code == 0);
    CHECK(read_text(out).find("--root") == std::string::npos); // the graph is for other places, too
    CHECK(j.run({"check", out, "--fast"}).code == 0);
    CHECK(run_program({"new", "rig", other("bones"), other("muscles"), "--unit", "cm", "-o", outside}).code ==
          0); // without a root
}

TEST_CASE("a root that is none is refused, and runs of folders have none", "[tools]") {
    const Jobs j;
    const std::string graph = j.graph("m.obj");
    const Said none = run_program({"check", graph, "--root", (j.folder / "none").string()});
    CHECK(none.code == 1);
    CHECK(none.err.find("[IO411]") != std::string::npos);
    CHECK(run_program({"check", graph, "--root", ""}).code == 2);
    CHECK(j.run({"view", j.root.string()}).code == 2);
    CHECK(j.run({"snapshot", j.root.string(), "-o", (j.root / "s.png").string()}).code == 2);
}

TEST_CASE("what is written to /dev/stdout arrives in a pipe, behind what a file holds already, and in a new file",
          "[tools]") {
    const Jobs j;
    const std::string graph = j.graph("m.obj");
    const auto shell = [&](const std::string& behind) {
        const std::string command = "'" SINEW_PROGRAM "' graph '" + graph + "' --svg /dev/stdout " + behind;
        return std::system(command.c_str());
    };
    const fs::path through = j.folder / "through.svg", file = j.folder / "file.svg", svg = j.folder / "plain.svg";
    REQUIRE(run_program({"graph", graph, "--svg", svg.string()}).code == 0);
    const std::string wanted = read_text(svg);
    REQUIRE(wanted.find("<svg") != std::string::npos);
    CHECK(shell("| cat > '" + through.string() + "'") == 0);
    CHECK(read_text(through).starts_with(wanted));
    write_text(file, "before\n");
    CHECK(shell(">> '" + file.string() + "'") == 0);
    CHECK(read_text(file).starts_with("before\n" + wanted));
}
