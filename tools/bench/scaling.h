// How time and memory grow with the number of tets, and what share of the machine's own limits is reached.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/contact_growth.h"
#include "tools/bench/run_options.h"
#include "tools/bench/svg_plot.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

/// What the machine can do, measured in the same run.
struct MachineLimits {
    int threads = 1;
    double dgemm = 0; ///< floating-point operations a second
    double triad = 0; ///< bytes a second of a[i] = b[i] + s c[i], 24 bytes an entry
};

/// The cantilever at one size.
struct ScalingRow {
    int n = 0, tets = 0, vertices = 0, threads = 1, steps = 0, unconverged = 0;
    double newton_ms = 0;                                              ///< one Newton iteration, median over the steps
    double assembly_ms = 0, factor_ms = 0, solve_ms = 0, other_ms = 0; ///< its parts, means
    double linear_iterations = 0;                                      ///< of conjugate gradients per Newton iteration
    double bytes_per_tet = 0; ///< growth of the resident set over scene, workspace and steps; 0 = not measured
    /// Bytes that conjugate gradients must move a second at least, over the triad's; NaN where a factor was used.
    double bandwidth_share = 0;
};

/// The direct solver on the same matrix.
struct FactorRow {
    int n = 0, tets = 0;
    double analyse_ms = 0, factor_ms = 0, solve_ms = 0; ///< factor and solve: medians
    double operations = 0;                              ///< of one factorisation
    double dgemm_share = 0;                             ///< of the rate on one thread
};

struct ScalingResult {
    std::vector<MachineLimits> limits; ///< 1 and 2 threads
    std::vector<ScalingRow> rows;
    std::vector<FactorRow> factors;
    std::vector<ContactGrowthRow> contact;
};

/// The options' filter picks from "cantilever", "factor" and "contact"; with none of them the result is empty. Limits
/// are measured for the first two alone.
/// Throws solver::Error and solver::Stopped.
ScalingResult run_scaling(const RunOptions& options);

Table limits_table(const ScalingResult& result);
Table scaling_table(const ScalingResult& result);
Table factor_table(const ScalingResult& result);
nlohmann::ordered_json scaling_json(const ScalingResult& result);
/// Milliseconds of a Newton iteration against tets.
Plot scaling_plot(const ScalingResult& result);

} // namespace sinew::bench
