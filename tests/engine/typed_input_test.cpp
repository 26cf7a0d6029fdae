// What people type into graph files: quantities in quotes, names of presets, comments. Taken, or answered with the form
// that is right.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/units.h"
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace toys;

namespace {

const std::shared_ptr<const Registry>& types() {
    static const std::shared_ptr<const Registry> r = registry();
    return r;
}

std::shared_ptr<const Graph> read(const std::string& text) { return read_graph(types(), text, "t.json").graph; }

std::string with_input(const std::string& name, const std::string& value) {
    return R"({"format": "sinew 1", "nodes": {"n": {"type": "number", "inputs": {")" + name + "\": " + value + "}}}}";
}

/// "DG012 expected number, found text | write 3 without quotes"
std::string answer(const std::string& text) {
    try {
        read(text);
    } catch (const Failure& f) {
        const Diagnostic& d = f.diagnostics().front();
        return d.code + " " + d.message + (d.hint.empty() ? "" : " | " + d.hint);
    }
    return "taken";
}

std::string answer(const std::string& name, const std::string& value) { return answer(with_input(name, value)); }

template <class T>
T value(const std::string& name, const std::string& json) {
    return std::get<Value>(read(with_input(name, json))->find("n")->inputs.at(name)).as<T>();
}

} // namespace

TEST_CASE("a quantity in quotes is a number with its unit") {
    CHECK(value<double>("value", "\"12 kPa\"") == 12000);
    CHECK(value<double>("value", "\"12kPa\"") == 12000);
    CHECK(value<double>("value", "\" +1.5e-1 MPa \"") == 150000);
    CHECK(value<Vec3>("axis", "[\"1 mm\", \"2cm\", 3]") == Vec3{0.001, 0.02, 3});
    CHECK(value<double>("value", "\"fat\"") == 500); // a preset
    CHECK(value<double>("value", "{\"value\": \"12 kPa\"}") == 12000);
    CHECK(answer("value", "{\"keys\": [[1, \"1 kPa\"], [5, \"2 kPa\"]]}") == "taken");
    CHECK(answer("value", "\"12 cm\"") == "DG015 \"cm\" does not convert to \"Pa\" | usual units here: Pa, kPa or MPa");
    CHECK(answer("value", "\"12 parsec\"") == "DG015 unknown unit \"parsec\" | usual units here: Pa, kPa or MPa");
    CHECK(answer("value", "\"fatt\"") == "DG016 unknown preset \"fatt\" | did you mean \"fat\"?");
    CHECK(answer("value", "\"inf Pa\"") == "DG016 unknown preset \"inf Pa\" | presets: fat or muscle");
    CHECK(answer("value", "\"-1 kPa\"") == "DG013 -1000 is outside [0, 1e+09] Pa | A number");
    CHECK(answer("value", "{\"value\": \"1 kPa\", \"unit\": \"Pa\"}") ==
          "DG015 \"1 kPa\" holds a unit, and \"unit\" stands beside it | keep one of them");
    CHECK(answer("value", "\"1,5 kPa\"") == "DG012 expected number, found text | write \"1.5 kPa\"");
    CHECK(answer("value", "\"1,5\"") == "DG012 expected number, found text | write 1.5");
    CHECK(answer("value", "\"1,5,2\"") ==
          "DG012 expected number, found text | write decimals behind a dot, lists in brackets");
    CHECK(answer("value", "{\"keys\": [[\"1 s\", 2]]}") == "DG012 expected number, found text");
}

TEST_CASE("a wrong form is answered with the right one") {
    CHECK(answer("value", "\"30\"") == "DG012 expected number, found text | write 30 without quotes");
    CHECK(answer("times", "\"4\"") == "DG012 expected integer, found text | write 4 without quotes");
    CHECK(answer("negate", "\"true\"") == "DG012 expected true or false, found text | write true");
    CHECK(answer("negate", "0") == "DG012 expected true or false, found an integer | write false");
    // The axis is usually along y, so a length alone is meant for that.
    CHECK(answer("axis", "2") == "DG012 expected a list of numbers, found an integer | write three numbers: [0, 2, 0]");
    CHECK(answer("axis", "\"1, 2,3\"") == "DG012 expected a list of numbers, found text | write [1, 2, 3]");
    CHECK(answer("axis", "\"up\"") == "DG012 expected a list of numbers, found text | write three numbers: [x, y, z]");
    CHECK(answer("weights", "\"0 0.5 1\"") == "DG012 expected a list of numbers, found text | write [0, 0.5, 1]");
    CHECK(answer("axis", "\"m.out\"") == // there is no m
          "DG012 expected a list of numbers, found text | write three numbers: [x, y, z]");
    const auto in = [](const std::string& type, const std::string& input, const std::string& json) {
        return answer(R"({"format": "sinew 1", "nodes": {"m": {"type": "number"}, "n": {"type": ")" + type +
                      R"(", "inputs": {")" + input + "\": " + json + "}}}}");
    };
    CHECK(in("relay", "in", "\"m.out\"") ==
          "DG026 a number can only be connected, found text | write { \"from\": \"m.out\" }");
    CHECK(in("relay", "in", "[{\"from\": \"m.out\"}]") ==
          "DG020 takes one connection, not a list | write { \"from\": \"m.out\" }");
    CHECK(in("sum", "terms", "\"m.out\"") ==
          "DG026 a number can only be connected, found text | write [ { \"from\": \"m.out\" } ]");
    CHECK(in("sum", "terms", "[\"m.out\"]") ==
          "DG025 expected a connection, found text | write { \"from\": \"m.out\" }");
    CHECK(in("sum", "terms", "{\"from\": \"m.out\"}") ==
          "DG020 takes a list of connections, not a single one | write [ { \"from\": \"m.out\" } ]");
    CHECK(answer("{\"format\": \"sinew 1\", \"nodes\": {},}") == "DG001 remove the comma before this }");
    CHECK(answer("weights", "[1, 2,]") == "DG001 remove the comma before this ]");
}

TEST_CASE("lists of one and lists of lists are answered once, with what is meant") {
    CHECK(answer("value", "[12]") == "DG012 expected number, found a list | write 12");
    CHECK(answer("times", "[2]") == "DG012 expected integer, found a list | write 2");
    CHECK(answer("negate", "[true]") == "DG012 expected true or false, found a list | write true");
    CHECK(answer("axis", "[2]") == "DG012 expected 3 numbers, found 1 | write three numbers: [0, 2, 0]");
    CHECK(answer("axis", "[2, 3]") == "DG012 expected 3 numbers, found 2 | write [2, 3, 0]");
    CHECK(answer("axis", "[1, 2, 3, 1]") == "DG012 expected 3 numbers, found 4 | write [1, 2, 3]");
    CHECK(answer("axis", "[[1, 2, 3]]") == "DG012 expected a list of numbers, found a list of lists | write [1, 2, 3]");
    CHECK(answer("weights", "[0, [0.5, 1]]") ==
          "DG012 expected a list of numbers, found a list of lists | write [0, 0.5, 1]");
    CHECK(answer("weights", "[[1, 2], [3, \"a\"]]") ==
          "DG012 expected a list of numbers, found a list of lists | write all numbers in one list");
    std::string rows = "[1, 1]";
    for (int i = 0; i < 5000; ++i) rows += ", [0, 1]";
    try {
        read(with_input("weights", "[" + rows + "]"));
        FAIL("a list of lists is taken");
    } catch (const Failure& f) {
        REQUIRE(f.diagnostics().size() == 1);
        CHECK(f.diagnostics()[0].hint == "write [1, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, …]");
    }
}

TEST_CASE("a unit in other letters is answered with the right ones") {
    const auto unit = [](const std::string& written) { return answer("value", "\"12 " + written + "\""); };
    CHECK(unit("kpa") == "DG015 unknown unit \"kpa\" | write \"12 kPa\"");
    CHECK(unit("KPA") == "DG015 unknown unit \"KPA\" | write \"12 kPa\"");
    CHECK(unit("kilopascals") == "DG015 unknown unit \"kilopascals\" | write \"12 kPa\"");
    CHECK(unit("N/m2") == "DG015 unknown unit \"N/m2\" | write \"12 N/m^2\"");
    CHECK(unit("N / mm²") == "DG015 unknown unit \"N / mm²\" | write \"12 N/mm^2\"");
    CHECK(unit("newton/m**2") == "DG015 unknown unit \"newton/m**2\" | write \"12 N/m^2\"");
    CHECK(unit("KN") == "DG015 unknown unit \"KN\" | usual units here: Pa, kPa or MPa"); // of another dimension
    CHECK(answer("value", "{\"value\": 12, \"unit\": \"kpa\"}") == "DG015 unknown unit \"kpa\" | write \"kPa\"");
    CHECK(unit_meant("kg/m3", "kg/m^3") == "kg/m^3");
    CHECK(unit_meant("g/cm³", "kg/m^3") == "g/cm^3");
    CHECK(unit_meant("degrees", "deg") == "deg");
    CHECK(unit_meant("kPa", "Pa").empty()); // is right
}

TEST_CASE("words and objects of other programs are answered with ours") {
    const std::string text = "DG012 expected true or false, found text | ";
    CHECK(answer("negate", "\"True\"") == text + "write true");
    CHECK(answer("negate", "\"OFF\"") == text + "write false");
    CHECK(answer("axis", R"({"x": 1, "y": 2, "z": 3})") ==
          "DG012 expected a list of numbers, found an object | write [1, 2, 3]");
    CHECK(answer("axis", R"({"X": 0.5})") ==
          "DG012 expected a list of numbers, found an object | write [0.5, 1, 0]"); // y is 1 by default
    CHECK(answer("value", R"({"keys": [[1, 0], [9, 1]], "interpolation": "linear"})") ==
          "DG007 unknown key \"interpolation\" | did you mean \"interp\"?");
    CHECK(answer("value", R"({"keyframes": [[1, 0], [9, 1]]})") ==
          "DG007 unknown key \"keyframes\" | did you mean \"keys\"?");
    CHECK(answer("value", R"({"keys": [[1, 0], [9, 1]], "interp": "Linear"})") ==
          "DG017 unknown interpolation \"Linear\" | write \"linear\"");
    CHECK(answer("value", R"({"keys": [[1, 0], [9, 1]], "interp": "spline"})") ==
          "DG017 unknown interpolation \"spline\" | write \"smooth\"");
    CHECK(answer("value", R"({"keys": {"1": 0, "9": 0.5}})") ==
          "DG012 expected a list of [frame, value], found an object | write [[1, 0], [9, 0.5]]");
    CHECK(answer("value", R"({"keys": [1, 0, 9, 0.5]})") ==
          R"(DG017 a key is [frame, value] or [frame, value, { "in": …, "out": … }] | write [[1, 0], [9, 0.5]])");
    CHECK(answer("value", "[[1, 0], [9, 0.5]]") ==
          "DG012 expected number, found a list | write { \"keys\": [[1, 0], [9, 0.5]] }");
    CHECK(answer("axis", "[[1, [0, 1, 0]], [9, [1, 0, 0]]]") ==
          "DG012 expected vector, found a list | write { \"keys\": [[frame, value], …] }");
    CHECK(answer("value", R"({"keys": [["9", 2]]})") == "DG012 expected number, found text | write 9 without quotes");
    CHECK(answer("value", "\"mus\"") == "DG016 unknown preset \"mus\" | presets: fat or muscle");
}

TEST_CASE("an input that is missing is answered with what there is to connect it to") {
    const auto with = [](const std::string& nodes) {
        std::string text = R"({"format": "sinew 1", "nodes": {)";
        return answer(text.append(nodes).append("}}"));
    };
    const std::string a = R"("a": {"type": "number"}, )", b = R"("b": {"type": "number"}, )";
    CHECK(with(R"("r": {"type": "relay"})") ==
          "DG019 relay needs this number | connect it: { \"from\": \"node.output\" }");
    CHECK(with(a + R"("r": {"type": "relay"})") ==
          "DG019 relay needs this number | connect it: { \"from\": \"a.out\" }");
    CHECK(with(a + b + R"("r": {"type": "relay"})") ==
          "DG019 relay needs this number | connect it: { \"from\": \"node.output\" } with \"a.out\" or \"b.out\"");
    CHECK(with(a + b + R"("s": {"type": "sum"})") ==
          "DG019 sum needs this number | connect it: [ { \"from\": \"a.out\" }, { \"from\": \"b.out\" } ]");
    CHECK(with(a + R"("s": {"type": "sum", "inputs": {"terms": []}})") ==
          "DG021 has 0 connections and needs at least 1 | connect it: [ { \"from\": \"a.out\" } ]");
    CHECK(with(R"("f": {"type": "fileSize"})") ==
          "DG019 fileSize needs this file | write the path of a file, relative to the graph's folder");
}

TEST_CASE("several of one and one of several are found") {
    const std::vector<std::string> names{"bodies", "mesh", "fibers", "QuasiStatic"};
    CHECK(nearest_name("body", names) == "bodies");
    CHECK(nearest_name("meshes", names) == "mesh");
    CHECK(nearest_name("Fiber", names) == "fibers");
    CHECK(nearest_name("QUASISTATIC", names) == "QuasiStatic");
    CHECK(nearest_name("colour", names).empty());
}

TEST_CASE("a node's name stands for its output in what is proposed") {
    const auto in = [](const std::string& type, const std::string& input, const std::string& json) {
        return answer(R"({"format": "sinew 1", "nodes": {"m": {"type": "number"}, "n": {"type": ")" + type +
                      R"(", "inputs": {")" + input + "\": " + json + "}}}}");
    };
    const std::string form = "write { \"from\": \"m.out\" }";
    CHECK(in("relay", "in", "\"m\"") == "DG026 a number can only be connected, found text | " + form);
    CHECK(in("relay", "in", "{\"from\": \"M\"}") == "DG025 \"M\" does not name an output | write \"m.out\"");
    CHECK(in("sum", "terms", "[\"m\"]") == "DG025 expected a connection, found text | " + form);
    CHECK(in("relay", "in", "\"nobody\"") ==
          "DG026 a number can only be connected, found text | write { \"from\": \"node.output\" }");
    // An input that another type has, and one that nothing has.
    CHECK(in("relay", "axis", "[0, 1, 0]") == "DG011 no such input on relay | number has it");
    CHECK(in("relay", "comment", "\"mine\"") ==
          "DG011 no such input on relay | write it beside \"type\" and \"inputs\", or as // …");
}

TEST_CASE("values that JSON does not have are answered with what it has") {
    const auto json = [](const std::string& written) { return answer("value", written); };
    CHECK(json("NaN") == "DG001 expected a value, found \"NaN\"; write a finite number");
    CHECK(json("-Infinity") == "DG001 expected a value, found \"-Infinity\"; write a finite number");
    CHECK(json("True") == "DG001 expected a value, found \"True\"; write true");
    CHECK(json("None") == "DG001 expected a value, found \"None\"; write null");
    CHECK(json("+20") == "DG001 expected a value, found \"+20\"; write 20");
    CHECK(json(".5") == "DG001 expected a value, found \".5\"; write 0.5");
    CHECK(json("+.5") == "DG001 expected a value, found \"+.5\"; write 0.5");
    CHECK(json("020") == "DG001 a number does not begin with 0 and another digit; leave the 0 out");
    CHECK(json("'fat'") == "DG001 expected a value, found \"'\"; write text in double quotes");
    CHECK(json("yes") == "DG001 expected a value, found \"y\"");
    CHECK(answer("{'format': 1}") == "DG001 expected a key in double quotes, found \"'\"");
}

TEST_CASE("a file that is no graph is told so and not what JSON lacks in it") {
    const auto file =
        std::filesystem::temp_directory_path() / ("sinew_no_graph_" + std::to_string(::getpid()) + ".obj");
    std::ofstream(file) << "v 0 0 0\n";
    try {
        load_graph(types(), file.string());
        FAIL("it was read");
    } catch (const Failure& f) {
        CHECK(f.diagnostics().front().code == "DG004");
        CHECK(f.diagnostics().front().message == "this is no graph file: a graph is one JSON object and begins with {");
    }
    std::filesystem::remove(file);
}

TEST_CASE("comments are kept beside what they belong to and change nothing else") {
    const std::string written = R"(// of the file
{
  "$schema": "graph.schema.json",
  "format": "sinew 1", // behind a value
  "comment": ["what", { "people": "like" }],
  "timing": { "comment": "one frame" },
  "nodes": {
    // of a node
    "a": { /* of its type */ "type": "number", "comment": "a number", "inputs": {
        /* two
           lines */
        "value": 3, // behind it
        "times": { "value": 2, "comment": "default" },
        "axis": [0, 1, 0] // the default too
        // "mode": "double"
      } }, // behind the node
    "odd": { "type": "strange", /* kept */ "inputs": {} },
    "r": { "type": "relay", "inputs": { "in": { "from": "a.out", "comment": 4 } } },
    "comment": ["of", "all"], // what follows
    "s": { "type": "sum", "inputs": { "terms": [ { "from": "a.out" }, // first
      { "from": "r.out" } ] } }
    // "b": { "type": "number" }
  },
  "editor": { "x": 1 /* kept */ }
}
// the end
)";
    const std::string kept = R"({
  "$schema": "graph.schema.json",
  // behind a value
  "format": "sinew 1",
  "comment": ["what", { "people": "like" }],
  "timing": { "fps": 24, "start": 1, "end": 1, "comment": "one frame" },
  // what follows
  "nodes": {
    "comment": ["of", "all"],
    // of a node
    /* of its type */
    // "mode": "double"
    // behind the node
    "a": { "type": "number", "comment": "a number", "inputs": {
        /* two
           lines */
        // behind it
        "value": 3,
        "times": { "value": 2, "comment": "default" },
        // the default too
        "axis": [0, 1, 0]
      } },
    "odd": { "type": "strange", /* kept */ "inputs": {} },
    "r": { "type": "relay", "inputs": {
        "in": { "from": "a.out", "comment": 4 }
      } },
    "s": { "type": "sum", "inputs": {
        // first
        "terms": [ { "from": "a.out" },
          { "from": "r.out" } ]
      } }
    // "b": { "type": "number" }
  },
  "editor": { "x": 1 /* kept */ }
}
// the end
)";
    const auto g = read(written);
    std::string with_head = kept;
    with_head.replace(with_head.find("  \"$schema\""), 0, "  // of the file\n");
    CHECK(write_graph(*g) == with_head);
    CHECK(write_graph(*read(write_graph(*g))) == with_head);
    // Edits leave them where they are.
    Edit edit(g);
    edit.set({"a", "value"}, Value::of<double>(4)).rename_node("a", "c");
    const std::string edited = write_graph(*edit.commit().graph);
    CHECK(edited.find("        // behind it\n        \"value\": 4,") != std::string::npos);
    CHECK(edited.find("    // of a node\n    /* of its type */\n    // \"mode\": \"double\"\n    // behind the "
                      "node\n    \"c\": {") != std::string::npos);
    // The same keys with and without them.
    Evaluator e;
    CHECK(number(e, g, {"a", "out"}, 1) == number(e, read(with_input("value", "3, \"times\": 2")), {"n", "out"}, 1));
}

TEST_CASE("comments that are none and where a comment key cannot be kept") {
    CHECK(answer("{ /* open") == "DG001 a comment is not closed by */");
    CHECK(answer("{ / }") == "DG001 expected // or /* at the begin of a comment, found \"/\"");
    CHECK(answer("{ // \xff\n }") == "DG001 the text is not UTF-8; save it as UTF-8");
    CHECK(answer("\xEF\xBB\xBF// first\r\n{\"format\": \"sinew 1\", \"nodes\": {}}") == "taken");
    CHECK(answer("{\"format\": \"sinew 1\", \"nodes\": {\"n\": {\"type\": \"number\"}, \"s\": {\"type\": \"sum\", "
                 "\"inputs\": {\"terms\": [{\"from\": \"n.out\", \"comment\": 1}]}}}}") ==
          "DG025 expected a connection, found an object | write { \"from\": \"n.out\" }");
    CHECK(answer("{\"format\": \"sinew 1\", \"coment\": 1, \"nodes\": {}}") ==
          "DG007 unknown key \"coment\" | did you mean \"comment\"?");
    // A node may be called so.
    CHECK(
        answer("{\"format\": \"sinew 1\", \"nodes\": {\"comment\": {\"type\": \"number\"}, \"s\": {\"type\": \"sum\", "
               "\"inputs\": {\"terms\": [{\"from\": \"comment.out\"}]}}}}") == "taken");
    CHECK(answer("{\"format\": \"sinew 1\", \"nodes\": {\"comment\": {\"inputs\": {}}}}") ==
          "DG008 a node needs a \"type\" in quotes");
}
