// A simulation looks ahead at what it would read, without a step.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>

using namespace toys;

namespace {

std::shared_ptr<const Graph> stiffer_at_five(const std::shared_ptr<const Registry>& r, const std::string& more = {}) {
    return graph(r, R"("sim": {"type": "sim", "inputs": {"height": 1,
        "stiffness": {"keys": [[1, 1], [4, 1], [5, 2000], [6, 1]]})" +
                        more + "}}");
}

} // namespace

TEST_CASE("a rehearsal refuses what a step would read, and steps nowhere", "[engine]") {
    const auto counts = std::make_shared<Counts>();
    const auto r = registry(counts);
    const auto g = stiffer_at_five(r);
    Watcher watcher;
    Evaluator e({}, 1, &watcher);
    for (const double frame : {0.0, 1.0}) e.rehearse({g, {"sim", ""}, frame}); // nothing is stepped to the start
    CHECK(counts->rehearsals == 0);
    CHECK(counts->initials == 0);
    for (const double frame : {9.0, 2.0, 4.0}) e.rehearse({g, {"sim", ""}, frame});
    CHECK(counts->rehearsals == 3);
    CHECK(counts->initials == 1);
    try {
        e.rehearse({g, {"sim", ""}, 5});
        FAIL("it was not refused");
    } catch (const Failure& failure) {
        REQUIRE(failure.diagnostics().size() == 1);
        const Diagnostic& d = failure.diagnostics().front();
        CHECK(d.code == "FE304");
        CHECK(d.node == "sim");
        CHECK(d.attribute == "stiffness");
        CHECK(d.frame == 5.0);
        CHECK(d.spot);
    }
    CHECK(counts->advances == 0);
    CHECK(watcher.warnings.empty());
    CHECK(number(e, g, {"sim", "out"}, 4) != 1); // it goes on as if nothing had been
    CHECK(counts->initials == 1);
    CHECK(counts->advances == 3);
    CHECK(number(e, g, {"sim", "out"}, 4) == [&] {
        Evaluator other;
        return number(other, g, {"sim", "out"}, 4);
    }());
}

TEST_CASE("a rehearsal reads at the times of sub-steps and stages", "[engine]") {
    const auto counts = std::make_shared<Counts>();
    const auto r = registry(counts);
    Evaluator e;
    // Half of the way to the key.
    CHECK(codes_of([&] { e.rehearse({stiffer_at_five(r), {"sim", ""}, 7}); }).empty());
    const auto halves = graph(r, R"("sim": {"type": "sim", "inputs": {"height": 1, "substeps": 2,
        "stiffness": {"keys": [[4, 1], [4.5, 2000], [5, 1]]}}})");
    CHECK(codes_of([&] { e.rehearse({halves, {"sim", ""}, 4}); }).empty());
    CHECK(codes_of([&] { e.rehearse({halves, {"sim", ""}, 5}); }) == "FE304");
    CHECK(counts->stages.empty());
    CHECK(counts->advances == 0);
}

TEST_CASE("a rehearsal fails with what its inputs fail with, and stops when told to", "[engine]") {
    const auto counts = std::make_shared<Counts>();
    const auto r = registry(counts);
    const auto g = graph(r, R"("bad": {"type": "failer"},
        "sim": {"type": "sim", "inputs": {"height": 1, "target": {"from": "bad.out"}}})");
    Evaluator e;
    CHECK_FALSE(codes_of([&] { e.rehearse({g, {"sim", ""}, 3}); }).empty());
    CHECK(codes_of([&] { e.rehearse({g, {"bad", ""}, 3}); }) == "DG102");
    std::stop_source stop;
    stop.request_stop();
    CHECK_THROWS_AS(e.rehearse({stiffer_at_five(r), {"sim", ""}, 3, stop.get_token()}), Cancelled);
    CHECK(counts->rehearsals == 0);
}
