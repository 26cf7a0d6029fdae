// Work against precision: how long a simulation takes and how far it is off, one choice changed at a time. The problem
// is the released bar, one second at 24 frames a second. For three laws another code gave its exact trajectories, for
// each mesh and for the continuum; the other laws are measured against runs of their own with far smaller steps.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/run_options.h"
#include "tools/bench/svg_plot.h"
#include "tools/bench/table.h"
#include "tools/bench/turns.h"

#include <limits>
#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

struct WorkPoint {
    std::string sweep;   ///< what is changed: "sub-steps", "Newton tolerance", "tet size", "law", "linear solver"
    std::string setting; ///< its value here
    std::string law, element, integrator, linear_solver;
    int cells = 0, substeps = 0;
    double tolerance = 0; ///< of Newton, relative to the forces at work
    Timing timing;        ///< of one second of motion
    int newton = 0, unconverged = 0;
    long long linear_iterations = 0;
    std::string
        exact_in_time; ///< where the run on the same mesh that is exact in time is from; empty where there is none
    /// rms distance of the tip over the 25 frames [m]: to that run, and to the continuum; NaN where it is not known.
    double error_time = std::numeric_limits<double>::quiet_NaN(),
           error_total = std::numeric_limits<double>::quiet_NaN();
    bool on_front = false; ///< no other point is both faster and nearer to the continuum of its law
};

/// Throws solver::Error and solver::Stopped.
std::vector<WorkPoint> run_work_precision(const RunOptions& options);

Table work_precision_table(const std::vector<WorkPoint>& points);
nlohmann::ordered_json work_precision_json(const std::vector<WorkPoint>& points);

/// Pictures of time against error with the Pareto line: integrators and sub-steps, Newton's tolerance, all choices in
/// total error, laws.
std::vector<NamedPlot> work_precision_plots(const std::vector<WorkPoint>& points);

} // namespace sinew::bench
