// Linear against quadratic tets on a scene of the user's: the motion's error against what a frame takes, over tet
// sizes. The scene itself under the finest quadratic tets stands for the truth: this is self-convergence, not accuracy.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"
#include "tools/bench/run_options.h"
#include "tools/bench/svg_plot.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

struct ElementRow {
    std::string element; ///< value of zTet.element
    double scale = 1;    ///< of all tet sizes
    std::int64_t tets = 0, unknowns = 0;
    double cpu_ms_per_frame = 0; ///< of the whole process, without the set-up
    double newton_per_frame = 0;
    int unconverged = 0, inverted = 0;
    /// Distances from the finest quadratic tets at the last frame, over the vertices of all tissues, in millimetres;
    /// NaN for those themselves.
    double rms_mm = 0, most_mm = 0;
};

struct ElementBench {
    std::string name, tissue; ///< of the graph file; the one tissue that takes part, or empty for all
    int first = 0, last = 0;
    std::vector<ElementRow> rows;
};

/// Frames first…last of `solver`; with a `tissue`, all others are disabled. `scales` of tet sizes fall; the last one,
/// with quadratic tets, is the reference.
/// Throws engine::Failure (a zTet whose tetSize is no plain number), SolveFailure and Cancelled.
ElementBench run_elements(std::shared_ptr<const engine::Graph> graph, const std::string& solver,
                          const std::string& tissue, int first, int last, const std::vector<double>& scales,
                          const RunOptions& options);

Table elements_table(const ElementBench& result);
nlohmann::ordered_json elements_json(const ElementBench& result);
Plot elements_plot(const ElementBench& result);

} // namespace sinew::bench
