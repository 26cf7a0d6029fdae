// Hints that are followed to the letter: a connection is offered only if the graph has it, it fits and gives no cycle.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>

using namespace toys;

namespace {

/// "DG012 expected number, found text | write 3 without quotes"
std::string answer(const std::string& nodes) {
    try {
        read_graph(registry(), R"({"format": "sinew 1", "nodes": {)" + nodes + "}}", "t.json");
    } catch (const Failure& f) {
        const Diagnostic& d = f.diagnostics().front();
        return d.code + " " + d.message + (d.hint.empty() ? "" : " | " + d.hint);
    }
    return "taken";
}

/// Of an input of n, beside m, a number.
std::string answer(const std::string& type, const std::string& input, const std::string& json) {
    return answer(R"("m": {"type": "number"}, "n": {"type": ")" + type + R"(", "inputs": {")" + input + "\": " + json +
                  "}}");
}

const std::string no_number = "DG012 expected number, found text",
                  no_list = "DG012 expected a list of numbers, found text";

} // namespace

TEST_CASE("text with a dot is a connection only where the graph has that output") {
    const std::string form = " | write { \"from\": \"m.out\" }";
    CHECK(answer("number", "value", "\"m.out\"") == no_number + form);
    CHECK(answer("number", "value", "\"m\"") == no_number + form);
    CHECK(answer("number", "value", "\"m.outt\"") == no_number + form); // the only one that fits
    CHECK(answer("number", "value", "\"fat\"") == "taken");             // a preset
    CHECK(answer("number", "value", "\"q.out\"").starts_with("DG016 unknown preset \"q.out\" | "));
    CHECK(answer("number", "axis", "\"m.out\"") == no_list + " | write three numbers: [x, y, z]"); // a number
    CHECK(answer("number", "matrix", "\"m.out\"") == no_list);
    CHECK(answer("relay", "in", "\"m.outt\"") == "DG026 a number can only be connected, found text" + form);
    CHECK(answer("relay", "in", "\"q.out\"") ==
          "DG026 a number can only be connected, found text | write { \"from\": \"node.output\" }");
}

TEST_CASE("numbers as text are answered with the vector that is meant") {
    const auto axis = [](const std::string& json) { return answer("number", "axis", json); };
    for (const char* text : {"-9.8", "-9.8 m", "-980 cm"})
        CHECK(axis("\"" + std::string(text) + "\"") == no_list + " | write three numbers: [0, 9.8, 0]");
    CHECK(axis("\"[0,-9.8,0]\"") == no_list + " | write [0, -9.8, 0]");
    CHECK(axis("\"(0 -9.8 0)\"") == no_list + " | write [0, -9.8, 0]");
    CHECK(axis("\"off\"") == no_list + " | write [0, 0, 0]");
    CHECK(axis("\"1 Pa\"") == no_list + " | write three numbers: [x, y, z]"); // no length
    CHECK(answer("place", "translate", "\"90\"") ==
          no_list + " | write three numbers: [90, 0, 0] if it is the first, [90, 90, 90] if all of them are 90");
}

TEST_CASE("digits in groups and numbers that are too small are told as that") {
    const auto value = [](const std::string& json) { return answer("number", "value", json); };
    CHECK(value("\"12 000 Pa\"") == no_number + " | write \"12000 Pa\"");
    CHECK(value("\"1'200'000\"") == no_number + " | write 1200000");
    CHECK(value("\"12_000 kPa\"") == no_number + " | write \"12000 kPa\"");
    CHECK(value("\"12,000 Pa\"") == no_number + " | write \"12000 Pa\", or \"12 Pa\" if the comma stands for a dot");
    CHECK(value("\"12 00 Pa\"") == "DG015 unknown unit \"00 Pa\" | usual units here: Pa, kPa or MPa");
    CHECK(answer("number", "times", "\"12 000\"") == "DG012 expected integer, found text | write 12000");
    CHECK(value("1e-400") == "taken"); // 0 is one of its numbers
}

TEST_CASE("a list of connections where one value is taken is answered with the connection") {
    const std::string wrong = "DG020 takes one value, not a list of connections | write { \"from\": \"m.out\" }";
    CHECK(answer("number", "value", "[{\"from\": \"m.out\"}]") == wrong);
    CHECK(answer("number", "value", "[{\"from\": \"m.out\"}, {\"from\": \"m.out\"}]") ==
          wrong + ", or another one of them");
    CHECK(answer("number", "axis", "[{\"from\": \"m.out\"}]") ==
          "DG012 expected number, found an object | connect the whole input: { \"from\": \"node.output\" }");
}

TEST_CASE("what depends on a node is not offered as its source") {
    const std::string a = R"("a": {"type": "number"}, )";
    const std::string r = R"(, "r": {"type": "relay", "inputs": {"in": {"from": "s.out"}}}, )"
                          R"("q": {"type": "relay", "inputs": {"in": {"from": "r.out"}}})";
    CHECK(answer(a + R"("s": {"type": "sum", "inputs": {"terms": []}})" + r) ==
          "DG021 has 0 connections and needs at least 1 | connect it: [ { \"from\": \"a.out\" } ]");
    CHECK(answer(R"("s": {"type": "sum", "inputs": {"terms": []}})" + r) ==
          "DG021 has 0 connections and needs at least 1 | connect it: [ { \"from\": \"node.output\" } ]");
}

TEST_CASE("an output of another type is answered with where it belongs or with one that fits") {
    const std::string s =
        R"("a": {"type": "number"}, "s": {"type": "sum", "inputs": {"terms": [{"from": "a.out"}]}}, )";
    CHECK(answer(s + R"("r": {"type": "relay", "inputs": {"in": {"from": "s.text"}}})") ==
          "DG024 takes number, but s.text is text | did you mean \"s.out\"?");
}
