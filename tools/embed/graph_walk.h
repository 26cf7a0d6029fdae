// What depends on what in a graph, for programs that choose what to pull.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::embed {

/// "node.attribute", split at the last dot. Empty node if there is none.
engine::Plug split_plug(std::string_view text);

/// The connections that stand at an input.
std::vector<engine::Plug> sources(const engine::Binding& binding);

/// `nodes` and all that they depend on, in file order.
std::vector<std::string> upstream_of(const engine::Graph& graph, const std::vector<std::string>& nodes);

/// The nodes connected to an input, in order; none if it is not connected.
std::vector<std::string> connected(const engine::Graph& graph, const std::string& node, std::string_view attribute);

/// Simulation nodes among `nodes`.
std::vector<std::string> simulations(const engine::Graph& graph, const std::vector<std::string>& nodes);

/// The zSolver nodes among `nodes` that no other one of them reads: the last of layers.
std::vector<std::string> last_solvers(const engine::Graph& graph, const std::vector<std::string>& nodes);

} // namespace sinew::embed
