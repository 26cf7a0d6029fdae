// Files of every format that was ever released load, and say what they said; how texts go from format to format.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/migrate.h"
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>
#include <filesystem>

using namespace toys;

namespace {

const std::string folder = SINEW_SOURCE_DIR "/tests/engine/formats/";

std::string twice(std::string_view text) { return std::string(text) + std::string(text); }
std::string marked(std::string_view text) { return std::string(text) + "!"; }

} // namespace

TEST_CASE("there is a file of every format, and a way from each to the next") {
    for (int format = 1; format <= current_format; ++format) {
        INFO(format);
        CHECK(std::filesystem::exists(folder + std::to_string(format) + ".json"));
        CHECK_NOTHROW(load_graph(registry(), folder + std::to_string(format) + ".json"));
        if (format < current_format) CHECK(migration_from(format) != nullptr);
    }
}

TEST_CASE("the file of format 1 says what it said") {
    const Loaded l = load_graph(registry(), folder + "1.json");
    REQUIRE(l.notes.size() == 1);
    CHECK(l.notes[0].code == "DG010");
    const auto& g = l.graph;
    CHECK(g->timing().fps == 25);
    CHECK(g->timing().start == 3);
    CHECK(g->timing().end == 12);
    Evaluator e;
    // Worked out by hand: a number is value, doubled by mode, times `times`, and so on; a relay adds 1.
    CHECK(number(e, g, {"plain", "out"}, 3) == 1);
    CHECK(number(e, g, {"literals", "out"}, 3) == -15);
    CHECK(number(e, g, {"wrapped", "out"}, 3) == 4);
    CHECK(number(e, g, {"preset", "out"}, 3) == 500);
    CHECK(number(e, g, {"named", "out"}, 3) == 12000);
    CHECK(number(e, g, {"linear", "out"}, 4.5) == 7.5);
    CHECK(number(e, g, {"smooth", "out"}, 4) == 5); // flat at both ends: half way at half time
    CHECK(number(e, g, {"stepped", "out"}, 4.5) == 1);
    CHECK(number(e, g, {"stepped", "out"}, 5) == 2);
    CHECK(number(e, g, {"list", "out"}, 5) == 11 + 21 + 11);
    const Value axis = std::get<Value>(g->find("wrapped")->inputs.at("axis"));
    CHECK(axis.as<Vec3>()[2] == 0.03);
    CHECK(g->find("unknown")->raw_json == R"({ "type": "ofAnotherProgram", "anything": [ { "from": "list.out" } ] })");
    CHECK(g->editor_json() == R"({ "positions": { "list": [1, 2] } })");
    // Nothing that people wrote is lost when it is written.
    const std::string written = write_graph(*g);
    for (const char* text : {"// A file of format 1", "// all defaults", "/* wires: one", "\"as it is\"", "\"four\"",
                             R"("comment": { "by": "hand", "list": [1, "two", null] })", R"("overrides": {)"})
        CHECK(written.find(text) != std::string::npos);
    CHECK(write_graph(*read_graph(registry(), written, folder + "1.json").graph) == written);
}

TEST_CASE("a text goes through each format on its way") {
    const MigrationStep steps[] = {{1, twice}, {2, marked}, {4, twice}};
    CHECK(migrated("a", 1, 3, steps) == "aa!");
    CHECK(migrated("a", 2, 3, steps) == "a!");
    CHECK(migrated("a", 3, 3, steps) == "a");
    CHECK_FALSE(migrated("a", 1, 4, steps)); // nothing leads from 3 to 4
    CHECK_FALSE(migrated("a", 0, 1, steps));
}
