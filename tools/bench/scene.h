// The frames of a scene under linear solvers of its zSolver, in turns: what they take, and whether they give the same
// motion. The first of them is the yardstick; "Plain" is made for that: one CHOLMOD factorisation of the whole matrix
// in every Newton iteration.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::bench {

struct SceneRow {
    std::string solver;      ///< value of zSolver.solver
    double ms_per_frame = 0; ///< of the solver, median over the turns of the mean over the frames
    /// The same if the cantilever took what it did where wanted times were recorded; none of quick runs.
    std::optional<double> scaled_ms;
    double assembly_ms = 0, factor_ms = 0, solve_ms = 0, other_ms = 0; ///< of it, in the turn that is the median
    double speedup = 1; ///< the yardstick's time / this one's, median over the turns
    double newton_per_frame = 0, linear_per_frame = 0, factors_per_frame = 0, residual_max = 0;
    int unconverged = 0, inverted = 0; ///< frames, and the most tets in one
    double bytes_per_tet = 0;          ///< growth of the resident set over the frames of the first turn
    double difference = 0;             ///< farthest vertex from the yardstick's, over all frames, in scene units
};

/// What runs: some frames of a graph, with its tets as they are or others.
struct SceneVariant {
    std::shared_ptr<const engine::Graph> graph;
    std::string solver;  ///< a zSolver of the graph
    std::string element; ///< of all zTets; empty: as in the graph
    double tet_scale = 1;
    int first = 0, last = 0;
};

struct SceneBench {
    std::string name; ///< of the graph file, without its folder
    std::string element;
    double tet_scale = 1;
    int first = 0, last = 0, turns = 0;
    std::int64_t tets = 0, unknowns = 0;
    /// The cantilever's step (cantilever.h) beside them, mean of before and after; none of quick runs.
    std::optional<double> cantilever_ms;
    std::vector<SceneRow> rows;
};

inline constexpr std::string_view all_linear_solvers[] = {"Plain", "Direct", "Iterative", "Auto"};

/// Under each of `solvers`, values of zSolver.solver, the yardstick first. Throws engine::Failure, SolveFailure and
/// Cancelled.
SceneBench run_scene(const SceneVariant& variant, const std::vector<std::string>& solvers, int turns,
                     const RunOptions& options);

Table scene_table(const SceneBench& result);
/// Several, each row with its scene and tets.
Table scenes_table(const std::vector<SceneBench>& results);
nlohmann::ordered_json scene_json(const SceneBench& result);

} // namespace sinew::bench
