// What is clamped where the Hessian is not positive definite: first what presses on surfaces that turn, alone.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/initial_state.h"
#include "solver/integrate/implicit_form.h"
#include "solver/newton/potential.h"
#include "solver/step.h"
#include "solver/terms/contact/contact.h"
#include "tests/support/term_checks.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// The potential of an example's third step, evaluated at the second one's end.
struct Step {
    ExampleScene made;
    StepInputs in;
    State state;
    std::unique_ptr<Potential> potential;
    ImplicitForm form;
    std::vector<Points> bones;

    explicit Step(const TermExample& example)
        : made(example.make(1)) {
        state = initial_state(*made.scene, made.inputs(0));
        Workspace workspace(made.scene);
        for (int k = 1; k <= 2; ++k) {
            in = made.inputs(k);
            state = advance(workspace, state, {&in, 1}, {});
        }
        in = made.inputs(3);
        potential = std::make_unique<Potential>(*made.scene);
        backward_euler_form(state, in.step_size, form);
        potential->take(state, in);
        potential->begin_step(state, in);
        bones = state.bones;
        potential->begin_stage(state, form, bones);
        potential->begin_iteration(state.x);
        std::vector<double> gradient;
        potential->evaluate(state.x, &gradient, nullptr);
    }
    std::vector<double> curvatures(Clamp clamp) {
        BlockMatrix a(potential->pattern());
        potential->assemble(state.x, clamp, a);
        return curvatures(a);
    }
    /// Of contact alone.
    std::vector<double> of_contact(bool project) {
        BlockMatrix a(potential->pattern());
        const_cast<Term*>(potential->find(contact_type))->add_hessian(state.x, project, a);
        a.overlay.finish(a.pattern->rows);
        return curvatures(a);
    }
    /// d·A d for each of a few fixed directions d.
    std::vector<double> curvatures(const BlockMatrix& a) const {
        std::vector<double> out, d(3 * potential->unknown_count()), product(d.size());
        std::mt19937 random(3);
        for (int k = 0; k < 20; ++k) {
            for (double& c : d) c = static_cast<double>(random()) / 2147483648.0 - 1;
            multiply(a, d.data(), product.data());
            double sum = 0;
            for (std::size_t i = 0; i < d.size(); ++i) sum += d[i] * product[i];
            out.push_back(sum);
        }
        return out;
    }
};

} // namespace

TEST_CASE("contact is clamped first, alone: then it holds no direction back, and all else is as it was", "[contact]") {
    int bent = 0;
    for (const TermExample& example : contact_examples()) {
        if (example.name.find("cloth") != std::string::npos) continue; // sheets have directions of their own
        INFO(example.name);
        Step step(example);
        const std::vector<double> exact = step.curvatures(Clamp::none), bending = step.curvatures(Clamp::bending),
                                  contact = step.of_contact(false), clamped = step.of_contact(true);
        CHECK(step.potential->bends());
        for (std::size_t k = 0; k < exact.size(); ++k) {
            CHECK(bending[k] - exact[k] ==
                  Approx(clamped[k] - contact[k]).margin(1e-9 * (std::abs(exact[k]) + std::abs(contact[k]))));
            CHECK(clamped[k] >= -1e-9 * std::abs(contact[k]));
            bent += std::abs(clamped[k] - contact[k]) > 1e-6 * std::abs(contact[k]);
        }
    }
    CHECK(bent > 100);
    for (const TermExample& example : elastic_examples()) {
        Step step(example);
        CHECK_FALSE(step.potential->bends());
        CHECK(step.curvatures(Clamp::bending) == step.curvatures(Clamp::none));
    }
}
