// Nodes of a graph that nothing comes of: connected to nothing, or to nothing that leads to a solver.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <vector>

namespace sinew::cli {

/// Warnings FE330, one for each node at whose end nobody reads (of many the first 20), with the inputs that take what
/// it gives. In a graph with a solver a node is for something if a solver reads it, however far away, or if it reads a
/// solver's result (and so does what it reads besides), or if it gives a file to pull. Without a solver every end may
/// be what is pulled, and nothing is doubted. Nodes of included files are theirs: a limb that is included need not be
/// used as a whole.
std::vector<engine::Diagnostic> find_idle_nodes(const engine::Graph& graph);

} // namespace sinew::cli
