// The cantilever of the benchmark page: a box fixed at one end sags under gravity. The same mesh, steps and
// material values as were measured on other engines, straight through the solver's interface.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/digest.h"
#include "solver/step.h"
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <functional>
#include <stop_token>
#include <utility>
#include <vector>

namespace sinew::bench {

struct CantileverOptions {
    int n = 24; ///< cubes along the box; a multiple of 4
    double youngs_modulus = 1e5;
    solver::ElasticLaw law = solver::ElasticLaw::neo_hookean;
    int steps = 20;
    solver::LinearMethod linear = solver::LinearMethod::automatic;
    std::function<void()> at_end =
        {}; ///< called after the last step, while everything is still in memory; may be empty
};

struct CantileverResult {
    int tets = 0, vertices = 0, unconverged = 0;
    double tip_y = 0; ///< mean displacement of the free end [m]
    double seconds_per_step_median = 0, newton_per_step = 0, residual_max = 0;
    double assembly_ms = 0, factor_ms = 0, solve_ms = 0, other_ms = 0; ///< per Newton iteration
    double newton_ms_median = 0;  ///< whole step over its Newton iterations, median over the steps
    double linear_iterations = 0; ///< of conjugate gradients, per Newton iteration
    engine::Digest digest;        ///< of the last positions: a faster wrong answer shows
};

/// Box 1 x 0.25 x 0.25 m along x, every cube cut into the 6 Kuhn tets; the vertices of x = 0 are fixed.
solver::TissueRest cantilever_rest(int n, solver::ElasticLaw law);

/// Runs on the calling thread's TBB arena. Throws solver::Error and solver::Stopped.
CantileverResult run_cantilever(const CantileverOptions& options, std::stop_token stop = {});

/// The yardstick that stands beside times of scenes, so that those of another machine, or of a busier hour, can be
/// compared: the median step of 24,000 tets of 1e5 Pa [s], measured now.
double yardstick_seconds(const RunOptions& options);
/// What it took in the hour in which the times of other engines and the wanted ones were taken [s].
inline constexpr double recorded_yardstick_s = .021;

using CantileverRun = std::pair<CantileverOptions, CantileverResult>;
Table cantilever_table(const std::vector<CantileverRun>& runs);

} // namespace sinew::bench
