// A steady step takes nothing from the heap: what it needs lives in the workspace.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/count_allocations.h"
#include "tests/support/swing.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// What `steps` more steps take from the heap, after the first ones have filled the workspace. A frame of several steps
/// returns one new state, so the difference between a long and a short frame is what the steps themselves take.
Allocations of_steps(const Swing& swing, int steps, const std::function<void(StepInputs&)>& change) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    std::vector<StepInputs> inputs;
    for (int k = 0; k < steps + 8; ++k) {
        inputs.push_back(swing.inputs(0.5 * k));
        inputs.back().step_size = 1.0 / 48;
        change(inputs.back());
    }
    Workspace w(swing.scene);
    const std::span<const StepInputs> all(inputs);
    const State start = advance(w, initial_state(*swing.scene, inputs.front()), all.subspan(0, 4));
    Allocations taken[2];
    for (const bool longer : {false, true}) {
        const std::size_t count = 4 + (longer ? static_cast<std::size_t>(steps) : 0);
        const Allocations before = allocations();
        const State end = advance(w, start, all.subspan(4, count));
        const Allocations after = allocations();
        // What a kept factor was made of is the state's, which not each ends with: itself and its numbers.
        const std::size_t of_factor = end.linear.factor && end.linear.factor != start.linear.factor ? 2 : 0;
        taken[longer] = {after.all - before.all - of_factor,
                         after.by_operator_new - before.by_operator_new - of_factor};
        CHECK(end.record.converged);
        CHECK(end.record.newton_iterations >= static_cast<int>(count));
        CHECK(end.record.halvings == 0);
        CHECK(taken[longer].by_operator_new > 0); // the returned state: else nothing is counted
    }
    return {taken[1].all - taken[0].all, taken[1].by_operator_new - taken[0].by_operator_new};
}

} // namespace

TEST_CASE("a steady step allocates nothing, whatever the scheme, the element and the linear solver") {
    if (!counts_allocations()) return;
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        const Swing swing(kind, kind == ElementKind::linear ? 6 : 3);
        for (const Integrator integrator :
             {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2, Integrator::quasi_static})
            for (const LinearMethod method : {LinearMethod::iterative, LinearMethod::automatic, LinearMethod::direct})
                DYNAMIC_SECTION("element " << int(kind) << ", integrator " << int(integrator) << ", linear solver "
                                           << int(method)) {
                    const Allocations taken = of_steps(swing, 6, [&](StepInputs& in) {
                        in.integrator = integrator;
                        in.linear_method = method;
                    });
                    CHECK(taken.by_operator_new == 0);
                    // CHOLMOD permutes the matrix into fresh memory at each factorisation, and OpenMP adds its teams.
                    if (method == LinearMethod::iterative) CHECK(taken.all == 0);
                }
    }
}

TEST_CASE("a steady step that is told what is at gamma allocates nothing") {
    if (!counts_allocations()) return;
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        const Allocations taken = of_steps(Swing(kind, 3), 6, [](StepInputs& in) {
            in.integrator = Integrator::tr_bdf2;
            in.linear_method = LinearMethod::iterative;
            StepInputs within = in;
            within.gravity *= 1.01;
            in.at_gamma = std::make_shared<const StepInputs>(std::move(within));
        });
        CHECK(taken.all == 0);
    }
}

TEST_CASE("a steady step with volume conservation allocates nothing") {
    if (!counts_allocations()) return;
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        const Allocations taken = of_steps(Swing(kind, 3), 6, [](StepInputs& in) {
            std::get<TissueInputs>(in.bodies[0]).layers[0].volume_conservation = 1e5;
            in.linear_method = LinearMethod::iterative;
        });
        CHECK(taken.all == 0);
    }
}

TEST_CASE("a steady step with inertial damping allocates nothing") {
    if (!counts_allocations()) return;
    for (const Integrator integrator : {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2}) {
        const Allocations taken = of_steps(Swing(ElementKind::linear, 3), 6, [&](StepInputs& in) {
            in.integrator = integrator;
            in.linear_method = LinearMethod::iterative;
            for (BodyInputs& body : in.bodies)
                if (auto* tissue = std::get_if<TissueInputs>(&body)) tissue->inertial_damping = 0.5;
        });
        // Below zero: a buffer came to its size in the shorter frame, which is taken first.
        CHECK(static_cast<std::int64_t>(taken.by_operator_new) <= 0);
        CHECK(static_cast<std::int64_t>(taken.all) <= 0);
    }
}
