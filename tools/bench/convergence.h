// Orders of convergence: error against the cell size for every mesh study, error against the time step for every
// integrator.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/run_options.h"
#include "tools/bench/svg_plot.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

struct ConvergenceLevel {
    std::string name; ///< "16x4x4" or "1/96"
    double h = 0;     ///< [m] in space, [s] in time
    double error = 0; ///< relative to the reference in space; of the tip over the bar's length in time
    double order = 0; ///< from the level before; NaN for the first
    double seconds = 0;
};

struct ConvergenceRow {
    bool in_time = false;
    std::string name, setting, quantity;
    double expected_order = 2; ///< of the element or scheme where the solution is smooth
    std::vector<ConvergenceLevel> levels;
};

/// Throws solver::Error and solver::Stopped.
std::vector<ConvergenceRow> run_convergence(const RunOptions& options);

Table convergence_table(const std::vector<ConvergenceRow>& rows);
nlohmann::ordered_json convergence_json(const std::vector<ConvergenceRow>& rows);
/// Relative error against cell size (`in_time` false), or error against the time step.
Plot convergence_plot(const std::vector<ConvergenceRow>& rows, bool in_time);

} // namespace sinew::bench
