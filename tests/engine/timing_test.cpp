// Defaults that come from the graph's timing, and the warning where a literal contradicts it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/check.h"
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>

using namespace toys;

namespace {

Loaded loaded(const std::string& inputs) {
    return read_graph(registry(),
                      R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1001, "end": 1010}, "nodes": {
        "sim": {"type": "sim", "inputs": {)" +
                          inputs + "}}}}",
                      "toy.json");
}

} // namespace

TEST_CASE("a simulation starts where the graph's timing does") {
    auto counts = std::make_shared<Counts>();
    const auto g =
        Edit(graph(registry(counts), R"("sim": {"type": "sim"})")).set_timing({24, 1001, 1010}).commit().graph;
    Evaluator e({}, 1);
    number(e, g, {"sim", "out"}, 1003);
    CHECK(counts->advances == 2);
    CHECK(loaded("").notes.empty());
    CHECK(write_graph(*loaded("\"startFrame\": 1001").graph).find("startFrame") == std::string::npos);
    CHECK(write_graph(*loaded("\"startFrame\": 1").graph).find("startFrame") != std::string::npos);
}

TEST_CASE("a start frame that differs from the timing's is warned about, with what it costs") {
    CHECK(loaded("\"startFrame\": 1001").notes.empty());
    const auto early = loaded("\"startFrame\": 1").notes;
    REQUIRE(early.size() == 1);
    CHECK((early[0].code == "DG031" && early[0].severity == Severity::warning));
    CHECK((early[0].node == "sim" && early[0].attribute == "startFrame" && early[0].spot->line == 2));
    CHECK(early[0].message.find("1000 frames") != std::string::npos);
    CHECK(loaded("\"startFrame\": 1005").notes.size() == 1);
    CHECK(check_timing(*Edit(loaded("\"startFrame\": 1").graph).reset({"sim", "startFrame"}).commit().graph).empty());
}
