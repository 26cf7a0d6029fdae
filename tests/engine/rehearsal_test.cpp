// A simulation looks ahead at what it would read, without a step.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>

using namespace toys;

namespace {

/// Too stiff at frames 5 and 6.
std::shared_ptr<const Graph> stiff_at_five(const std::shared_ptr<const Registry>& r, const std::string& more = {}) {
    return graph(r, R"("sim": {"type": "sim", "inputs": {"height": 1,
        "stiffness": {"keys": [[1, 1], [4, 1], [5, 2000], [6, 2000], [7, 1]]})" +
                        more + "}}");
}

void rehearse(Evaluator& e, const std::shared_ptr<const Graph>& g, std::vector<int> frames) {
    e.rehearse({g, {"sim", ""}}, frames);
}

/// What is refused, as "code node.attribute frame".
std::string refused(Evaluator& e, const std::shared_ptr<const Graph>& g, std::vector<int> frames) {
    try {
        rehearse(e, g, std::move(frames));
    } catch (const Failure& failure) {
        REQUIRE(failure.diagnostics().size() == 1);
        const Diagnostic& d = failure.diagnostics().front();
        CHECK(d.spot);
        return d.code + " " + d.node + "." + d.attribute + " " + (d.frame ? std::to_string(*d.frame) : "");
    }
    return {};
}

} // namespace

TEST_CASE("a rehearsal refuses what a step would read, and steps nowhere", "[engine]") {
    const auto counts = std::make_shared<Counts>();
    const auto r = registry(counts);
    const auto g = stiff_at_five(r, R"(, "failAt": 4)");
    Watcher watcher;
    Evaluator e({}, 1, &watcher);
    rehearse(e, g, {-3, 0, 1}); // nothing is stepped to the start
    CHECK(counts->rehearsals == 0);
    CHECK(counts->initials == 0);
    rehearse(e, g, {1, 2, 4, 9});
    CHECK(counts->rehearsals == 3);
    CHECK(counts->initials == 1);
    CHECK(refused(e, g, {2, 5}) == "FE304 sim.stiffness 5.000000");
    CHECK(counts->advances == 0);
    REQUIRE(watcher.warnings.size() == 2); // on the way to 9, and to 5
    CHECK(watcher.warnings.front().frame == 4.0);
    CHECK(watcher.stepped_count == 1);
    // It goes on as if nothing had been.
    const auto plain = stiff_at_five(r);
    Evaluator other;
    CHECK(number(e, plain, {"sim", "out"}, 4) == number(other, plain, {"sim", "out"}, 4));
}

TEST_CASE("a rehearsal names the first frame that is refused, also between those that are looked at", "[engine]") {
    const auto counts = std::make_shared<Counts>();
    const auto g = stiff_at_five(registry(counts));
    Evaluator e;
    CHECK(refused(e, g, {3, 6, 9}) == "FE304 sim.stiffness 5.000000");
    CHECK(counts->rehearsals == 4); // 3, 6, then 4 and 5
    CHECK(refused(e, g, {3, 4, 7, 9}).empty());
}

TEST_CASE("a rehearsal goes on from what the one before returned", "[engine]") {
    const auto counts = std::make_shared<Counts>();
    const auto r = registry(counts);
    Evaluator e;
    rehearse(e, stiff_at_five(r), {2, 3, 4});
    CHECK(counts->rehearsals == 3);
    CHECK(counts->rehearsed_steps == std::vector<std::int64_t>{1, 2, 3});
}

TEST_CASE("a rehearsal reads at the times of sub-steps and stages", "[engine]") {
    const auto counts = std::make_shared<Counts>();
    const auto r = registry(counts);
    Evaluator e;
    const auto halves = graph(r, R"("sim": {"type": "sim", "inputs": {"height": 1, "substeps": 2,
        "stiffness": {"keys": [[4, 1], [4.5, 2000], [5, 1]]}}})");
    CHECK(refused(e, halves, {4}).empty());
    CHECK(refused(e, halves, {5}) == "FE304 sim.stiffness 5.000000");
    CHECK(counts->stages.empty());
    const auto staged = graph(r, R"("sim": {"type": "sim", "inputs": {"height": 1, "scheme": "staged"}})");
    Evaluator stepping;
    number(stepping, staged, {"sim", "out"}, 2);
    const std::vector<double> stepped = std::exchange(counts->stages, {});
    CHECK_FALSE(stepped.empty());
    rehearse(e, staged, {2});
    CHECK(counts->stages == stepped);
}

TEST_CASE("a rehearsal fails with what its inputs fail with, and stops when told to", "[engine]") {
    const auto counts = std::make_shared<Counts>();
    const auto r = registry(counts);
    const auto g = graph(r, R"("bad": {"type": "failer"},
        "sim": {"type": "sim", "inputs": {"height": 1, "target": {"from": "bad.out"}}})");
    Evaluator e;
    std::string pulled = codes_of([&] { number(e, g, {"bad", "out"}, 3); });
    CHECK_FALSE(pulled.empty());
    CHECK(codes_of([&] { rehearse(e, g, {3}); }) == pulled);
    CHECK(codes_of([&] { e.rehearse({g, {"bad", ""}}, std::vector{3}); }) == "DG102");
    std::stop_source stop;
    stop.request_stop();
    CHECK_THROWS_AS(e.rehearse({stiff_at_five(r), {"sim", ""}, 1, stop.get_token()}, std::vector{3}), Cancelled);
    CHECK(counts->rehearsals == 0);
}
