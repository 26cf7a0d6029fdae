// Steps that fail, and what a frame of several sub-steps says of itself.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"
#include "tests/support/trial.h"

using namespace sinew::test;

namespace {

constexpr Integrator schemes[] = {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2};
constexpr double gravity = 8, step_size = 0.05;

/// A free tet, pulled to three times its length: its first step takes many iterations, and its middle just falls.
Trial stretched_tet(Integrator integrator) {
    Trial t(regular_tet(0.1), ElasticLaw::neo_hookean, ElementKind::linear, nowhere, material(1e6, 0.3));
    t.in.integrator = integrator;
    t.in.step_size = step_size;
    t.in.gravity = Vec3(0, 0, -gravity);
    t.in.tolerance_factor = 1e-4;
    t.start();
    t.place(everywhere, [](const Vec3& p) { return Vec3(3 * p.x(), 0.5 * p.y(), p.z()); });
    return t;
}

/// Of four equal masses.
double mean_z(const std::vector<double>& all) { return (all[2] + all[5] + all[8] + all[11]) / 4; }

} // namespace

TEST_CASE("a step that is taken in halves takes as long as it would have whole") {
    for (const Integrator integrator : schemes) {
        Trial t = stretched_tet(integrator);
        INFO("scheme " << static_cast<int>(integrator));
        const double start = mean_z(t.state.x);
        t.in.max_newton_iterations = 4;
        const State whole = advance(*t.workspace, t.state, std::span(&t.in, 1));
        CHECK_FALSE(whole.record.converged);
        CHECK(whole.record.halvings == 0);
        t.in.max_halvings = 12;
        const State halves = advance(*t.workspace, t.state, std::span(&t.in, 1));
        REQUIRE(halves.record.converged);
        CHECK(halves.record.halvings > 0);
        CHECK(halves.record.substeps == 1);
        // Nothing acts on the middle but gravity, which every scheme integrates to this speed in steps of any size.
        CHECK(mean_z(halves.v) == Approx(-gravity * step_size).epsilon(1e-6));
        if (integrator == Integrator::tr_bdf2)
            CHECK(mean_z(halves.x) - start == Approx(-0.5 * gravity * step_size * step_size).epsilon(1e-6));
        CHECK(halves.history.step_size == (integrator == Integrator::backward_euler ? 0 : halves.history.step_size));
        CHECK(halves.history.step_size < step_size);
    }
}

TEST_CASE("a sub-step that fails is not forgotten where the next one converges") {
    Trial t = stretched_tet(Integrator::backward_euler);
    std::vector<StepInputs> both(2, t.in);
    both[0].max_newton_iterations = 1;
    const State failed = advance(*t.workspace, t.state, std::span(both).first(1));
    REQUIRE_FALSE(failed.record.converged);
    const State good = advance(*t.workspace, failed, std::span(both).last(1));
    REQUIRE(good.record.converged);
    const State together = advance(*t.workspace, t.state, both);
    CHECK_FALSE(together.record.converged);
    CHECK(together.record.residual == failed.record.residual);
    CHECK(together.record.substeps == 2);
    CHECK(together.record.newton_iterations == 1 + good.record.newton_iterations);
    CHECK(together.steps == t.state.steps + 2);
    CHECK(together.x == good.x);
}

TEST_CASE("TR-BDF2 keeps the acceleration of a step that has converged, and of no other") {
    Trial t = stretched_tet(Integrator::tr_bdf2);
    const State good = advance(*t.workspace, t.state, std::span(&t.in, 1));
    REQUIRE(good.record.converged);
    REQUIRE(good.history.acceleration.size() == good.x.size());
    // The middle's, whatever the tet does.
    CHECK(mean_z(good.history.acceleration) == Approx(-gravity).epsilon(1e-6));
    t.in.max_newton_iterations = 1;
    const State failed = advance(*t.workspace, t.state, std::span(&t.in, 1));
    REQUIRE_FALSE(failed.record.converged);
    CHECK(failed.history.acceleration.empty());
    CHECK(failed.history.step_size == step_size);
}

TEST_CASE("progress counts sub-steps, and iterations as shares of one") {
    Trial t = stretched_tet(Integrator::backward_euler);
    t.in.max_newton_iterations = 50;
    const std::vector<StepInputs> four(4, t.in);
    std::vector<double> told;
    std::vector<int> iterations;
    StepControl control;
    control.progress = [&](double done, int iteration, double) {
        told.push_back(done), iterations.push_back(iteration);
    };
    REQUIRE(advance(*t.workspace, t.state, four, control).record.converged);
    int substep = -1;
    for (std::size_t i = 0; i < told.size(); ++i) {
        if (iterations[i] == 0) ++substep;
        CHECK(told[i] == Approx((substep + iterations[i] / 50.0) / 4).epsilon(1e-14));
    }
    CHECK(substep == 3);
    CHECK(iterations.size() > 8);
}

TEST_CASE("BDF2 goes on over steps that grow by less than it is stable for") {
    // Variable-step BDF2 is zero-stable for ratios below 1 + sqrt 2 (Hairer, Norsett and Wanner, Solving ODEs I,
    // III.5).
    State s;
    CHECK_FALSE(has_bdf2_history(s, 1));
    s.history.step_size = 1;
    CHECK((has_bdf2_history(s, 0.1) && has_bdf2_history(s, 1) && has_bdf2_history(s, 2.39)));
    CHECK_FALSE((has_bdf2_history(s, 2.41) || has_bdf2_history(s, 3) || has_bdf2_history(s, 20)));
}

TEST_CASE("layers share out masses in their order, each by its weight times its envelope") {
    const TetMesh mesh = regular_tet(0.1);
    TissueInputs values = material(1e5, 0.3, 1000);
    MaterialValues second = values.layers[0], third = values.layers[0];
    second.mass_density = 3000, second.envelope = 0.5;
    third.mass_density = 500, third.envelope = 1;
    values.layers.push_back(second), values.layers.push_back(third);
    Trial t(mesh, ElasticLaw::neo_hookean, ElementKind::linear, nowhere, values);
    t.rest->layer_weights = {{1.0}, {0.5}, {0.4}};
    t.use_backward_euler(0.01);
    t.start();
    t.values().forces.assign(4, Vec3(0, 0, 0.25)); // 1 N in all
    REQUIRE(t.step());
    // A quarter of 3000 over 1000 is 1500, and 0.4 of 500 over that 1100 kg/m^3.
    const double mass = 1100 * 0.001 / (6 * std::sqrt(2.0));
    CHECK(mean_z(t.state.v) == Approx(0.01 / mass).epsilon(1e-9));
}
