// A graph file's text after a change: what was changed is there, everything else is byte for byte what it was.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/text_patch.h"

#include <catch2/catch.hpp>

using namespace sinew::engine;

namespace {

/// `from` is replaced by `to` in the text, where it stands once.
std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    REQUIRE(text.find(from, at + 1) == std::string::npos);
    return text.replace(at, from.size(), to);
}

const std::string odd = R"(// of mine
{ "format" : "sinew 1",
  "includes": { "left": {"file": "limb.json", "overrides": { "arm.solver.substeps": 2 /* enough */ }},
                "right": "limb.json", "third": { "file": "limb.json" } },
	"nodes": {
    "flesh": { "type": "zMaterial",
        "inputs": {
            "youngsModulus": { "value": 20.0, "unit": "kPa", "comment": "measured" },   // soft
            "massDensity": 1.06e3, // of water, nearly

            "damping" : 0.10
        } },
    "bare": {"type":"zMaterial"},
    "empty": { "type": "zMaterial", "inputs": {} },
    "move": { "inputs": { "translate": [ 0,  -4.50, 1e0 ], "rotate": { "interp": "smooth",
        "keys": [ [1, 0.0],
                  [24,  90, { "in": 0 }], // up
                  [48, 0.50] ] // and down
      } }, "type": "transform" },
    "fibre": { "type": "zFiber", "inputs": { "excitation": { "keys": [[1, 0], [24.5, 1]] }, "bodies": [ { "from": "a.b" } ] } }
  }
}
)";

std::string put(const std::string& node, const std::string& attribute, const std::string& json,
                const std::string& text = odd) {
    return with_input(text, {node, attribute}, json).value();
}

std::string key(const std::string& node, const std::string& attribute, int frame, const std::string& value,
                const std::string& text = odd) {
    return with_key(text, {node, attribute}, frame, value).value();
}

} // namespace

TEST_CASE("a value is written in place of the one that was there") {
    CHECK(put("flesh", "massDensity", "1100") == with(odd, "1.06e3", "1100"));
    CHECK(put("flesh", "damping", "0.2") == with(odd, "0.10", "0.2"));
    CHECK(put("flesh", "damping", "0.1") == odd); // it is 0.1
    CHECK(put("flesh", "youngsModulus", R"({"value":12,"unit":"kPa"})") == with(odd, "20.0", "12"));
    CHECK(put("flesh", "youngsModulus", R"({"unit":"MPa","value":12})") ==
          with(with(odd, "20.0", "12"), "\"kPa\"", "\"MPa\""));
    CHECK(put("flesh", "youngsModulus", "5000") == with(odd, R"("value": 20.0, "unit": "kPa")", R"("value": 5000)"));
    CHECK(put("flesh", "youngsModulus", R"({"keys":[[1,2]]})") ==
          with(odd, R"("value": 20.0, "unit": "kPa")", R"("keys": [[1, 2]])"));
    CHECK(put("flesh", "massDensity", R"({"value":1.1,"unit":"g/cm^3"})") ==
          with(odd, "1.06e3", R"({ "value": 1.1, "unit": "g/cm^3" })"));
    CHECK(put("move", "translate", "[0, -5, 1]") == with(odd, "-4.50", "-5"));
    CHECK(put("move", "translate", "[0, -4.5]") == with(odd, "[ 0,  -4.50, 1e0 ]", "[0, -4.5]"));
    CHECK(put("fibre", "bodies", R"([{"from":"a.b"},{"from":"c.d"}])") ==
          with(odd, R"({ "from": "a.b" })", R"({ "from": "a.b" }, { "from": "c.d" })"));
}

TEST_CASE("an input that was not written goes behind the last of its node, as those stand there") {
    CHECK(put("flesh", "restScale", "2") == with(odd, "0.10\n", "0.10,\n            \"restScale\": 2\n"));
    CHECK(put("bare", "restScale", "2") ==
          with(odd, R"({"type":"zMaterial"})", R"({"type":"zMaterial","inputs": { "restScale": 2 }})"));
    CHECK(put("empty", "restScale", "2") == with(odd, "\"inputs\": {}", "\"inputs\": { \"restScale\": 2 }"));
    CHECK(put("move", "track", "\"t\"") == with(odd, "// and down\n      }", "// and down\n      }, \"track\": \"t\""));
    // Behind a comment that reaches to the end of the line.
    const std::string commented = "{\"nodes\": {\"a\": {\"inputs\": {\n  \"b\": 1 // one\n}}}}";
    CHECK(put("a", "c", "2", commented) == "{\"nodes\": {\"a\": {\"inputs\": {\n  \"b\": 1, // one\n  \"c\": 2\n}}}}");
    const std::string in_line = "{\"nodes\": {\"a\":\n  {\"inputs\": { \"b\": 1 // one\n}}}}";
    CHECK(put("a", "c", "2", in_line) == "{\"nodes\": {\"a\":\n  {\"inputs\": { \"b\": 1, // one\n  \"c\": 2\n}}}}");
    const std::string in_an_empty_one = "{\"nodes\": {\"a\": {\"inputs\": { // none\n}}}}";
    CHECK(put("a", "c", "2", in_an_empty_one) == "{\"nodes\": {\"a\": {\"inputs\": { \"c\": 2 // none\n}}}}");
    const std::string of_another_system = "{\"nodes\": {\"a\": {\"inputs\": {\r\n\t\"b\": 1\r\n}}}}\r\n";
    CHECK(put("a", "c", "2", of_another_system) ==
          "{\"nodes\": {\"a\": {\"inputs\": {\r\n\t\"b\": 1,\r\n\t\"c\": 2\r\n}}}}\r\n");
}

TEST_CASE("inputs of included nodes go into the overrides of what includes them") {
    CHECK(put("left.arm.solver", "substeps", "4") == with(odd, "2 /* enough */", "4 /* enough */"));
    CHECK(put("left.flesh", "damping", "0.3") == with(odd, "2 /* enough */", "2, /* enough */ \"flesh.damping\": 0.3"));
    CHECK(put("right.flesh", "damping", "0.3") ==
          with(odd, "\"right\": \"limb.json\"",
               R"("right": { "file": "limb.json", "overrides": { "flesh.damping": 0.3 } })"));
    CHECK(put("third.flesh", "damping", "0.3") ==
          with(odd, R"("third": { "file": "limb.json" })",
               R"("third": { "file": "limb.json", "overrides": { "flesh.damping": 0.3 } })"));
}

TEST_CASE("a key is put among the keys, at its place in time") {
    CHECK(key("move", "rotate", 24, "45") == with(odd, "[24,  90, {", "[24,  45, {"));
    CHECK(key("move", "rotate", 1, "0") == odd);
    CHECK(key("move", "rotate", 12, "45") == with(odd, "[24,  90", "[12, 45],\n                  [24,  90"));
    CHECK(key("move", "rotate", -3, "45") == with(odd, "[1, 0.0]", "[-3, 45],\n                  [1, 0.0]"));
    CHECK(key("move", "rotate", 60, "45") ==
          with(odd, "[48, 0.50] ] // and down", "[48, 0.50],\n                  [60, 45] ] // and down"));
    CHECK(key("fibre", "excitation", 24, "0.5") == with(odd, "[24.5, 1]", "[24, 0.5], [24.5, 1]"));
    CHECK(key("fibre", "excitation", 30, "0.5") == with(odd, "[24.5, 1]", "[24.5, 1], [30, 0.5]"));
    // Several at once, as Sinew writes them, are found among those that are there.
    CHECK(put("fibre", "excitation", R"({"keys":[[1,0],[2,0.25],[3,0.5],[24.5,1]]})") ==
          with(odd, "[24.5, 1]", "[2, 0.25], [3, 0.5], [24.5, 1]"));
    CHECK(keys_unit(odd, {"move", "rotate"}) == std::nullopt);
    const std::string in_degrees = R"({"nodes": {"a": {"inputs": {"b": {"keys": [[1, 0]], "unit": "deg"}}}}})";
    CHECK(keys_unit(in_degrees, {"a", "b"}) == "deg");
    CHECK(key("a", "b", 9, "0.5", in_degrees) == with(in_degrees, "[1, 0]", "[1, 0], [9, 0.5]"));
}

TEST_CASE("what the text has no place for is not written") {
    CHECK_FALSE(with_input(odd, {"nobody", "damping"}, "1"));
    CHECK_FALSE(with_input(odd, {"middle.flesh", "damping"}, "1"));
    CHECK_FALSE(with_input(odd, {"flesh", "damping"}, "[1"));
    CHECK_FALSE(with_input("{", {"flesh", "damping"}, "1"));
    CHECK_FALSE(with_key(odd, {"flesh", "massDensity"}, 3, "1"));
    CHECK_FALSE(with_key(odd, {"bare", "massDensity"}, 3, "1"));
    CHECK_FALSE(with_key(odd, {"move", "rotate"}, 3, "]"));
}
