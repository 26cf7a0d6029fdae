// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/cantilever.h"

#include "tools/bench/beams.h"

#include <algorithm>
#include <chrono>

namespace sinew::bench {

using solver::Vec3;

namespace {

constexpr double poissons_ratio = 0.45, mass_density = 1000, gravity = 9.81, step_size = 1.0 / 48;
// Enough that every step converges: the peers were measured to convergence too.
constexpr int max_newton_iterations = 50;

solver::StepInputs inputs_of(const CantileverOptions& options) {
    solver::TissueInputs tissue;
    tissue.compression_resistance = 0;
    tissue.layers = {{.youngs_modulus = options.youngs_modulus,
                      .poissons_ratio = poissons_ratio,
                      .mass_density = mass_density,
                      .envelope = 1}};
    solver::StepInputs in;
    in.step_size = step_size;
    in.gravity = {0, -gravity, 0};
    in.max_newton_iterations = max_newton_iterations;
    in.linear_method = options.linear;
    in.bodies = {tissue};
    return in;
}

} // namespace

solver::TissueRest cantilever_rest(int n, solver::ElasticLaw law) {
    const int m = n / 4;
    solver::TissueRest rest = std::move(*make_tissue(box_mesh({0, 0, 0}, {1, 0.25, 0.25}, n, m, m), law));
    rest.fixed_vertices = vertices_where(rest.tets.vertices, [](const Vec3& p) { return p.x() == 0; });
    return rest;
}

CantileverResult run_cantilever(const CantileverOptions& options, std::stop_token stop) {
    using Clock = std::chrono::steady_clock;
    const auto rest = std::make_shared<const solver::TissueRest>(cantilever_rest(options.n, options.law));
    const auto scene = std::make_shared<const solver::Scene>(solver::SceneDescription{{rest}, {}});
    const solver::StepInputs inputs = inputs_of(options);
    solver::StepControl control;
    control.stop = [&stop] { return stop.stop_requested(); };

    CantileverResult out;
    out.tets = static_cast<int>(rest->tets.tets.size());
    out.vertices = static_cast<int>(rest->tets.vertices.size());
    solver::Workspace workspace(scene);
    solver::State state = solver::initial_state(*scene, inputs);
    std::vector<double> seconds, per_newton;
    double newton_of_all = 0, newton = 0, assembly = 0, factor = 0, solve = 0, other = 0, iterations = 0;
    for (int step = 0; step < options.steps; ++step) {
        const auto start = Clock::now();
        state = solver::advance(workspace, state, {&inputs, 1}, control);
        seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
        const solver::StepRecord& r = state.record;
        newton_of_all += r.newton_iterations;
        out.unconverged += !r.converged;
        out.residual_max = std::max(out.residual_max, r.residual);
        if (step == 0 && options.steps > 1) continue; // the first step also finds patterns and coarse grids
        newton += r.newton_iterations;
        assembly += r.seconds_assembly, factor += r.seconds_factor, solve += r.seconds_solve;
        other += r.seconds_other, iterations += r.linear_iterations;
        if (r.newton_iterations > 0) per_newton.push_back(1000 * seconds.back() / r.newton_iterations);
    }

    if (options.at_end) options.at_end();
    const solver::Points now = solver::surface_positions(*scene, state, 0);
    int tip_count = 0;
    for (std::size_t v = 0; v < now.size(); ++v) {
        if (rest->surface[v][0] < 1 - 0.5 / options.n) continue;
        out.tip_y += now[v][1] - rest->surface[v][1];
        ++tip_count;
    }
    out.tip_y /= tip_count;
    out.seconds_per_step_median = median(seconds);
    out.newton_per_step = newton_of_all / options.steps;
    const double to_ms = newton > 0 ? 1000 / newton : 0;
    out.assembly_ms = assembly * to_ms, out.factor_ms = factor * to_ms, out.solve_ms = solve * to_ms;
    out.other_ms = other * to_ms, out.newton_ms_median = median(per_newton);
    out.linear_iterations = newton > 0 ? iterations / newton : 0;
    out.digest = engine::Hasher().add_doubles(state.x).finish();
    return out;
}

double yardstick_seconds(const RunOptions& options) {
    options.tell("cantilever, n 40, E 1e5");
    return run_cantilever({.n = 40, .youngs_modulus = 1e5}, options.stop).seconds_per_step_median;
}

Table cantilever_table(const std::vector<CantileverRun>& runs) {
    Table t{{"tets", "E [Pa]", "s per step (median)", "Newton per step", "assembly [ms]", "factor [ms]", "solve [ms]",
             "tip y [m]", "worst residual", "unconverged", "digest"},
            {}};
    for (const auto& [options, r] : runs)
        t.rows.push_back({std::to_string(r.tets), number(options.youngs_modulus), number(r.seconds_per_step_median, 3),
                          number(r.newton_per_step, 3), number(r.assembly_ms, 3), number(r.factor_ms, 3),
                          number(r.solve_ms, 3), number(r.tip_y, 6), number(r.residual_max, 2),
                          std::to_string(r.unconverged), r.digest.hex()});
    return t;
}

} // namespace sinew::bench
