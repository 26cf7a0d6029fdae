// What graphs of many nodes cost before anything is simulated: to load, to plan a frame, to edit.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sinew::bench {

struct GraphRow {
    std::string
        shape; ///< chain: each node reads the one before; wide: one reads all; included: 100 parts under prefixes
    int nodes = 0;
    double megabytes = 0; ///< of text, what is included counted once
    double load = 0;      ///< [s] from text to graph, all checks
    double first = 0;     ///< [s] the first frame
    double frame = 0;     ///< [s] a further frame: every value is another one; median
    double plan = 0;      ///< [s] a frame whose results are there: what planning takes; median
    double edit = 0;      ///< [s] to set one input; median
    std::string digest;   ///< of the last frame's result
};

struct GraphScale {
    std::vector<GraphRow> rows;
};

/// Throws solver::Stopped, engine::Failure.
GraphScale run_graph_scale(const RunOptions& options);

Table graph_scale_table(const GraphScale& result);
nlohmann::ordered_json graph_scale_json(const GraphScale& result);

} // namespace sinew::bench
