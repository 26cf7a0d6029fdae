// What a feature costs that a scene carries and does not use: the same simulation with and without it, in turns. The
// difference must be noise, and the result the same.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace sinew::bench {

struct IdleRow {
    std::string feature;
    double ratio = 1;  ///< time with / time without, median over the turns
    double spread = 0; ///< of the ratio over the turns: half the range of its middle half
    int turns = 0, newton = 0;
    bool same_work = false; ///< as many Newton and linear iterations
    double difference = 0;  ///< farthest vertex between the two results [m]
    bool noise = false;     ///< |ratio - 1| is within what two runs without it differ by
};

struct IdleCost {
    int tets = 0, steps = 0;
    double seconds = 0; ///< of one run without any, median
    double noise_level =
        0; ///< largest |ratio - 1| of two runs without any, of the middle half of the turns, at least 1 %
    std::vector<IdleRow> rows;
};

/// Throws solver::Error and solver::Stopped.
IdleCost run_idle_cost(const RunOptions& options);

Table idle_cost_table(const IdleCost& result);
nlohmann::ordered_json idle_cost_json(const IdleCost& result);

} // namespace sinew::bench
