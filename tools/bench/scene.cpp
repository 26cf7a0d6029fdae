// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/scene.h"

#include "engine/evaluator.h"
#include "nodes/values.h"
#include "tools/bench/beams.h"
#include "tools/bench/cantilever.h"
#include "tools/bench/resident.h"
#include "tools/bench/tet_variants.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace sinew::bench {

namespace {

using Motion = std::vector<std::vector<std::shared_ptr<const solver::Points>>>; ///< [frame][mesh]

struct Pass {
    std::array<double, 4> ms{}; ///< assembly, factor, solve, other, per frame
    double total() const { return ms[0] + ms[1] + ms[2] + ms[3]; }
};

/// Simulates all frames from the start; fills in what does not vary from turn to turn.
Pass pass_of(const std::shared_ptr<const engine::Graph>& graph, const std::string& node, const RunOptions& options,
             SceneRow& row, SceneBench& scene, Motion& motion) {
    motion.clear();
    const bool measures_memory = row.bytes_per_tet == 0; // in one turn: the heap is given back by it
    const double before = measures_memory ? resident_bytes() : 0;
    engine::Evaluator evaluator;
    Pass pass;
    row.newton_per_frame = row.linear_per_frame = row.factors_per_frame = 0, row.unconverged = 0;
    const int frames = scene.last - scene.first; // the first one is the start
    for (int frame = scene.first; frame <= scene.last; ++frame) {
        const engine::Value meshes =
            evaluator.pull({graph, {node, "outMeshes"}, static_cast<double>(frame), options.stop});
        const engine::Value report =
            evaluator.pull({graph, {node, "outReport"}, static_cast<double>(frame), options.stop});
        motion.emplace_back();
        for (const nodes::Mesh& m : meshes.as<nodes::MeshList>().meshes) motion.back().push_back(m.points);
        const auto& solved = report.as<nodes::SolveReport>();
        const solver::StepRecord& r = solved.record;
        scene.tets = solved.tets, scene.unknowns = solved.dofs;
        if (frame == scene.first) continue;
        const std::array seconds{r.seconds_assembly, r.seconds_factor, r.seconds_solve, r.seconds_other};
        for (std::size_t k = 0; k < seconds.size(); ++k) pass.ms[k] += 1e3 * seconds[k] / frames;
        row.newton_per_frame += static_cast<double>(r.newton_iterations) / frames;
        row.linear_per_frame += static_cast<double>(r.linear_iterations) / frames;
        row.factors_per_frame += static_cast<double>(r.factorizations) / frames;
        row.inverted = std::max(row.inverted, r.inverted);
        row.residual_max = std::max(row.residual_max, r.residual);
        row.unconverged += !r.converged;
    }
    if (measures_memory) row.bytes_per_tet = std::max(0.0, resident_bytes() - before) / static_cast<double>(scene.tets);
    return pass;
}

double farthest(const Motion& a, const Motion& b) {
    double out = 0;
    for (std::size_t frame = 0; frame < a.size(); ++frame)
        for (std::size_t mesh = 0; mesh < a[frame].size(); ++mesh)
            for (std::size_t v = 0; v < a[frame][mesh]->size(); ++v)
                out = std::max(out, ((*a[frame][mesh])[v] - (*b[frame][mesh])[v]).norm());
    return out;
}

} // namespace

SceneBench run_scene(const SceneVariant& variant, const std::vector<std::string>& solvers, int turns,
                     const RunOptions& options) {
    SceneBench out;
    out.first = variant.first, out.last = variant.last, out.turns = turns;
    out.element = variant.element, out.tet_scale = variant.tet_scale;
    const auto graph = with_tets(variant.graph, variant.element, variant.tet_scale);
    out.name = std::filesystem::path(graph->file()).filename().string();
    std::vector<std::vector<Pass>> passes(solvers.size());
    Motion yardstick, motion;
    if (!options.quick) out.cantilever_ms = 1e3 * yardstick_seconds(options) / 2;
    for (int turn = 0; turn < turns; ++turn)
        for (std::size_t k = 0; k < solvers.size(); ++k) {
            options.tell(out.name + (out.element.empty() ? "" : ", " + out.element) + ", tet sizes x " +
                         number(out.tet_scale, 3) + ", " + solvers[k] + ", turn " + std::to_string(turn + 1) + " of " +
                         std::to_string(turns));
            engine::Edit edit(graph);
            edit.set_json({variant.solver, "solver"}, nlohmann::json(solvers[k]).dump());
            if (turn == 0) out.rows.emplace_back().solver = solvers[k];
            SceneRow& row = out.rows[k];
            passes[k].push_back(
                pass_of(edit.commit().graph, variant.solver, options, row, out, k == 0 ? yardstick : motion));
            if (k > 0 && turn == 0) row.difference = farthest(motion, yardstick);
        }
    if (!options.quick) *out.cantilever_ms += 1e3 * yardstick_seconds(options) / 2;
    for (std::size_t k = 0; k < solvers.size(); ++k) {
        SceneRow& row = out.rows[k];
        std::vector<double> totals, speedups;
        for (std::size_t turn = 0; turn < passes[k].size(); ++turn) {
            totals.push_back(passes[k][turn].total());
            speedups.push_back(passes[0][turn].total() / totals.back());
        }
        row.ms_per_frame = median(totals);
        row.speedup = median(speedups);
        if (out.cantilever_ms) row.scaled_ms = row.ms_per_frame * 1e3 * recorded_yardstick_s / *out.cantilever_ms;
        const Pass& typical = passes[k][static_cast<std::size_t>(
            std::find(totals.begin(), totals.end(), row.ms_per_frame) - totals.begin())];
        row.assembly_ms = typical.ms[0], row.factor_ms = typical.ms[1], row.solve_ms = typical.ms[2],
        row.other_ms = typical.ms[3];
    }
    return out;
}

namespace {

std::vector<std::string> titles(const std::string& yardstick) {
    return {"solver",
            "ms per frame",
            "with the cantilever at " + number(1e3 * recorded_yardstick_s, 3) + " ms",
            yardstick + " / this",
            "assembly [ms]",
            "factor [ms]",
            "solve [ms]",
            "other [ms]",
            "Newton per frame",
            "linear iterations",
            "factors",
            "worst residual",
            "unconverged",
            "inverted",
            "bytes per tet",
            "farthest vertex from " + yardstick + "'s [scene units]"};
}

std::vector<std::string> cells(const SceneRow& r) {
    return {r.solver,
            number(r.ms_per_frame, 3),
            r.scaled_ms ? number(*r.scaled_ms, 3) : "",
            number(r.speedup, 3),
            number(r.assembly_ms, 3),
            number(r.factor_ms, 3),
            number(r.solve_ms, 3),
            number(r.other_ms, 3),
            number(r.newton_per_frame, 3),
            number(r.linear_per_frame, 3),
            number(r.factors_per_frame, 3),
            number(r.residual_max, 2),
            std::to_string(r.unconverged),
            std::to_string(r.inverted),
            number(r.bytes_per_tet, 3),
            number(r.difference, 2)};
}

} // namespace

Table scene_table(const SceneBench& result) {
    Table t{titles(result.rows.front().solver), {}};
    for (const SceneRow& r : result.rows) t.rows.push_back(cells(r));
    return t;
}

Table scenes_table(const std::vector<SceneBench>& results) {
    Table t{{"scene", "element", "tet sizes x", "tets", "unknowns"}, {}};
    const std::vector<std::string> rest = titles(results.front().rows.front().solver);
    t.columns.insert(t.columns.end(), rest.begin(), rest.end());
    for (const SceneBench& s : results)
        for (const SceneRow& r : s.rows) {
            std::vector<std::string> row{s.name, s.element, number(s.tet_scale, 3), std::to_string(s.tets),
                                         std::to_string(s.unknowns)};
            const std::vector<std::string> more = cells(r);
            row.insert(row.end(), more.begin(), more.end());
            t.rows.push_back(std::move(row));
        }
    return t;
}

nlohmann::ordered_json scene_json(const SceneBench& result) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const SceneRow& r : result.rows)
        out.push_back({{"scene", result.name},
                       {"first", result.first},
                       {"last", result.last},
                       {"turns", result.turns},
                       {"element", result.element},
                       {"tet_scale", result.tet_scale},
                       {"tets", result.tets},
                       {"unknowns", result.unknowns},
                       {"solver", r.solver},
                       {"ms_per_frame", r.ms_per_frame},
                       {"scaled_ms", or_null(r.scaled_ms)},
                       {"cantilever_ms", or_null(result.cantilever_ms)},
                       {"speedup", r.speedup},
                       {"assembly_ms", r.assembly_ms},
                       {"factor_ms", r.factor_ms},
                       {"solve_ms", r.solve_ms},
                       {"other_ms", r.other_ms},
                       {"newton_per_frame", r.newton_per_frame},
                       {"linear_per_frame", r.linear_per_frame},
                       {"factors_per_frame", r.factors_per_frame},
                       {"residual_max", r.residual_max},
                       {"unconverged", r.unconverged},
                       {"inverted", r.inverted},
                       {"bytes_per_tet", r.bytes_per_tet},
                       {"difference", r.difference},
                       {"difference_unit", "scene units"}});
    return out;
}

} // namespace sinew::bench
