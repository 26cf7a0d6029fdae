// `sinew bench contact`: graphs of bodies that touch, each once, with verdicts.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tools/bench/contact.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/open_graph.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace sinew::cli {

namespace {

bench::ContactScene scene_of(const Invocation& in, const std::string& file) {
    bench::ContactScene s;
    s.graph = engine::load_graph(nodes::make_registry(), file).graph;
    s.solver = default_plug(*s.graph).node;
    const std::vector<std::string> upstream = upstream_of(*s.graph, {s.solver});
    s.first = start_frame(*s.graph, upstream);
    s.last = s.first +
             in.arguments.whole_number("--steps", in.arguments.has("--quick") ? 4 : s.graph->timing().end - s.first, 1);
    const SceneAxes axes = scene_axes(*s.graph, upstream);
    s.units_per_metre = axes.units_per_metre, s.up = axes.up;
    s.bodies = connected(*s.graph, s.solver, "bodies");
    return s;
}

} // namespace

ExitCode bench_contact(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const std::vector<std::string> files = graph_files(in.arguments.operands_from(1));
    if (files.empty()) throw UsageError("contact needs graph files, or folders with graph files in them.");
    std::vector<bench::ContactScene> scenes; // all are read before the first runs
    for (const std::string& file : files) {
        if (options.wants(std::filesystem::path(file).stem().string())) scenes.push_back(scene_of(in, file));
    }
    if (scenes.empty()) throw UsageError("--only: no graph has '" + options.filter + "' in its name.");
    std::vector<bench::ContactRow> rows;
    for (const bench::ContactScene& scene : scenes) rows.push_back(bench::run_contact_scene(scene, options));
    print_result(in, "contact", bench::contact_table(rows), bench::contact_json(rows), bench::contact_summary(rows));
    const bool sound = std::all_of(rows.begin(), rows.end(), [](const auto& r) { return r.is_sound(); });
    return sound ? done : solve_failed;
}

} // namespace sinew::cli
