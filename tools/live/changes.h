// What is changed in the page: in the graph that runs, and, when asked for, in the text of its file.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sinew::live {

/// What an attribute was given in the page.
struct Change {
    engine::Plug input;
    std::string json;         ///< what a graph file would hold there
    std::optional<int> frame; ///< a key there; else the input itself
};

/// Throws Failure for what a graph file could not hold there, an empty list where connections are required, say.
std::shared_ptr<const engine::Graph> with_change(const std::shared_ptr<const engine::Graph>& graph, const Change& c);

/// Changes that were accepted earlier. Throws Failure with all that do not fit any more (DG175).
std::shared_ptr<const engine::Graph> with_changes(std::shared_ptr<const engine::Graph> graph,
                                                  const std::vector<Change>& changes);

/// The text of a graph file with the changes in it; what they do not touch is as it was. Throws Failure: DG181 for
/// what has no place in it, beside what the reader says of it then, DG175.
std::string written_into(std::string text, const std::string& file, const engine::FileAccess& files,
                         const std::vector<Change>& changes);

/// IO405.
engine::Diagnostic unwritable(const std::string& file, const std::string& why);

} // namespace sinew::live
