// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/elements.h"

#include "engine/evaluator.h"
#include "nodes/values.h"
#include "tools/bench/tet_variants.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

namespace sinew::bench {

namespace {

using engine::Graph;

std::shared_ptr<const Graph> variant(const std::shared_ptr<const Graph>& graph, const std::string& tissue,
                                     const std::string& element, double scale) {
    const auto scaled = with_tets(graph, element, scale);
    engine::Edit edit(scaled);
    for (const std::string& node : nodes_of_type(*scaled, "zTissue"))
        if (!tissue.empty() && node != tissue) edit.set_json({node, "enable"}, "false");
    return edit.commit().graph;
}

using Shapes = std::vector<solver::Points>; ///< of the tissues that take part, in metres

/// Meshes that deform: bones are the same in all variants, and disabled tissues stay as modelled.
Shapes shapes_of(const nodes::Solved& solved, const nodes::MeshList& meshes, double scale) {
    Shapes out;
    std::size_t mesh = 0;
    for (const auto& rest : solved.rests) {
        while (mesh < meshes.meshes.size() && meshes.meshes[mesh].topology != rest->mesh.topology) ++mesh;
        if (mesh == meshes.meshes.size()) break;
        if (rest->data.index() == 0) {
            solver::Points points = *meshes.meshes[mesh].points;
            for (solver::Vec3& p : points) p /= scale;
            out.push_back(std::move(points));
        }
        ++mesh;
    }
    return out;
}

Shapes simulate(const std::shared_ptr<const Graph>& graph, const std::string& node, const ElementBench& bench,
                const RunOptions& options, ElementRow& row) {
    engine::Evaluator evaluator;
    const auto pull = [&](const char* plug, int frame) {
        return evaluator.pull({graph, {node, plug}, static_cast<double>(frame), options.stop});
    };
    const int frames = bench.last - bench.first;
    double scale = 100;
    if (const auto found = graph->find(node)->inputs.find("scale"); found != graph->find(node)->inputs.end())
        if (const auto* value = std::get_if<engine::Value>(&found->second); value && value->is<double>())
            scale = value->as<double>();
    std::clock_t ticks = 0;
    for (int frame = bench.first; frame <= bench.last; ++frame) {
        const engine::Value value = pull("outReport", frame);
        const auto& report = value.as<nodes::SolveReport>();
        // The first step makes patterns, hierarchies and symbolic factors.
        if (frame == bench.first + 1) ticks = std::clock();
        row.tets = report.tets, row.unknowns = report.dofs;
        if (frame == bench.first) continue;
        row.newton_per_frame += static_cast<double>(report.record.newton_iterations) / frames;
        row.unconverged += !report.record.converged;
        row.inverted = std::max(row.inverted, report.record.inverted);
    }
    row.cpu_ms_per_frame = 1e3 * static_cast<double>(std::clock() - ticks) / CLOCKS_PER_SEC / std::max(1, frames - 1);
    return shapes_of(pull("outSolved", bench.last).as<nodes::Solved>(),
                     pull("outMeshes", bench.last).as<nodes::MeshList>(), scale);
}

void compare(const Shapes& shapes, const Shapes& truth, ElementRow& row) {
    double squares = 0;
    std::size_t count = 0;
    for (std::size_t s = 0; s < shapes.size(); ++s)
        for (std::size_t v = 0; v < shapes[s].size(); ++v, ++count) {
            const double d = 1e3 * (shapes[s][v] - truth[s][v]).norm();
            squares += d * d;
            row.most_mm = std::max(row.most_mm, d);
        }
    row.rms_mm = std::sqrt(squares / static_cast<double>(count));
}

} // namespace

ElementBench run_elements(std::shared_ptr<const Graph> graph, const std::string& solver, const std::string& tissue,
                          int first, int last, const std::vector<double>& scales, const RunOptions& options) {
    ElementBench out{std::filesystem::path(graph->file()).filename().string(), tissue, first, last, {}};
    Shapes truth;
    const auto run = [&](const std::string& element, double scale) {
        options.tell(out.name + ", " + element + ", tet sizes x " + number(scale, 3));
        ElementRow row{.element = element, .scale = scale};
        const Shapes shapes = simulate(variant(graph, tissue, element, scale), solver, out, options, row);
        if (truth.empty()) {
            truth = shapes;
            row.rms_mm = row.most_mm = std::numeric_limits<double>::quiet_NaN();
        } else {
            compare(shapes, truth, row);
        }
        out.rows.push_back(row);
    };
    run("quadratic", scales.back()); // the reference
    for (std::size_t s = 0; s + 1 < scales.size(); ++s) run("quadratic", scales[s]);
    for (const double scale : scales) run("linear", scale);
    return out;
}

Table elements_table(const ElementBench& result) {
    Table t{{"element", "tet sizes x", "tets", "unknowns", "CPU ms a frame", "Newton a frame", "unconverged",
             "inverted", "RMS [mm]", "farthest [mm]"},
            {}};
    for (const ElementRow& r : result.rows)
        t.rows.push_back({r.element, number(r.scale, 3), std::to_string(r.tets), std::to_string(r.unknowns),
                          number(r.cpu_ms_per_frame, 3), number(r.newton_per_frame, 3), std::to_string(r.unconverged),
                          std::to_string(r.inverted), number(r.rms_mm, 3), number(r.most_mm, 3)});
    return t;
}

nlohmann::ordered_json elements_json(const ElementBench& result) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const ElementRow& r : result.rows)
        out.push_back({{"scene", result.name},
                       {"tissue", result.tissue},
                       {"first", result.first},
                       {"last", result.last},
                       {"element", r.element},
                       {"scale", r.scale},
                       {"tets", r.tets},
                       {"unknowns", r.unknowns},
                       {"cpu_ms_per_frame", r.cpu_ms_per_frame},
                       {"newton_per_frame", r.newton_per_frame},
                       {"unconverged", r.unconverged},
                       {"inverted", r.inverted},
                       {"rms_mm", r.rms_mm},
                       {"most_mm", r.most_mm}});
    return out;
}

Plot elements_plot(const ElementBench& result) {
    Plot plot{result.name + (result.tissue.empty() ? "" : ", " + result.tissue) +
                  ": distance from the finest quadratic tets",
              "CPU time a frame [ms]",
              "RMS distance at frame " + std::to_string(result.last) + " [mm]",
              {{"linear", {}}, {"quadratic", {}}},
              false,
              {}};
    for (const ElementRow& r : result.rows)
        plot.series[r.element == "quadratic"].points.push_back(
            {r.cpu_ms_per_frame, r.rms_mm, std::to_string(r.tets) + " tets", "x " + number(r.scale, 2)});
    return plot;
}

} // namespace sinew::bench
