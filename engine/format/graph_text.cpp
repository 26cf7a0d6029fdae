// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_text.h"

#include <filesystem>
#include <fstream>
#include <sstream>

namespace sinew::engine {

std::string file_key(const std::string& path) {
    std::error_code ec;
    const auto out = std::filesystem::weakly_canonical(path, ec);
    return ec ? path : out.generic_string();
}

GraphText graph_text(const std::string& path) {
    std::error_code ec;
    const auto status = std::filesystem::status(path, ec);
    if (!std::filesystem::exists(status)) return {"", "IO401", "there is no such graph file"};
    if (std::filesystem::is_directory(status)) return {"", "IO402", "this is a folder, not a graph file"};
    if (!std::filesystem::is_regular_file(status)) return {"", "IO402", "this is a pipe or a device, not a graph file"};
    std::ifstream in(path, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    std::string text = out.str();
    if (!in || !out) return {"", "IO402", "the graph file cannot be read"};
    // A mesh, say: better than to say what JSON lacks in it.
    const std::size_t first = text.find_first_not_of("\xEF\xBB\xBF \t\r\n");
    if (first != std::string::npos && std::string_view("{[/").find(text[first]) == std::string_view::npos)
        return {"", "DG004", "this is no graph file: a graph is one JSON object and begins with {"};
    return {std::move(text)};
}

} // namespace sinew::engine
