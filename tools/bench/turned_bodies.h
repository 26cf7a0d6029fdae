// Linear against quadratic tets where the answer is known: beams and panels of the catalogue that stand askew in the
// lattice which zTet makes for them, held by springs as an attachment holds. Error against time, over tet sizes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/run_options.h"
#include "tools/bench/svg_plot.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

struct TurnedRow {
    std::string name; ///< of the case
    std::string element;
    double tet_size = 0; ///< [m]
    std::size_t tets = 0, unknowns = 0;
    double cpu_seconds = 0;          ///< of all steps to the whole load, patterns and symbolic factors included
    double value = 0, reference = 0; ///< a displacement [m]; another code's, converged
    int unconverged = 0, inverted = 0;
    double error() const { return std::abs(value / reference - 1); }
};

/// Throws solver::Error and solver::Stopped.
std::vector<TurnedRow> run_turned_bodies(const RunOptions& options);

Table turned_table(const std::vector<TurnedRow>& rows);
nlohmann::ordered_json turned_json(const std::vector<TurnedRow>& rows);
/// One a case.
std::vector<NamedPlot> turned_plots(const std::vector<TurnedRow>& rows);

} // namespace sinew::bench
