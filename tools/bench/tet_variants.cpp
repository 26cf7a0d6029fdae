// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/tet_variants.h"

#include <nlohmann/json.hpp>
#include <variant>

namespace sinew::bench {

namespace {

/// A zTet's tetSize; 0, the default, stays what it is to the node: a share of the mesh.
double tet_size(const engine::Graph& graph, const std::string& node) {
    const auto& inputs = graph.find(node)->inputs;
    const auto found = inputs.find("tetSize");
    if (found == inputs.end()) return 0;
    const auto* value = std::get_if<engine::Value>(&found->second);
    return value && value->is<double>() ? value->as<double>() : 0;
}

} // namespace

std::vector<std::string> nodes_of_type(const engine::Graph& graph, std::string_view type) {
    std::vector<std::string> out;
    for (const std::string& name : graph.node_names())
        if (graph.find(name)->type_name == type) out.push_back(name);
    return out;
}

std::shared_ptr<const engine::Graph> with_tets(const std::shared_ptr<const engine::Graph>& graph,
                                               const std::string& element, double scale) {
    engine::Edit edit(graph);
    for (const std::string& node : nodes_of_type(*graph, "zTet")) {
        if (!element.empty()) edit.set_json({node, "element"}, nlohmann::json(element).dump());
        if (scale == 1) continue;
        const double size = tet_size(*graph, node);
        if (!(size > 0)) {
            engine::Diagnostic d;
            d.code = "DG110", d.node = node, d.attribute = "tetSize";
            d.message = "tetSize is not given as a number, so it cannot be scaled";
            d.hint = "Give it in scene units.";
            throw engine::Failure(d);
        }
        edit.set_json({node, "tetSize"}, nlohmann::json(size * scale).dump());
    }
    return edit.commit().graph;
}

} // namespace sinew::bench
