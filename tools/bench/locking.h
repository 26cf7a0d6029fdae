// Work against precision of nearly incompressible bodies at rest: Cook's panel at Poisson's ratios of 0.49 and 0.499,
// and the gravity cantilever with volumeConservation of a thousand times Young's modulus, on finer and finer meshes.
// Here linear tets lock, and the other elements must not.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/run_options.h"
#include "tools/bench/svg_plot.h"
#include "tools/bench/table.h"
#include "tools/bench/turns.h"

#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

struct LockingPoint {
    std::string problem; ///< "Cook's panel, nu 0.49"
    std::string element; ///< "linear", "linear + volumeConservation", "quadratic"
    std::string mesh;    ///< cells, "8x8x2"
    int tets = 0;
    double value = 0;                          ///< displacement that is asked for [m]
    double converged = 0, converged_error = 0; ///< what refinement leads to, and how well that is known [m]
    double error = 0;                          ///< |value / converged - 1|
    Timing timing;                             ///< of the way from no load to the whole load
    int newton = 0, unconverged = 0;
    long long linear_iterations = 0;
    bool on_front = false; ///< no other point of its problem is both faster and nearer
};

/// The options' filter picks problems by name. Throws solver::Error and solver::Stopped.
std::vector<LockingPoint> run_locking(const RunOptions& options);

/// What is asked of them: at most this relative error with at most this many tets.
inline constexpr double promised_error = 0.1;
inline constexpr int modest_tets = 5000;
/// The points with no more tets.
std::vector<LockingPoint> modest_ones(std::vector<LockingPoint> points);

Table locking_table(const std::vector<LockingPoint>& points);
nlohmann::ordered_json locking_json(const std::vector<LockingPoint>& points);
/// One picture a problem, time against error with the Pareto line; a point's number is that of its tets.
std::vector<NamedPlot> locking_plots(const std::vector<LockingPoint>& points);

} // namespace sinew::bench
