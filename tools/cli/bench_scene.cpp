// `sinew bench scene`: the frames of a graph under each linear solver.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tools/bench/scene.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/open_graph.h"

#include <nlohmann/json.hpp>

namespace sinew::cli {

bench::SceneBench measure_scene(const Invocation& in, const std::string& file) {
    const auto graph = engine::load_graph(nodes::make_registry(), file).graph;
    const bool quick = in.arguments.has("--quick");
    const int first = start_frame(*graph, upstream_of(*graph, {default_plug(*graph).node}));
    const int frames = in.arguments.whole_number("--steps", quick ? 4 : graph->timing().end - first, 1);
    return bench::run_scene(graph, default_plug(*graph).node, first, first + frames, quick ? 1 : 5, run_options(in));
}

ExitCode bench_scene(const Invocation& in) {
    const auto file = in.arguments.operand(1);
    if (!file) throw UsageError("scene needs a graph file.");
    if (in.arguments.operand(2)) throw UsageError("scene takes one graph file.");
    const bench::SceneBench r = measure_scene(in, *file);
    print_result(in, "scene", bench::scene_table(r), bench::scene_json(r),
                 r.name + ", " + std::to_string(r.tets) + " tets, frames " + std::to_string(r.first + 1) + " to " +
                     std::to_string(r.last) + ", medians of " + std::to_string(r.turns));
    return done;
}

} // namespace sinew::cli
