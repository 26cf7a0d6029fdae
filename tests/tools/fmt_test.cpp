// `sinew fmt`: what it writes, what it leaves alone, and that all graphs that ship are laid out so.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <filesystem>

using namespace sinew::test;
namespace fs = std::filesystem;

namespace {

const std::string crooked = "{\"format\":\"sinew 1\",// a comment\n\"nodes\":{\"m\":{\"type\":\"polyCube\",\"inputs\":"
                            "{\"width\":2.50}}}}";
const std::string straight = R"({
  "format": "sinew 1", // a comment
  "nodes": {
    "m": { "type": "polyCube", "inputs": { "width": 2.50 } }
  }
}
)";

} // namespace

TEST_CASE("fmt lays files out, says which, and changes nothing the second time", "[tools]") {
    const TemporaryFolder folder;
    const std::string a = (folder / "a.json").string(), b = (folder / "b.json").string();
    write_text(a, crooked);
    write_text(b, straight);
    const Said checked = run_program({"fmt", "--check", a, b});
    CHECK(checked.code == 1);
    CHECK(checked.out == "would change " + a + "\n");
    CHECK(read_text(a) == crooked);
    const auto before = fs::last_write_time(b);
    const Said said = run_program({"fmt", a, b});
    CHECK(said.code == 0);
    CHECK(said.out == "changed " + a + "\n");
    CHECK(read_text(a) == straight);
    CHECK(fs::last_write_time(b) == before); // not even written
    CHECK(run_program({"fmt", "--check", a, b}).code == 0);
    CHECK(run_program({"fmt", a, b}).out.empty());
}

TEST_CASE("fmt follows links, keeps permissions, and leaves no other file", "[tools]") {
    const TemporaryFolder folder;
    write_text(folder / "a.json", crooked);
    fs::permissions(folder / "a.json", fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
    fs::create_symlink("a.json", folder / "link.json");
    CHECK(run_program({"fmt", (folder / "link.json").string()}).code == 0);
    CHECK(fs::is_symlink(folder / "link.json"));
    CHECK(read_text(folder / "a.json") == straight);
    CHECK(fs::status(folder / "a.json").permissions() ==
          (fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read));
    CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 2);
}

TEST_CASE("fmt refuses files with errors, and goes on with the others", "[tools]") {
    const TemporaryFolder folder;
    const auto put = [&](const std::string& name, const std::string& text) {
        write_text(folder / name, text);
        return (folder / name).string();
    };
    const std::string syntax = put("1.json", "{\"format\": \"sinew 1\", \"nodes\": {,}}");
    const std::string input =
        put("2.json", R"({"format": "sinew 1", "nodes": {"m": {"type": "polyCube", "inputs": {"widht": 2}}}})");
    const std::string good = put("3.json", crooked), mesh = put("4.json", "v 0 0 0\n");
    const Said said = run_program({"fmt", syntax, input, mesh, (folder / "none.json").string(), good});
    CHECK(said.code == 1);
    for (const char* code : {"DG001", "DG011", "DG004", "IO401"}) CHECK(said.err.find(code) != std::string::npos);
    CHECK(read_text(syntax) == "{\"format\": \"sinew 1\", \"nodes\": {,}}");
    CHECK(read_text(input).find("widht\": 2}") != std::string::npos);
    CHECK(read_text(good) == straight);
    CHECK(run_program({"fmt"}).code == 2);
}

TEST_CASE("fmt takes parts that are whole only where they are included", "[tools]") {
    const TemporaryFolder folder;
    const std::string part = (folder / "part.json").string(), top = (folder / "top.json").string();
    write_text(part, "{\"format\": \"sinew 1\", \"nodes\": {\"b\": {\"type\": \"zBone\"}}}");
    write_text(top, R"({"format": "sinew 1", "includes": {"x": {"file": "part.json"}}, "nodes": {}})");
    CHECK(run_program({"fmt", part, top}).code == 0); // of the bone's mesh, others are in charge
    CHECK(read_text(top) == R"({
  "format": "sinew 1",
  "includes": {
    "x": { "file": "part.json" }
  },
  "nodes": {}
}
)");
}

TEST_CASE("fmt needs neither meshes nor included graphs, and says which files cannot be read", "[tools]") {
    const TemporaryFolder folder;
    const auto put = [&](const std::string& name, const std::string& text) {
        write_text(folder / name, text);
        return (folder / name).string();
    };
    put("part.json", R"({"format": "sinew 1", "nodes": {"w": {"type": "polyCube", "inputs": {"widht": 1}}}})");
    const std::string graph = put("g.json", R"({"format": "sinew 1", "includes": {
"none": {"file": "none.json", "overrides": {"a.width": 2}}, "part": {"file": "part.json", "overrides": {"z.width": 3}}},
"nodes": {"m": {"type": "meshFile", "inputs": {"file": "nix.obj"}},
"s": {"type": "meshSequence", "inputs": {"file": "nix.#.obj"}}, "own": {"type": "hostsOwn"},
"b": {"type": "zBone", "inputs": {"mesh": {"from": "none.a.outMesh"}}},
"c": {"type": "zBone", "inputs": {"mesh": {"from": "part.nothing.outMesh"}}}}})");
    const Said checked = run_program({"fmt", "--check", graph});
    CHECK(checked.code == 1);
    CHECK(checked.out == "would change " + graph + "\n");
    CHECK(checked.err == "");
    CHECK(run_program({"fmt", graph}).code == 0);
    CHECK(read_text(graph) == R"({
  "format": "sinew 1",
  "includes": {
    "none": { "file": "none.json", "overrides": { "a.width": 2 } },
    "part": { "file": "part.json", "overrides": { "z.width": 3 } }
  },
  "nodes": {
    "m": { "type": "meshFile", "inputs": { "file": "nix.obj" } },
    "s": { "type": "meshSequence", "inputs": { "file": "nix.#.obj" } },
    "own": { "type": "hostsOwn" },
    "b": { "type": "zBone", "inputs": { "mesh": { "from": "none.a.outMesh" } } },
    "c": { "type": "zBone", "inputs": { "mesh": { "from": "part.nothing.outMesh" } } }
  }
}
)");
    CHECK(run_program({"fmt", "--check", graph}).code == 0);
    // What the text itself says wrongly stays an error, with a code of its own.
    const std::string syntax = put("syntax.json", "{"), crooked_file = put("crooked.json", crooked);
    const std::string wire = put("wire.json", R"({"format": "sinew 1", "nodes":
        {"b": {"type": "zBone", "inputs": {"mesh": {"from": "part.nothing.outMesh"}}}}})");
    for (const std::string& file : {syntax, wire, (folder / "none.json").string()}) {
        INFO(file);
        CHECK(run_program({"fmt", "--check", file}).code == 2);
        CHECK(run_program({"fmt", file}).code == 1);
        const Said both = run_program({"fmt", "--check", file, crooked_file});
        CHECK(both.code == 2);
        CHECK(both.out == "would change " + crooked_file + "\n");
    }
}

TEST_CASE("all graphs that ship are laid out as fmt does", "[tools]") {
    std::vector<std::string> words{"fmt", "--check"};
    for (const char* folder : {"learn", "demos", "scenes", "bench"})
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(SINEW_SOURCE_DIR) / "graphs" / folder)) {
            if (entry.path().extension() != ".json") continue;
            if (read_text(entry.path()).find("\"format\": \"sinew ") != std::string::npos)
                words.push_back(entry.path().string());
        }
    CHECK(words.size() > 50);
    const Said said = run_program(words);
    CHECK(said.out == ""); // else: run `sinew fmt` on them
    CHECK(said.err == "");
    CHECK(said.code == 0);
}
