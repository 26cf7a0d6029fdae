// The layout of graph files: what moves, what stays, and that a second time nothing changes.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/json_text.h"
#include "engine/format/layout.h"
#include "tests/support/engine_toys.h"
#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace toys;

namespace {

std::string once(const std::string& text) {
    REQUIRE(parse_json(text).problems.empty());
    const std::string out = laid_out(text);
    CHECK(laid_out(out) == out);
    // Another reader finds the same in it, the order of keys included.
    CHECK(nlohmann::ordered_json::parse(out, nullptr, true, true).dump() ==
          nlohmann::ordered_json::parse(text, nullptr, true, true).dump());
    return out;
}

} // namespace

TEST_CASE("a graph file is laid out by levels, and what fits stands on one line") {
    CHECK(once(R"({"nodes":{"b":{"type":"zBone","inputs":{"mesh":{"from":"m.outMesh"},"l":[1,2 ,3],
"none":{ }}},
"a":{"all":[{"from":"a.b"},{"from":"c.d"}]}},"format":"sinew 1"})") == R"({
  "nodes": {
    "b": { "type": "zBone", "inputs": { "mesh": { "from": "m.outMesh" }, "l": [1, 2, 3], "none": {} } },
    "a": { "all": [ { "from": "a.b" }, { "from": "c.d" } ] }
  },
  "format": "sinew 1"
}
)");
}

TEST_CASE("lines are broken where they are too long or where their author broke them") {
    const std::string text = R"({
  "format": "sinew 1",
  "nodes": {
    "short": { "type": "a", "inputs": {
      "x": 1, "y": [ { "from": "n.out" },
      { "from": "m.out" } ] } },

    "long": { "type": "aTypeWithQuiteALongName", "inputs": { "first": { "from": "aNodeWithALongName.outMesh" }, "x": { "from": "another.outMesh" } } },
    "keyed": { "type": "c",
      "inputs": { "k": { "keys": [[1, 0.123456789], [2, 0.123456789], [3, 0.123456789], [4, 0.123456789], [5, 0.123456789], [6, 0.123456789]] } } }
  }
}
)";
    CHECK(once(text) == R"({
  "format": "sinew 1",
  "nodes": {
    "short": { "type": "a", "inputs": {
        "x": 1,
        "y": [ { "from": "n.out" },
          { "from": "m.out" } ]
      } },

    "long": { "type": "aTypeWithQuiteALongName", "inputs": {
        "first": { "from": "aNodeWithALongName.outMesh" },
        "x": { "from": "another.outMesh" }
      } },
    "keyed": { "type": "c", "inputs": {
        "k": {
          "keys": [[1, 0.123456789], [2, 0.123456789], [3, 0.123456789], [4, 0.123456789], [5, 0.123456789],
            [6, 0.123456789]]
        }
      } }
  }
}
)");
}

TEST_CASE("comments stay beside what they are said of, numbers and texts as they are spelled") {
    const std::string text =
        "\xEF\xBB\xBF// in front\r\n{ // of it all\n\"format\":\"sinew 1\",   // the format\n\n\n"
        "/* of\n   nodes */ \"nodes\" : {\"a\" : {\"type\":\"x\",\"inputs\":{ // one\n"
        "\"v\":1.50e+3,// two\n\"w\" /* odd */ : \"\\u00e4\\/\"\n // three\n}}, \"b\": {} // four\n"
        "// five\n},\n\"editor\":{/* six */}} // seven\n// eight";
    CHECK(once(text) == R"(// in front
{
  // of it all
  "format": "sinew 1", // the format

  /* of
   nodes */
  "nodes": {
    "a": { "type": "x", "inputs": {
        // one
        "v": 1.50e+3, // two
        /* odd */
        "w": "\u00e4\/"
        // three
      } },
    "b": {} // four
    // five
  },
  "editor": {
    /* six */
  }
} // seven
// eight
)");
}

TEST_CASE("what the program writes of a graph is laid out already") {
    const std::string text = R"({ "format": "sinew 1", "nodes": {
"n": { "type": "number", "comment": {"by": "hand"}, "inputs": { "value": { "keys": [[1, 0.1], [5, 3]], "interp": "smooth" }, "axis": [1, 2, 3] } },
"s": { "type": "sum", "inputs": { "terms": [{ "from": "n.out" }, { "from": "n.out" }] } } } })";
    std::string written = write_graph(*read_graph(registry(), text, "t.json").graph);
    written.replace(written.find("{\"by\": \"hand\"}"), 14, "{ \"by\": \"hand\" }"); // kept as it stood
    CHECK(laid_out(written) == written);
}

TEST_CASE("any document is laid out once and for all") {
    // Objects and lists inside each other, with comments and line breaks strewn in.
    unsigned state = 7;
    const auto next = [&](unsigned n) {
        state = state * 1664525u + 1013904223u;
        return (state >> 16) % n;
    };
    const std::function<std::string(int)> value = [&](int depth) -> std::string {
        const char* blanks[] = {"", " ", "\n", "\n\n", " // c\n", "/* c */", "\n// c\n"};
        const auto blank = [&] { return std::string(blanks[next(7)]); };
        const unsigned kind = depth > 4 ? 2 + next(3) : next(5);
        std::string out;
        if (kind > 1) return kind == 2 ? "1.0e2" : kind == 3 ? "\"a longer text, for lines to be broken\"" : "true";
        const unsigned count = next(5);
        for (unsigned i = 0; i < count; ++i)
            out += (i > 0 ? "," : "") + blank() +
                   (kind == 0 ? "\"k" + std::to_string(i) + "\"" + blank() + ":" + blank() : "") + value(depth + 1) +
                   blank();
        return (kind == 0 ? "{" : "[") + out + blank() + (kind == 0 ? "}" : "]");
    };
    for (int i = 0; i < 300; ++i) once("{\"a\":" + value(0) + "}");
}
