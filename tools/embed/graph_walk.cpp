// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/embed/graph_walk.h"

#include <algorithm>
#include <set>

namespace sinew::embed {

using engine::Binding;
using engine::Graph;
using engine::Node;
using engine::Plug;

Plug split_plug(std::string_view text) {
    const std::size_t dot = text.rfind('.');
    if (dot == std::string_view::npos || dot == 0 || dot + 1 == text.size()) return {};
    return {std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}

std::vector<Plug> sources(const Binding& binding) {
    if (const auto* plug = std::get_if<Plug>(&binding)) return {*plug};
    if (const auto* list = std::get_if<std::vector<Plug>>(&binding)) return *list;
    return {};
}

std::vector<std::string> upstream_of(const Graph& graph, const std::vector<std::string>& nodes) {
    std::set<std::string> seen(nodes.begin(), nodes.end());
    std::vector<std::string> open(nodes), out;
    while (!open.empty()) {
        const Node* node = graph.find(open.back());
        open.pop_back();
        if (!node) continue;
        for (const auto& [name, binding] : node->inputs)
            for (const Plug& source : sources(binding))
                if (seen.insert(source.node).second) open.push_back(source.node);
    }
    for (const std::string& name : graph.node_names())
        if (seen.contains(name)) out.push_back(name);
    return out;
}

std::vector<std::string> connected(const Graph& graph, const std::string& node, std::string_view attribute) {
    std::vector<std::string> out;
    const Node* n = graph.find(node);
    if (!n) return out;
    if (const auto it = n->inputs.find(attribute); it != n->inputs.end())
        for (const Plug& source : sources(it->second)) out.push_back(source.node);
    return out;
}

std::vector<std::string> simulations(const Graph& graph, const std::vector<std::string>& nodes) {
    std::vector<std::string> out;
    for (const std::string& name : nodes) {
        const Node* node = graph.find(name);
        if (node && node->type && node->type->simulation) out.push_back(name);
    }
    return out;
}

std::vector<std::string> last_solvers(const Graph& graph, const std::vector<std::string>& nodes) {
    std::vector<std::string> solvers, out;
    for (const std::string& name : nodes)
        if (const Node* node = graph.find(name); node && node->type_name == "zSolver") solvers.push_back(name);
    std::set<std::string> read;
    for (const std::string& solver : solvers)
        for (const std::string& name : upstream_of(graph, {solver}))
            if (name != solver) read.insert(name);
    for (const std::string& solver : solvers)
        if (!read.contains(solver)) out.push_back(solver);
    // Included graphs may run on their own; who includes them and has a solver means that one.
    if (std::any_of(out.begin(), out.end(), [](const std::string& name) { return !engine::is_included(name); }))
        std::erase_if(out, [](const std::string& name) { return engine::is_included(name); });
    return out;
}

} // namespace sinew::embed
