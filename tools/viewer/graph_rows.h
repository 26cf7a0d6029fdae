// From a graph to boxes and wires without places: what a node shows of itself.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/viewer/graph_layout.h"

namespace sinew::viewer {

/// Boxes in file order, each with its size; wires between rows. Wires from nodes that do not exist are left
/// out.
GraphDrawing graph_boxes(const engine::Graph& graph);

/// The group that a node type is coloured by, from what its first output gives; null: a type that is not known.
std::string family_of(const engine::NodeType* type);

} // namespace sinew::viewer
