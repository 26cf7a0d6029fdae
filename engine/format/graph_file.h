// Graph files: JSON text <-> Graph. Every problem of a stage is reported at once, with line and column.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/file_access.h"
#include "engine/graph.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::engine {

struct Loaded {
    std::shared_ptr<const Graph> graph;
    std::vector<Diagnostic> notes; ///< warnings, for example a node type that this program does not know
};

/// Reads the text of a graph file. `file_name` stands in messages; relative paths in the graph resolve
/// against its folder. Files that it names are opened through `files`, now and whenever the graph is evaluated. Throws
/// Failure with every problem found.
Loaded read_graph(std::shared_ptr<const Registry> registry, std::string_view json_text, const std::string& file_name,
                  const FileAccess& files = {});
/// Reads a file from disk; IO4xx if it cannot.
Loaded load_graph(std::shared_ptr<const Registry> registry, const std::string& path, const FileAccess& files = {});
/// Only what is not default, keys in order, paths relative to the graph's folder; read_graph(write_graph(g))
/// is g.
std::string write_graph(const Graph& graph);
/// What a graph file holds at an input for this binding: in SI units, also if it is the default.
/// \param folder that paths are written from; empty: as they are
std::string binding_json(const AttributeInfo& input, const Binding& binding, const std::string& folder = {});
/// JSON Schema (draft 2020-12) of a graph file that uses the registry's types.
std::string graph_schema(const Registry& registry);

} // namespace sinew::engine
