// `sinew bench scene`: the frames of graphs under each linear solver, with their own tets or others.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tools/bench/scene.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/open_graph.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace sinew::cli {

namespace {

bench::SceneVariant as_it_is(const Invocation& in, const std::string& file) {
    const auto graph = engine::load_graph(nodes::make_registry(), file).graph;
    const int first = start_frame(*graph, upstream_of(*graph, {default_plug(*graph).node}));
    const int frames =
        in.arguments.whole_number("--steps", in.arguments.has("--quick") ? 4 : graph->timing().end - first, 1);
    return {.graph = graph, .solver = default_plug(*graph).node, .element = {}, .first = first, .last = first + frames};
}

std::vector<std::string> all_solvers() {
    return {std::begin(bench::all_linear_solvers), std::end(bench::all_linear_solvers)};
}

int turns(const Invocation& in) { return in.arguments.has("--quick") ? 1 : 5; }

} // namespace

bench::SceneBench measure_scene(const Invocation& in, const std::string& file) {
    return bench::run_scene(as_it_is(in, file), all_solvers(), turns(in), run_options(in));
}

std::vector<bench::SceneBench> measure_rig(const Invocation& in, const std::string& file) {
    const bool quick = in.arguments.has("--quick");
    std::vector<bench::SceneBench> out;
    for (const auto& [element, size] : std::vector<std::pair<std::string, double>>{
             {"linear", 1}, {"linear", 0.5}, {"linear", 1.0 / 3}, {"quadratic", 1}}) {
        bench::SceneVariant variant = as_it_is(in, file);
        variant.element = element, variant.tet_scale = size;
        variant.last = variant.first + (quick ? 1 : 9);
        out.push_back(bench::run_scene(variant, {"Direct", "Iterative", "Auto"}, 1, run_options(in)));
        if (quick) break;
    }
    return out;
}

ExitCode bench_scene(const Invocation& in) {
    const std::vector<std::string> files = graph_files(in.arguments.operands_from(1));
    if (files.empty()) throw UsageError("scene needs graph files, or folders with graph files in them.");
    const std::vector<std::string> solvers = words(in, "--solvers", all_solvers(), all_solvers());
    const std::vector<std::string> elements = words(in, "--elements", {"linear", "quadratic"}, {""});
    const std::vector<double> sizes = tet_scales(in, {1});
    std::vector<bench::SceneBench> results;
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const std::string& file : files)
        for (const std::string& element : elements)
            for (const double size : sizes) {
                bench::SceneVariant variant = as_it_is(in, file);
                variant.element = element, variant.tet_scale = size;
                results.push_back(bench::run_scene(variant, solvers, turns(in), run_options(in)));
                for (const auto& row : bench::scene_json(results.back())) rows.push_back(row);
            }
    const bench::SceneBench& r = results.front();
    if (results.size() > 1)
        print_result(in, "scene", bench::scenes_table(results), rows,
                     "frames after the start of each, medians of " + std::to_string(r.turns));
    else
        print_result(in, "scene", bench::scene_table(r), rows,
                     r.name + ", " + std::to_string(r.tets) + " tets, frames " + std::to_string(r.first + 1) + " to " +
                         std::to_string(r.last) + ", medians of " + std::to_string(r.turns));
    return done;
}

} // namespace sinew::cli
