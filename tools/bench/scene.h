// The frames of a scene under each linear solver of its zSolver, in turns: what they take, and whether they give the
// same motion. "Plain" is the yardstick: one CHOLMOD factorisation of the whole matrix in every Newton iteration.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

struct SceneRow {
    std::string solver;      ///< value of zSolver.solver
    double ms_per_frame = 0; ///< of the solver, median over the turns of the mean over the frames
    double assembly_ms = 0, factor_ms = 0, solve_ms = 0, other_ms = 0; ///< of it, in the turn that is the median
    double speedup = 1; ///< Plain's time / this one's, median over the turns
    double newton_per_frame = 0, residual_max = 0;
    int unconverged = 0;
    double difference = 0; ///< farthest vertex from Plain's, over all frames, in scene units
};

struct SceneBench {
    std::string name; ///< of the graph file, without its folder
    int first = 0, last = 0, turns = 0;
    std::int64_t tets = 0;
    std::vector<SceneRow> rows;
};

/// Frames first…last of `solver` (a zSolver of the graph). Throws engine::Failure, SolveFailure and Cancelled.
SceneBench run_scene(std::shared_ptr<const engine::Graph> graph, const std::string& solver, int first, int last,
                     int turns, const RunOptions& options);

Table scene_table(const SceneBench& result);
nlohmann::ordered_json scene_json(const SceneBench& result);

} // namespace sinew::bench
