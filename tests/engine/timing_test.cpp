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

TEST_CASE("a simulation whose start is the timing's reads start and frame rate anew where they change") {
    Registry r;
    static const Output<double> out{.name = "out", .doc = "The start frame, and a second a frame."};
    SimulationType<ToyState> t;
    t.base = {.name = "timed", .doc = "Counts time.", .outputs = {describe(out)}};
    t.initial = [](const Reads& in) { return ToyState{100 * in.frame(), 0, 0, 0}; };
    t.advance = [](const ToyState& before, std::span<const SubstepReads> in) {
        return ToyState{before.x + 1 / in.back().end.fps(), 0, 0, before.steps + 1};
    };
    t.publish = [](const ToyState& s, const Reads&, Writes& w) { w.set(out, s.x); };
    t.save = [](const ToyState&) { return std::vector<std::byte>(); };
    t.load = [](std::span<const std::byte>) { return ToyState{}; };
    r.add(std::move(t));
    const auto g = graph(std::make_shared<const Registry>(std::move(r)), R"("s": {"type": "timed"})");
    const auto with = [&](double fps, int start) { return Edit(g).set_timing({fps, start, 100}).commit().graph; };
    Evaluator e({}, 1);
    CHECK(number(e, with(8, 1), {"s", "out"}, 1) == 100);
    CHECK(number(e, with(8, 1), {"s", "out"}, 7) == 100.75);
    CHECK(number(e, with(8, 3), {"s", "out"}, 3) == 300);
    CHECK(number(e, with(8, 3), {"s", "out"}, 7) == 300.5);
    CHECK(number(e, with(4, 1), {"s", "out"}, 7) == 101.5);
}

TEST_CASE("a start frame that differs from the timing's is warned about, with what it costs") {
    CHECK(loaded("\"startFrame\": 1001").notes.empty());
    const auto early = loaded("\"startFrame\": 1").notes;
    REQUIRE(early.size() == 1);
    CHECK((early[0].code == "DG031" && early[0].severity == Severity::warning));
    CHECK((early[0].node == "sim" && early[0].attribute == "startFrame" && early[0].spot->line == 2));
    CHECK(early[0].message.find("1000 frames") != std::string::npos);
    const auto late = loaded("\"startFrame\": 1005").notes;
    REQUIRE(late.size() == 1);
    CHECK(late[0].message == "1005 differs from the graph's timing.start, 1001: the graph's first 4 frames show "
                             "everything as modelled");
    CHECK(loaded("\"startFrame\": 1005000")
              .notes.at(0)
              .message.ends_with("first 10 frames show everything as "
                                 "modelled"));
    CHECK(check_timing(*Edit(loaded("\"startFrame\": 1").graph).reset({"sim", "startFrame"}).commit().graph).empty());
}

TEST_CASE("a simulation that starts too far before the graph's end is told so before it runs") {
    const auto notes = loaded("\"startFrame\": -900000000").notes;
    REQUIRE(notes.size() == 1); // and not also what differs
    CHECK(notes[0].code == "DG104");
    CHECK(notes[0].severity == Severity::error);
    CHECK(notes[0].message == "frame -900000000 is too far before the graph's last, 1010");
    CHECK(notes[0].hint == "leave it out to take the graph's, or start at -9998990 or later");
    REQUIRE(loaded("\"startFrame\": -9998990").notes.size() == 1);
    CHECK(loaded("\"startFrame\": -9998990").notes[0].code == "DG031");
    CHECK(loaded("\"startFrame\": -9998991").notes[0].code == "DG104");
    // Who asks for a frame that is too far hears how far is possible.
    Evaluator e({}, 1);
    try {
        number(e, loaded("").graph, {"sim", "out"}, 10001002);
        FAIL("it was simulated");
    } catch (const Failure& f) {
        CHECK(f.diagnostics().front().code == "DG104");
        CHECK(f.diagnostics().front().hint == "start at most 10000000 frames before the last one that is wanted");
    }
}
