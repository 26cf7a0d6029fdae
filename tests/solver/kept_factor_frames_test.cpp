// Factors that outlive their frame, in whole simulations: states hold what is needed, and results never depend on what
// a workspace was used for.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "tests/support/swing.h"

#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// A swing of 936 vertices, too large for a factor of its own in every iteration.
const Swing& large_swing() {
    static const Swing swing(ElementKind::linear, 5);
    return swing;
}

/// A fortieth of the swing's pace: what one factor does for many frames.
State next_frame(Workspace& w, const State& s, int frame) {
    const StepInputs in = large_swing().inputs(0.025 * frame);
    return advance(w, s, std::span(&in, 1));
}

} // namespace

TEST_CASE("slow frames share a factor, and each goes on from its saved state to the same bits in any workspace") {
    const Swing& swing = large_swing();
    Workspace straight(swing.scene), used(swing.scene);
    State s = initial_state(*swing.scene, swing.inputs(0));
    CHECK_FALSE(s.linear.factor);
    int factors = 0, with_factor = 0, shared = 0;
    for (int frame = 1; frame <= 10; ++frame) {
        const State before = s;
        s = next_frame(straight, before, frame);
        CHECK(s.record.converged);
        factors += s.record.factorizations;
        with_factor += s.linear.factor != nullptr;
        shared += s.linear.factor && s.linear.factor == before.linear.factor;
        const std::vector<std::byte> expected = save(s);
        Workspace fresh(swing.scene);
        CHECK(save(next_frame(fresh, load(save(before)), frame)) == expected);
        next_frame(used, initial_state(*swing.scene, swing.inputs(0)), 30); // holds a factor of something else now
        CHECK(save(next_frame(used, before, frame)) == expected);
    }
    INFO(factors << " factors, " << with_factor << " frames with one, " << shared << " of them with the last one's");
    CHECK(factors <= 5); // ten without
    CHECK(with_factor >= 6);
    CHECK(shared >= 4);
}

TEST_CASE("a factor in a state is read back whole or refused") {
    const Swing& swing = large_swing();
    Workspace w(swing.scene);
    State s = initial_state(*swing.scene, swing.inputs(0));
    for (int frame = 1; frame <= 10 && !s.linear.factor; ++frame) s = next_frame(w, s, frame);
    REQUIRE(s.linear.factor);
    const std::vector<std::byte> bytes = save(s);
    const State back = load(bytes);
    REQUIRE(back.linear.factor);
    CHECK(back.linear.factor->pattern == s.linear.factor->pattern);
    CHECK(back.linear.factor->values == s.linear.factor->values);
    CHECK(back.linear.factor->without == s.linear.factor->without);
    CHECK(back.linear.late_iterations == s.linear.late_iterations);
    CHECK(back.linear.factor_steps_left == s.linear.factor_steps_left);
    for (const std::size_t less : {std::size_t(1), std::size_t(9), bytes.size() / 2})
        CHECK_THROWS_AS(load(std::span(bytes).first(bytes.size() - less)), Error);
}
