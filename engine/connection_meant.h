// Which connection somebody meant, and which can be meant: for hints. What is followed to the letter shall be right.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::engine {

/// The output that `text` names and that the input takes, "node.output"; a node's name stands for the only one of its
/// that fits. Empty if there is none in the graph.
/// \param near a name that is nearly a node's is one, too: where nothing but a connection can be meant
std::string output_meant(const Graph& graph, const AttributeInfo& input, const std::string& text, bool near);

/// Outputs that the input can be connected to without a cycle, most + 1 at most. Where its documentation names node
/// types ("the tissue or cloth"), only those of such. Empty where the graph is too large to look through.
std::vector<std::string> fitting_outputs(const Graph& graph, std::string_view node, const AttributeInfo& input,
                                         std::span<const std::string> names, std::size_t most);

/// How a file is read whose name stands where its content is connected: the node to add, and its connection. Empty if
/// `text` does not look like a file's name, or no node type reads files for such an input.
std::string file_node_form(const Graph& graph, const AttributeInfo& input, const std::string& text);

/// Where the value of `out` belongs that is connected to `input`, which takes another: another output of its node, or
/// another input. Empty if nothing speaks for one.
std::string fitting_place(const Node& source, const AttributeInfo& out, const Plug& plug, const NodeType& type,
                          const AttributeInfo& input);

/// Of meshes, tets, point caches and what is written as JSON: ".obj" …
std::span<const std::string_view> readable_endings();

} // namespace sinew::engine
