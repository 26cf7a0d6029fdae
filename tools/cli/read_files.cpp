// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/read_files.h"

#include "tools/cli/body_files.h"
#include "tools/live/watched_files.h"
#include "tools/viewer/collect_glb.h"

#include <optional>
#include <sys/stat.h>

namespace sinew::cli {

namespace fs = std::filesystem;

namespace {

std::optional<std::pair<std::uint64_t, std::uint64_t>> place_of(const fs::path& file) {
    struct stat s {};
    // Devices and pipes are written to, not over.
    if (::stat(file.c_str(), &s) != 0 || !S_ISREG(s.st_mode)) return {};
    return std::pair<std::uint64_t, std::uint64_t>(s.st_dev, s.st_ino);
}

} // namespace

void ReadFiles::add(const fs::path& file, const std::string& role) {
    if (const auto place = place_of(file)) entries_.try_emplace(*place, Entry{file.string(), role});
}

void ReadFiles::add(const engine::Graph& graph) {
    add(graph.file(), "the graph itself");
    for (const std::string& name : graph.node_names())
        for (const auto& [attribute, binding] : graph.find(name)->inputs)
            if (const auto* value = std::get_if<engine::Value>(&binding); value && value->is<engine::File>())
                for (const std::string& file : live::files_named_by(value->as<engine::File>().path, graph.files()))
                    add(file, "which " + name + "." + attribute + " reads");
    for (const std::string& file : live::files_of(graph)) add(file, "which the graph includes"); // all that is left
}

void ReadFiles::add_folder(const fs::path& folder) {
    for (const BodySequence& body : find_sequences(folder).bodies)
        for (const auto& [frame, file] : body.files) add(file, "a mesh of the run that is shown");
    if (const fs::path glb = viewer::find_glb(folder); !glb.empty()) add(glb, "the run that is shown");
}

void ReadFiles::check_kept(const fs::path& file, std::string_view flag) const {
    const auto place = place_of(file);
    const auto found = place ? entries_.find(*place) : entries_.end();
    if (found == entries_.end()) return;
    const auto& [name, role] = found->second;
    engine::Diagnostic d;
    d.code = "IO420";
    d.message = std::string(flag) + " would write " + (file.string() == name ? "" : "'" + file.string() + "' ") +
                "over '" + name + "', " + role;
    d.hint = "choose another place with " + std::string(flag);
    throw engine::Failure(d);
}

} // namespace sinew::cli
