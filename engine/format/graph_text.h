// The text of a graph file on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/file_access.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace sinew::engine {

struct GraphText {
    std::string text;
    std::string code = {};    ///< IO4xx or DG004 if the file cannot be a graph; empty: it may be one
    std::string message = {}; ///< what is wrong then, without the path
    std::string hint = {};
};
GraphText graph_text(const std::string& path, const FileAccess& files = {});

/// No graph file may be larger [bytes].
inline constexpr std::uintmax_t most_graph_bytes = std::uintmax_t{256} << 20;

/// One name for one file, however a path to it is written.
std::string file_key(const std::string& path);

} // namespace sinew::engine
