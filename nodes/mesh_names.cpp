// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/mesh_names.h"

#include <algorithm>

namespace sinew::nodes {

std::vector<std::string> mesh_names(const engine::Graph& graph, const engine::Plug& plug, std::size_t count) {
    const engine::Node* node = graph.find(plug.node);
    if (!node || !node->type) return {};
    for (const engine::AttributeInfo& input : node->type->inputs) {
        const auto it = node->inputs.find(input.name);
        if (input.kind != engine::AttributeKind::wire_list || it == node->inputs.end()) continue;
        const auto* list = std::get_if<std::vector<engine::Plug>>(&it->second);
        if (!list || list->size() != count) continue;
        std::vector<std::string> out;
        for (const engine::Plug& source : *list) out.push_back(source.node);
        return out;
    }
    return {};
}

const Mesh* find_mesh(const engine::Graph& graph, const engine::Plug& plug, const MeshList& meshes,
                      std::string_view name) {
    const auto names = mesh_names(graph, plug, meshes.meshes.size());
    const auto it = std::find(names.begin(), names.end(), name);
    return it == names.end() ? nullptr : &meshes.meshes[static_cast<std::size_t>(it - names.begin())];
}

} // namespace sinew::nodes
