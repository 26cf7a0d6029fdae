// Work against precision: how long a simulation takes and how far it is off, one choice changed at a time. The problem
// is the released bar, one second at 24 frames a second, whose exact trajectories are known for each mesh and for the
// continuum.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/run_options.h"
#include "tools/bench/svg_plot.h"
#include "tools/bench/table.h"

#include <limits>
#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

struct WorkPoint {
    std::string sweep;   ///< what is changed: "sub-steps", "Newton tolerance", "tet size", "linear solver"
    std::string setting; ///< its value here
    std::string law, element, integrator, linear_solver;
    int cells = 0, substeps = 0;
    double tolerance = 0;     ///< of Newton, relative to the forces at work
    double seconds = 0;       ///< median of `repeats` runs of one second of motion: 5, or 1 where a run is long
    double seconds_least = 0, seconds_most = 0;
    int repeats = 0, newton = 0, unconverged = 0;
    long long linear_iterations = 0;
    /// rms distance of the tip over the 25 frames [m]: to the run of the same mesh that is exact in time (NaN where none
    /// is known), and to the continuum.
    double error_time = std::numeric_limits<double>::quiet_NaN(), error_total = 0;
    bool on_front = false; ///< no other point is both faster and nearer to the continuum of its law
};

/// Throws solver::Error and solver::Stopped.
std::vector<WorkPoint> run_work_precision(const RunOptions& options);

Table work_precision_table(const std::vector<WorkPoint>& points);
nlohmann::ordered_json work_precision_json(const std::vector<WorkPoint>& points);
std::string work_precision_csv(const std::vector<WorkPoint>& points);

struct NamedPlot {
    std::string name; ///< of the file, without ending
    Plot plot;
};
/// Pictures of time against error with the Pareto line: steps and integrators in time alone, everything in total error,
/// Newton's tolerance, linear solvers.
std::vector<NamedPlot> work_precision_plots(const std::vector<WorkPoint>& points);

} // namespace sinew::bench
