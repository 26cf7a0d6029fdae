// What does not change is not computed again: time comes in through inputs that are set, and equal contents give equal
// results, whichever frame or node they come from.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/matrix_between.h"
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>
#include <stdexcept>

using namespace toys;

namespace {

int computes_over(const std::string& nodes, const Plug& plug, int frames, int threads = 1) {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), nodes);
    Evaluator e({}, threads);
    for (int f = 1; f <= frames; ++f) number(e, g, plug, f);
    return counts->computes;
}

} // namespace

TEST_CASE("a node whose time input is left alone does not change over time") {
    const std::string behind = R"(, "r": {"type": "relay", "inputs": {"in": {"from": "d.out"}}})";
    CHECK(computes_over(R"("d": {"type": "drift"})" + behind, {"r", "out"}, 5) == 2);
    CHECK(computes_over(R"("d": {"type": "drift", "inputs": {"rate": 0}})" + behind, {"r", "out"}, 5) == 2);
    CHECK(computes_over(R"("d": {"type": "drift", "inputs": {"rate": 2}})" + behind, {"r", "out"}, 5) == 10);
    const auto g = graph(registry(), R"("d": {"type": "drift", "inputs": {"rate": 2}})");
    Evaluator e;
    CHECK(number(e, g, {"d", "out"}, 7) == 14);
    const auto still = Edit(g).reset({"d", "rate"}).commit().graph;
    CHECK(number(e, still, {"d", "out"}, 7) == 5);
}

TEST_CASE("a time input that is no input is refused") {
    Registry r;
    static const Output<double> out{.name = "out", .doc = "The number."};
    CHECK_THROWS_AS(r.add({.name = "wrong",
                           .doc = "Wrong.",
                           .outputs = {describe(out)},
                           .uses_time = true,
                           .time_input = "nothing",
                           .compute = [](const Reads&, Writes& w) { w.set(out, 1.0); }}),
                    std::logic_error);
}

TEST_CASE("behind a source that gives the same at another frame nothing is computed again") {
    const std::string nodes = R"("d": {"type": "decade"}, "a": {"type": "relay", "inputs": {"in": {"from": "d.out"}}},
        "b": {"type": "relay", "inputs": {"in": {"from": "a.out"}}})";
    // 30 times the source; once for each of the numbers 0 to 3 that a takes; b takes 1 to 4, of which a did all but 4.
    CHECK(computes_over(nodes, {"b", "out"}, 30) == 30 + 4 + 1);
}

TEST_CASE("frames that are evaluated side by side share what is alike") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("d": {"type": "decade"},
        "a": {"type": "relay", "inputs": {"in": {"from": "d.out"}}},
        "sim": {"type": "sim", "inputs": {"target": {"from": "a.out"}}})");
    Watcher watcher;
    Evaluator e({}, 4, &watcher);
    number(e, g, {"sim", "out"}, 60); // the chain looks 64 frames ahead
    CHECK(counts->computes == 60 + 7);
    CHECK(watcher.reused_count >= 53);
    Evaluator alone({}, 1);
    CHECK(number(e, g, {"sim", "out"}, 60) == number(alone, g, {"sim", "out"}, 60));
}

TEST_CASE("a warning is told again where a result is found by its content") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("d": {"type": "decade"},
        "w": {"type": "warner", "inputs": {"value": {"from": "d.out"}}})");
    Watcher watcher;
    Evaluator e({}, 1, &watcher);
    for (int f = 1; f <= 3; ++f) number(e, g, {"w", "out"}, f);
    CHECK(counts->computes == 3 + 1);
    REQUIRE(watcher.warnings.size() == 3);
    CHECK((watcher.warnings[2].node == "w" && watcher.warnings[2].frame == 3));
}

TEST_CASE("what fails at equal contents fails at each frame, and the first is named") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("d": {"type": "decade"},
        "f": {"type": "failer", "inputs": {"value": {"from": "d.out"}}},
        "sim": {"type": "sim", "inputs": {"target": {"from": "f.out"}}})");
    Evaluator e({}, 4);
    try {
        number(e, g, {"sim", "out"}, 5);
        FAIL("it did not fail");
    } catch (const Failure& failure) {
        REQUIRE(failure.diagnostics().size() == 1);
        CHECK(failure.diagnostics()[0].frame == 1);
    }
}

TEST_CASE("results found by content outlive the eviction of what they were found through") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("d": {"type": "decade"},
        "a": {"type": "relay", "inputs": {"in": {"from": "d.out"}}})");
    Evaluator e({}, 1);
    CHECK(number(e, g, {"a", "out"}, 1) == 1);
    CHECK(number(e, g, {"a", "out"}, 2) == 1);
    e.drop_values();
    CHECK(number(e, g, {"a", "out"}, 2) == 1);
    CHECK(number(e, g, {"a", "out"}, 1) == 1);
    CHECK(counts->computes == 2 + 1 + 2 + 1);
}

TEST_CASE("explain and valid_frames know what is found by content") {
    const auto g = graph(registry(), R"("d": {"type": "decade"},
        "a": {"type": "relay", "inputs": {"in": {"from": "d.out"}}})");
    Evaluator e({}, 1);
    number(e, g, {"a", "out"}, 1);
    const Request third{g, {"a", "out"}, 3, {}};
    CHECK(e.explain(third).readiness == Readiness::would_run); // the source must be computed
    number(e, g, {"d", "out"}, 3);
    CHECK(e.explain(third).readiness == Readiness::ready);
    CHECK(e.valid_frames(third, 1, 4) == std::vector<std::pair<int, int>>{{1, 1}, {3, 3}});
}

TEST_CASE("the observer hears when a node begins and ends, also if it fails") {
    struct : Observer {
        std::string events;
        void begins(const std::string& node, double frame) override {
            events += "<" + node + std::to_string(static_cast<int>(frame));
        }
        void ends(const std::string& node, double) override { events += node + ">"; }
    } watcher;
    const auto g = graph(registry(), R"("a": {"type": "number"}, "f": {"type": "failer"}, "sim": {"type": "sim"})");
    Evaluator e({}, 1, &watcher);
    number(e, g, {"a", "out"}, 3);
    CHECK_THROWS_AS(number(e, g, {"f", "out"}, 3), Failure);
    number(e, g, {"sim", "out"}, 2);
    CHECK(watcher.events == "<a3a><f3f><sim1sim><sim2sim>");
}

TEST_CASE("matrices between two keys") {
    const Matrix4 rest{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    Matrix4 moved = rest;
    moved[3] = -0.3, moved[7] = 0.7;
    Matrix4 part = matrix_between(rest, moved, 0.3);
    CHECK((part[3] == std::lerp(0.0, -0.3, 0.3) && part[7] == std::lerp(0.0, 0.7, 0.3) && part[0] == 1));
    // A quarter turn about z: halfway is an eighth, and lengths stay.
    Matrix4 turned = rest;
    turned[0] = 0, turned[1] = -1, turned[4] = 1, turned[5] = 0;
    part = matrix_between(rest, turned, 0.5);
    CHECK(part[0] == Approx(std::sqrt(0.5)).margin(1e-15));
    CHECK(part[4] == Approx(std::sqrt(0.5)).margin(1e-15));
}

TEST_CASE("matrices between two keys turn about the axis of the screw that joins them, and stretch evenly") {
    const double half = std::sqrt(0.5);
    const Matrix4 rest{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    // A quarter turn about the line through (1, 0) along z, two along it, and three times as long in x.
    const Matrix4 end{0, -1, 0, 1, 3, 0, 0, -1, 0, 0, 1, 2, 0, 0, 0, 1};
    const Matrix4 part = matrix_between(rest, end, 0.5);
    const Matrix4 expected{2 * half, -half, 0, 1 - half, 2 * half, half, 0, -half, 0, 0, 1, 1, 0, 0, 0, 1};
    for (std::size_t i = 0; i < 16; ++i) {
        INFO(i);
        CHECK(part[i] == Approx(expected[i]).margin(1e-14));
    }
}
