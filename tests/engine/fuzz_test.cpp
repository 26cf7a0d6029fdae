// Any bytes give a graph or a Failure, never a crash; and the locale changes nothing.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/layout.h"
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>
#include <clocale>
#include <locale>
#include <random>

using namespace toys;

namespace {

const std::string seed_text =
    R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 9},
  "includes": {"a": {"file": ")" SINEW_SOURCE_DIR
    R"(/tests/engine/formats/1_part.json", "overrides": {"ten.value": {"value": 3, "unit": "kPa"}}}}, "nodes": {
  "n": {"type": "number", "inputs": {"value": {"keys": [[1, 2.5], [3, 4, {"in": 1e-3, "out": 0}]], "interp": "smooth"}, "axis": {"value": [1, 2, 3], "unit": "cm"},
        "mode": "double", "times": 3, "weights": [0, 0.5, 1]}},
  "s": {"type": "sum", "inputs": {"terms": [{"from": "n.out"}, {"from": "a.eleven.out"}]}}, "odd": {"type": "mystery", "x": [null, true, "\u00e9\n"]},
  "sim": {"type": "sim", "inputs": {"target": {"from": "s.out"}, "substeps": 2}}}, "editor": {"a": 1}})";

// Loads, and if that works also writes and loads again, and lays out, which changes nothing of it.
void exercise(const std::shared_ptr<const Registry>& types, const std::string& text) {
    try {
        const auto g = read_graph(types, text, "fuzz.json").graph;
        const std::string written = write_graph(*g);
        REQUIRE(write_graph(*read_graph(types, written, "fuzz.json").graph) == written);
        const std::string neat = laid_out(text);
        REQUIRE(laid_out(neat) == neat);
        // What is kept as it stood, like the editor's data, stands otherwise.
        REQUIRE(laid_out(write_graph(*read_graph(types, neat, "fuzz.json").graph)) == laid_out(written));
    } catch (const Failure& f) {
        REQUIRE_FALSE(f.diagnostics().empty());
        for (const Diagnostic& d : f.diagnostics()) {
            REQUIRE_FALSE(d.message.empty());
            REQUIRE(d.spot);
            REQUIRE(d.spot->line >= 1);
        }
    }
}

struct CommaPoint : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

} // namespace

TEST_CASE("mutated bytes load or fail, but never crash") {
    const auto types = registry();
    std::mt19937 random(7);
    const std::string bytes = std::string("{}[]\",:.-+eE0123456789\\/ntrufalsio\n\t \xc3\xa9\xff") + '\0';
    for (int round = 0; round < 6000; ++round) {
        std::string text = seed_text;
        const int changes = 1 + static_cast<int>(random() % 4);
        for (int c = 0; c < changes; ++c) {
            const std::size_t at = random() % text.size();
            switch (random() % 4) {
            case 0:
                text[at] = bytes[random() % bytes.size()];
                break;
            case 1:
                text.erase(at, 1 + random() % 8);
                break;
            case 2:
                text.insert(at, 1, bytes[random() % bytes.size()]);
                break;
            default:
                text.insert(at, text.substr(random() % text.size(), random() % 30));
                break;
            }
            if (text.empty()) text = " ";
        }
        exercise(types, text);
    }
}

TEST_CASE("every prefix of a graph file fails cleanly") {
    const auto types = registry();
    for (std::size_t n = 0; n < seed_text.size(); ++n) exercise(types, seed_text.substr(0, n));
}

TEST_CASE("a locale with a decimal comma changes nothing") {
    const std::string before(std::setlocale(LC_ALL, nullptr));
    const auto types = registry();
    const auto plain = write_graph(*read_graph(types, seed_text, "t.json").graph);
    const std::locale old = std::locale::global(std::locale(std::locale(), new CommaPoint));
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"})
        std::setlocale(LC_ALL, name); // if there is one
    const auto comma = write_graph(*read_graph(types, seed_text, "t.json").graph);
    const auto schema = graph_schema(*types);
    std::string message;
    try {
        read_graph(types,
                   R"({"format": "sinew 1", "nodes": {"n": {"type": "number", "inputs": {"value": -1234567.5}}}})",
                   "t.json");
    } catch (const Failure& f) {
        message = f.diagnostics()[0].message;
    }
    std::locale::global(old);
    std::setlocale(LC_ALL, before.c_str());
    CHECK(comma == plain);
    CHECK(schema == graph_schema(*types));
    CHECK(message == "-1234567.5 is outside [0, 1e+09] Pa");
}
