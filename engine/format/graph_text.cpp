// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_text.h"

#include <filesystem>

namespace sinew::engine {

std::string file_key(const std::string& path) {
    std::error_code ec;
    const auto out = std::filesystem::weakly_canonical(path, ec);
    return ec ? path : out.generic_string();
}

GraphText graph_text(const std::string& path, const FileAccess& files) {
    auto read = files.read(path, most_graph_bytes);
    if (const auto* fault = std::get_if<FileFault>(&read)) {
        std::error_code ec;
        const auto status = std::filesystem::status(path, ec);
        const std::string message = fault->code == "IO401"                     ? "there is no such graph file"
                                    : fault->code != "IO402"                   ? fault->message
                                    : std::filesystem::is_directory(status)    ? "this is a folder, not a graph file"
                                    : std::filesystem::is_regular_file(status) ? "the graph file cannot be read"
                                                                               : "this is a pipe or a device, not a "
                                                                                 "graph file";
        return {"", fault->code, message, fault->code == "IO401" || fault->code == "IO402" ? "" : fault->hint};
    }
    std::string text = std::move(std::get<std::string>(read));
    // A mesh, say: better than to say what JSON lacks in it.
    const std::size_t first = text.find_first_not_of("\xEF\xBB\xBF \t\r\n");
    if (first != std::string::npos && std::string_view("{[/").find(text[first]) == std::string_view::npos)
        return {"", "DG004", "this is no graph file: a graph is one JSON object and begins with {"};
    return {std::move(text)};
}

} // namespace sinew::engine
