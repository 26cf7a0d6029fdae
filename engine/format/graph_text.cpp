// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_text.h"

#include "engine/diagnostics.h"
#include "engine/format/graph_file.h"
#include "engine/format/migrate.h"
#include "engine/format/read_value.h"
#include "engine/near_file.h"
#include "engine/text.h"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <unistd.h>
#include <vector>

namespace sinew::engine {

std::string file_key(const std::string& path) {
    std::error_code ec;
    const auto out = std::filesystem::weakly_canonical(path, ec);
    return ec ? path : out.generic_string();
}

namespace {

namespace fs = std::filesystem;

/// Names of the graph files in a folder.
std::vector<std::string> graphs_in(const fs::path& folder) {
    std::vector<std::string> out = files_in(folder);
    std::erase_if(out, [](const std::string& name) { return fs::path(name).extension() != ".json"; });
    return out;
}

GraphText refused(const fs::path& path, const FileFault& fault) {
    std::error_code ec;
    const fs::file_status status = fs::status(path, ec);
    if (fault.code == "IO401") {
        const std::string near = near_file(fs::path(path).replace_extension(".json"), {});
        return {"", fault.code, "there is no such graph file",
                !near.empty() ? "did you mean \"" + (path.parent_path() / near).string() + "\"?" : ""};
    }
    if (fault.code != "IO402") return {"", fault.code, fault.message, fault.hint};
    if (fs::is_directory(status)) {
        std::vector<std::string> inside = graphs_in(path);
        const bool few = !inside.empty() && inside.size() <= 12;
        return {"", fault.code, "this is a folder, not a graph file",
                few ? "name a file in it: " + listed(inside) : "name the graph file (.json) that is meant"};
    }
    if (!fs::is_regular_file(status))
        return {"", fault.code, "this is a pipe or a device, not a graph file",
                "write the graph into a file and name that"};
    const bool closed = faccessat(AT_FDCWD, path.c_str(), R_OK, AT_EACCESS) != 0 && errno == EACCES;
    return {"", fault.code, closed ? "you may not read the graph file" : fault.message,
            closed ? "let yourself read it: chmod u+r, or ask whom it belongs to" : fault.hint};
}

} // namespace

GraphText graph_text(const std::string& path, const FileAccess& files) {
    if (const auto fault = file_name_fault(path)) return {"", fault->code, fault->message, fault->hint};
    auto read = files.read(path, most_graph_bytes);
    if (const auto* fault = std::get_if<FileFault>(&read)) return refused(path, *fault);
    std::string text = std::move(std::get<std::string>(read));
    const std::string hint = "a graph begins as { \"format\": \"sinew " + std::to_string(current_format) +
                             "\", \"nodes\": { … } }; `sinew new` writes one";
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        return {"", "DG004", "the file is written in UTF-16", "save it as UTF-8"};
    // A mesh, say: better than to say what JSON lacks in it.
    const std::size_t first = text.find_first_not_of("\xEF\xBB\xBF \t\r\n");
    if (text.empty()) return {"", "DG004", "the file is empty", hint};
    if (first == std::string::npos) return {"", "DG004", "there is nothing but blanks in the file", hint};
    if (std::string_view("{[/").find(text[first]) == std::string_view::npos)
        return {"", "DG004", "this is no graph file: a graph is one JSON object and begins with {", hint};
    return {std::move(text)};
}

Loaded load_graph(std::shared_ptr<const Registry> registry, const std::string& path, const FileAccess& files) {
    GraphText text = graph_text(path, files);
    if (text.code.empty()) return read_graph(std::move(registry), text.text, path, files);
    Diagnostic d;
    d.code = text.code;
    d.spot = SourceSpot{path, "", 0, 0};
    d.message = std::move(text.message);
    d.hint = std::move(text.hint);
    throw Failure(std::move(d));
}

} // namespace sinew::engine
