// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/hessian_choice.h"

#include "solver/error.h"
#include "solver/linear/cholesky.h"

#include <chrono>
#include <cmath>
#include <numeric>

namespace sinew::bench {

using namespace solver;

namespace {

constexpr int most_iterations = 200;

/// Moves x along `direction` until the value falls enough, by the solver's own rule. False if it does not.
bool line_search(Potential& potential, const std::vector<double>& direction, double slope, std::vector<double>& x,
                 double& value, std::vector<double>& gradient, std::vector<BodyForces>& forces) {
    const std::vector<int>& vertex_of = potential.numbering().vertex_of_unknown;
    const double before = value, rounding = potential.energy_rounding();
    double t = 1;
    for (int trial = 0; trial < 40; ++trial, t *= 0.5) {
        std::vector<double> there = x;
        for (std::size_t u = 0; u < vertex_of.size(); ++u)
            for (std::size_t c = 0; c < 3; ++c)
                there[3 * static_cast<std::size_t>(vertex_of[u]) + c] += t * direction[3 * u + c];
        value = potential.evaluate(there, &gradient, &forces);
        if (std::isfinite(value) && value <= before + 1e-4 * t * slope + rounding) {
            x = std::move(there);
            return true;
        }
    }
    return false;
}

} // namespace

HessianRun solve_step(const Scene& scene, const State& before, const StepInputs& inputs, bool always_project,
                      const std::stop_token& stop) {
    Potential potential(scene);
    potential.take(before, inputs);
    BlockMatrix hessian(potential.pattern());
    Cholesky factor(potential.pattern());
    std::vector<double> gradient(3 * potential.unknown_count()), direction(gradient.size());
    std::vector<BodyForces> forces;
    ImplicitForm form;

    HessianRun out;
    const auto start = std::chrono::steady_clock::now();
    potential.begin_step(before, inputs);
    inputs.integrator == Integrator::quasi_static ? quasi_static_form(before, form)
                                                  : backward_euler_form(before, inputs.step_size, form);
    potential.begin_stage(before, form, before.bones);
    out.x = before.x;
    double value = potential.evaluate(out.x, &gradient, &forces);
    const auto reached = [&] { return potential.balance(out.x, forces, 1e-6 * inputs.tolerance_factor).reached; };
    while (!(out.converged = reached()) && out.newton < most_iterations) {
        if (stop.stop_requested()) throw Stopped();
        bool definite = false;
        for (const bool project : {false, true}) {
            if (definite || (always_project && !project)) continue;
            potential.assemble(out.x, project, hessian);
            definite = factor.factorize(hessian);
        }
        if (!definite) break;
        factor.solve(gradient.data(), direction.data());
        for (double& d : direction) d = -d;
        const double slope = std::inner_product(gradient.begin(), gradient.end(), direction.begin(), 0.0);
        ++out.newton;
        if (!line_search(potential, direction, slope, out.x, value, gradient, forces)) break;
    }
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return out;
}

} // namespace sinew::bench
