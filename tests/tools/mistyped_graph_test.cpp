// Graph files that cannot be read, and keys that are misspelt: what was probably meant.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

/// What `check` says of a file, "CODE pointer: message | hint" a line; it always refuses.
std::string said_of_file(const fs::path& file) {
    const Said said = run_program({"check", file.string(), "--json", "--no-cache"});
    CHECK(said.code == 1);
    std::string out;
    for (const json& d : said.lines())
        out += d.at("code").get<std::string>() + " " + d.value("pointer", "") + ": " +
               d.at("message").get<std::string>() + " | " + d.value("hint", "") + "\n";
    return out;
}

std::string said_of_text(const std::string& text) {
    const TemporaryFolder folder;
    std::ofstream(folder / "graph.json") << text;
    return said_of_file(folder / "graph.json");
}

} // namespace

TEST_CASE("check tells graph files that hold nothing from those that are wrong", "[tools]") {
    const std::string begins =
        "a graph begins as { \"format\": \"sinew 1\", \"nodes\": { … } }; `sinew new` writes one\n";
    CHECK(said_of_text("") == "DG004 : the file is empty | " + begins);
    CHECK(said_of_text(" \n\t\n") == "DG004 : there is nothing but blanks in the file | " + begins);
    CHECK(said_of_text("// a plan\n/* of\nmine */\n") ==
          "DG004 : there is nothing but comments in the file | write { \"format\": … } below them\n");
    CHECK(said_of_text("v 0 0 0\n") ==
          "DG004 : this is no graph file: a graph is one JSON object and begins with { | " + begins);
    CHECK(said_of_text(std::string("\xFF\xFE{\0}\0", 6)) ==
          "DG004 : the file is written in UTF-16 | save it as UTF-8\n");
}

TEST_CASE("check says why a graph file cannot be opened, and which one may be meant", "[tools]") {
    const TemporaryFolder folder;
    CHECK(said_of_file(folder.path()) ==
          "IO402 : this is a folder, not a graph file | name the graph file (.json) that is meant\n");
    CHECK(said_of_file(folder / "thigh.json") == "IO401 : there is no such graph file | \n");
    std::ofstream(folder / "thigh_muscles.json") << "{}";
    std::ofstream(folder / "arm.json") << "{}";
    CHECK(said_of_file(folder.path()) ==
          "IO402 : this is a folder, not a graph file | name a file in it: arm.json or thigh_muscles.json\n");
    CHECK(said_of_file(folder / "thigh_muscle.json") ==
          "IO401 : there is no such graph file | did you mean \"" + (folder / "thigh_muscles.json").string() + "\"?\n");
    CHECK(said_of_file(folder / "leg.json") == "IO401 : there is no such graph file | \n"); // all end in .json
}

TEST_CASE("check says where a key stands that is written twice, and before what a comma is missing", "[tools]") {
    CHECK(
        said_of_text("{\"format\": \"sinew 1\", \"nodes\": {\n  \"a\": {\"type\": \"polyCube\"},\n"
                     "  \"b\": {\"type\": \"polyCube\"},\n  \"a\": {\"type\": \"polyPlane\"}}}") ==
        "DG002 /nodes/a: the key \"a\" is written twice, first at line 2, column 3 | keep one of the two, or give one "
        "another name\n");
    const auto said_of_node = [](const std::string& node) {
        return said_of_text(R"({"format": "sinew 1", "nodes": {"a": {)" + node + "}}}");
    };
    const std::string in_object = "expected , or } in an object, found ", in_list = "expected , or ] in a list, found ";
    CHECK(said_of_node(R"("type": "polyCube" "inputs": {})") ==
          "DG001 /nodes/a: " + in_object + R"("\"" | put a comma before "inputs")" + "\n");
    CHECK(said_of_node(R"("type": "polyCube", "inputs": {} "comment": "b")") ==
          "DG001 /nodes/a: " + in_object + R"("\"" | put a comma before "comment")" + "\n");
    CHECK(said_of_node(R"("type": 12 ")" + std::string(60, 'x') + "\": 1") ==
          "DG001 /nodes/a: " + in_object + R"("\"" | put a comma before this text)" + "\n");
    CHECK(said_of_node(R"("type": "polyCube" 3)") == "DG001 /nodes/a: " + in_object + "\"3\" | \n");
    CHECK(said_of_node(R"("type": 12  kPa)") ==
          "DG001 /nodes/a: " + in_object + "\"k\" | a number with its unit is written in quotes: \"12 kPa\"\n");
    CHECK(said_of_node(R"("b": [-0.5 m/s])") ==
          "DG001 /nodes/a/b: " + in_list + "\"m\" | a number with its unit is written in quotes: \"-0.5 m/s\"\n");
    CHECK(said_of_node(R"("b": [2 1])") == "DG001 /nodes/a/b: " + in_list + "\"1\" | put a comma before this 1\n");
    CHECK(said_of_node(R"("b": ["c" "d"])") ==
          "DG001 /nodes/a/b: " + in_list + R"("\"" | put a comma before "d")" + "\n");
    CHECK(said_of_node(R"("b": [{} {}])") ==
          "DG001 /nodes/a/b: " + in_list + R"("{" | put a comma before this {)" + "\n");
    CHECK(said_of_node(R"("b": [1, 2 "c": 3)") ==
          "DG001 /nodes/a/b: " + in_list + R"("\"" | end the list with ] and put a comma before the key "c")" + "\n");
}

TEST_CASE("check says which file of a folder may be meant by an input", "[tools]") {
    const TemporaryFolder folder;
    const auto said_of_path = [&](const std::string& path) {
        std::ofstream(folder / "graph.json")
            << R"({"format": "sinew 1", "nodes": {"a": {"type": "meshFile", "inputs": {"file": ")" + path + R"("}}}})";
        return said_of_file(folder / "graph.json");
    };
    const std::string is_folder = "IO402 /nodes/a/inputs/file: \"arm\" is a folder | ";
    fs::create_directory(folder / "arm");
    CHECK(said_of_path("arm") == is_folder + "name the file in it that is meant\n");
    for (const char* name : {"ulna.obj", "humerus.OBJ", "read.me"}) std::ofstream(folder / "arm" / name) << "v 0 0 0\n";
    CHECK(said_of_path("arm") == is_folder + R"(name a file in it: "arm/humerus.OBJ" or "arm/ulna.obj")" + "\n");
    CHECK(said_of_path("arm/") == "IO402 /nodes/a/inputs/file: \"arm/\" is a folder | name a file in it: "
                                  "\"arm/humerus.OBJ\" or \"arm/ulna.obj\"\n");
    CHECK(
        said_of_path("arm/ulna.obj\\u0000.ply") ==
        "IO402 /nodes/a/inputs/file: \"arm/ulna.obj\\u0000.ply\" holds a character of code 0, which no name of a file "
        "can | leave out \\u0000\n");
    std::ofstream(folder / "graph.json")
        << R"({"format": "sinew 1", "includes": {"b": {"file": "arm/ulna.obj\u0000.ply"}}, "nodes": {}})";
    const std::string of_include = said_of_file(folder / "graph.json");
    CHECK(of_include.starts_with("IO402 /includes/b/file: "));
    CHECK(of_include.find("holds a character of code 0, which no name of a file can") != std::string::npos);
    for (int i = 0; i < 12; ++i) std::ofstream(folder / "arm" / (std::to_string(i) + ".ply")) << "ply\n";
    CHECK(said_of_path("arm") == is_folder + "name the file in it that is meant\n");
}

TEST_CASE("check says which key was probably meant by one that is unknown", "[tools]") {
    CHECK(said_of_text(R"({"format": "sinew 1", "nods": {}})") ==
          "DG007 /nods: unknown key \"nods\" | did you mean \"nodes\"?\n");
    CHECK(said_of_text(R"({"format": "sinew 1", "Timing": {"start": 2}, "nodes": {}})") ==
          "DG007 /Timing: unknown key \"Timing\" | did you mean \"timing\"?\n");
    CHECK(said_of_text(R"({"format": "sinew 1", "timings": {"start": 2}, "nodes": {}})") ==
          "DG007 /timings: unknown key \"timings\" | did you mean \"timing\"?\n");
    CHECK(said_of_text(R"({"fromat": "sinew 1", "nodes": {}})") ==
          "DG004 /fromat: the key \"format\" is missing; there is \"fromat\" | write \"format\": \"sinew 1\" in its "
          "place\n");
    CHECK(said_of_text(R"({"format": "sinew 1", "fps": 25, "nodes": {}})") ==
          "DG007 /fps: unknown key \"fps\" | write it within \"timing\": { \"fps\": … }\n");
    CHECK(
        said_of_text(R"({"format": "sinew 1", "colour": 1, "nodes": {}})") ==
        "DG007 /colour: unknown key \"colour\" | keys: $schema, format, comment, timing, includes, nodes or editor\n");
    // What is there need not be meant by what is not known, and is missing all the same where nothing is meant by it.
    CHECK(said_of_text(R"({"format": "sinew 1", "nods": {}, "nodes": {}})") ==
          "DG007 /nods: unknown key \"nods\" | did you mean \"nodes\"?\n");
    CHECK(said_of_text(R"({"format": "sinew 1", "colour": 1})")
              .ends_with("DG008 : the key \"nodes\" is missing | write \"nodes\": { … }\n"));
}

TEST_CASE("check says which key was probably meant within timing, nodes and includes", "[tools]") {
    CHECK(said_of_text(R"({"format": "sinew 1", "timing": {"begin": 1, "frameRate": 24, "ends": 3}, "nodes": {}})") ==
          "DG007 /timing/begin: unknown key \"begin\" | did you mean \"start\"?\n"
          "DG007 /timing/frameRate: unknown key \"frameRate\" | did you mean \"fps\"?\n"
          "DG007 /timing/ends: unknown key \"ends\" | did you mean \"end\"?\n");
    CHECK(said_of_text(R"({"format": "sinew 1", "nodes": {"a": {"typ": "polyCube"}}})") ==
          "DG008 /nodes/a/typ: a node needs a \"type\" in quotes | write \"type\" instead of \"typ\"\n");
    CHECK(said_of_text(R"({"format": "sinew 1", "nodes": {"a": {"type": "polyCube", "input": {}, "width": 3}}})") ==
          "DG007 /nodes/a/input: unknown key \"input\" | did you mean \"inputs\"?\n"
          "DG007 /nodes/a/width: unknown key \"width\" | write it within \"inputs\": { \"width\": … }\n");
    CHECK(said_of_text(R"({"format": "sinew 1", "includes": {"x": {"path": "b.json"}}, "nodes": {}})") ==
          "DG007 /includes/x/path: unknown key \"path\" | did you mean \"file\"?\n");
}
