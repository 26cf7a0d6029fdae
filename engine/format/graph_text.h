// The text of a graph file on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace sinew::engine {

struct GraphText {
    std::string text;
    std::string_view code = {}; ///< IO401, IO402 or DG004 if the file cannot be a graph; empty: it may be one
    std::string message = {};   ///< what is wrong then
};
GraphText graph_text(const std::string& path);

/// One name for one file, however a path to it is written.
std::string file_key(const std::string& path);

} // namespace sinew::engine
