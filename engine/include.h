// Nodes of included graphs, as the including one sees them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <string>
#include <string_view>

namespace sinew::engine {

/// What stands at an input of a node of `graph`, with the names that its nodes have under `prefix`. The input is bound.
Binding prefixed_binding(const Graph& graph, const Node& n, std::string_view attribute, std::string_view prefix);

/// Where the graph that includes it does so.
SourceSpot include_spot(const Include& include, std::string_view prefix);

} // namespace sinew::engine
