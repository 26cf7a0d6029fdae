// Which mesh of a list is which body. Names never travel on wires (renaming a node must change no result), so they are
// read from the graph beside the value.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"
#include "nodes/values.h"

#include <string>
#include <string_view>
#include <vector>

namespace sinew::nodes {

/// The nodes that the `count` meshes at `plug` belong to, in their order: those connected to the list that the plug's
/// node works on (zSolver.bodies, zEmbedder.meshes). Empty if no list has that many.
std::vector<std::string> mesh_names(const engine::Graph& graph, const engine::Plug& plug, std::size_t count);

/// The mesh of the node `name` in what was pulled from `plug`; nullptr if there is none.
const Mesh* find_mesh(const engine::Graph& graph, const engine::Plug& plug, const MeshList& meshes,
                      std::string_view name);

} // namespace sinew::nodes
