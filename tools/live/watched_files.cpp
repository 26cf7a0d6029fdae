// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/live/watched_files.h"

#include "engine/file_sequence.h"

#include <filesystem>
#include <set>
#include <sys/stat.h>

namespace sinew::live {

namespace fs = std::filesystem;

namespace {

void add_included(const engine::Graph& graph, std::set<std::string>& files) {
    for (const auto& [prefix, include] : graph.includes()) {
        files.insert(include->file);
        add_included(*include->graph, files);
    }
}

} // namespace

std::vector<std::string> files_of(const engine::Graph& graph) {
    std::set<std::string> out{graph.file()};
    add_included(graph, out);
    for (const std::string& name : graph.node_names())
        for (const auto& [attribute, binding] : graph.find(name)->inputs)
            if (const auto* value = std::get_if<engine::Value>(&binding); value && value->is<engine::File>()) {
                const std::string& path = value->as<engine::File>().path;
                if (path.empty()) continue;
                if (engine::names_sequence(path)) {
                    out.insert(fs::path(path).parent_path().string()); // where numbers come and go
                    for (const auto& [number, file] : engine::find_sequence(path)) out.insert(file);
                } else
                    out.insert(path);
            }
    return {out.begin(), out.end()};
}

std::optional<WatchedFiles::Stamp> WatchedFiles::look(const std::string& file) {
    struct stat s {};
    if (::stat(file.c_str(), &s) != 0) return {};
    return Stamp{s.st_mtim.tv_sec, s.st_mtim.tv_nsec, s.st_size, s.st_ino};
}

void WatchedFiles::watch(const std::vector<std::string>& files) {
    std::map<std::string, std::optional<Stamp>> now;
    for (const std::string& file : files) {
        const auto before = seen_.find(file);
        now[file] = before != seen_.end() ? before->second : look(file);
    }
    seen_ = std::move(now);
}

std::vector<std::string> WatchedFiles::take_changed() {
    std::vector<std::string> out;
    for (auto& [file, seen] : seen_)
        if (const auto now = look(file); now && now != seen) {
            seen = now;
            out.push_back(file);
        }
    return out;
}

} // namespace sinew::live
