// `sinew bench elements`: linear against quadratic tets, on a scene or on bodies whose answer is known.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/elements.h"
#include "tools/bench/turned_bodies.h"

#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/open_graph.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace sinew::cli {

namespace {

ExitCode known_bodies(const Invocation& in) {
    for (const char* of_graphs : {"--steps", "--sizes"})
        if (in.arguments.has(of_graphs))
            throw UsageError(std::string(of_graphs) + " is for a graph, and none is given.");
    const auto folder = output_folder(in);
    const std::vector<bench::TurnedRow> rows = bench::run_turned_bodies(run_options(in));
    print_result(in, "elements", bench::turned_table(rows), bench::turned_json(rows),
                 "bodies askew in zTet's lattice, against another code's converged values");
    if (folder)
        for (const bench::NamedPlot& p : bench::turned_plots(rows))
            write_file(*folder / (p.name + ".svg"), bench::draw(p.plot));
    return done;
}

constexpr double curve_sizes[] = {2, 1.4, 1, 0.7, 0.5};
constexpr int curve_frames = 32; // of the arm: to where the elbow is bent most for the first time

} // namespace

bench::ElementBench measure_curve(const Invocation& in, const std::string& file) {
    const auto graph = engine::load_graph(nodes::make_registry(), file).graph;
    const std::string solver = default_plug(*graph).node;
    const int first = start_frame(*graph, upstream_of(*graph, {solver}));
    std::vector<double> scales(std::begin(curve_sizes), std::end(curve_sizes));
    int frames = std::min(curve_frames, std::max(graph->timing().end - first, 2));
    if (in.arguments.has("--quick")) scales = {2, 1.5}, frames = 2;
    return bench::run_elements(graph, solver, "", first, first + frames, scales, run_options(in));
}

ExitCode bench_elements(const Invocation& in) {
    const auto file = in.arguments.operand(1);
    if (!file) return known_bodies(in);
    if (in.arguments.operand(2)) throw UsageError("elements takes one graph file.");
    const auto graph = engine::load_graph(nodes::make_registry(), *file).graph;
    const std::string tissue = in.arguments.value("--only").value_or("");
    if (!tissue.empty() && (!graph->find(tissue) || graph->find(tissue)->type_name != "zTissue"))
        throw UsageError("--only: the graph has no zTissue called '" + tissue + "'.");
    const bool quick = in.arguments.has("--quick");
    const auto folder = output_folder(in);
    const int first = start_frame(*graph, upstream_of(*graph, {default_plug(*graph).node}));
    const int frames = in.arguments.whole_number("--steps", quick ? 2 : 12, 2);
    std::vector<double> scales =
        tet_scales(in, quick ? std::vector<double>{2, 1.5} : std::vector<double>{2, 1.4, 1, 0.7, 0.5, 0.35});
    std::sort(scales.rbegin(), scales.rend());
    const bench::ElementBench r =
        bench::run_elements(graph, default_plug(*graph).node, tissue, first, first + frames, scales, run_options(in));
    print_result(in, "elements", bench::elements_table(r), bench::elements_json(r),
                 r.name + ", frames " + std::to_string(r.first + 1) + " to " + std::to_string(r.last) +
                     "; distances from the quadratic tets of the first row");
    if (folder) write_file(*folder / "elements.svg", bench::draw(bench::elements_plot(r)));
    return done;
}

} // namespace sinew::cli
