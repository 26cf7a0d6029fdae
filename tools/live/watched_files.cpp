// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/live/watched_files.h"

#include "engine/file_sequence.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sys/stat.h>

namespace sinew::live {

namespace fs = std::filesystem;

namespace {

/// Graphs that include each other without an end are wrong, and not all of them need to be watched.
constexpr std::size_t most_files = 1000;

void add_included(const engine::Graph& graph, std::set<std::string>& files) {
    for (const auto& [prefix, include] : graph.includes()) {
        files.insert(include->file);
        add_included(*include->graph, files);
    }
}

} // namespace

std::vector<std::string> files_named_by(const std::string& path, const engine::FileAccess& files) {
    if (path.empty() || files.refusal(path)) return {};
    if (!engine::names_sequence(path)) return {path};
    std::vector<std::string> out;
    for (const auto& [number, file] : engine::find_sequence(path)) out.push_back(file);
    return out;
}

std::vector<std::string> files_of(const engine::Graph& graph) {
    std::set<std::string> out{graph.file()};
    add_included(graph, out);
    for (const std::string& name : graph.node_names())
        for (const auto& [attribute, binding] : graph.find(name)->inputs)
            if (const auto* value = std::get_if<engine::Value>(&binding); value && value->is<engine::File>()) {
                const std::string& path = value->as<engine::File>().path;
                for (const std::string& file : files_named_by(path, graph.files())) out.insert(file);
                if (!graph.files().refusal(path) && engine::names_sequence(path)) // where numbers come and go
                    out.insert(fs::path(path).parent_path().string());
            }
    return {out.begin(), out.end()};
}

std::vector<std::string> graphs_named_in(const std::string& file, const engine::FileAccess& files) {
    std::set<std::string> out;
    std::vector<std::string> open{file};
    while (!open.empty()) {
        const std::string at = open.back();
        open.pop_back();
        std::error_code none;
        if (files.refusal(at)) continue;
        if (!out.insert(at).second || out.size() > most_files || !fs::is_regular_file(at, none)) continue;
        std::ifstream in(at);
        const auto json = nlohmann::json::parse(in, nullptr, false, true);
        if (!json.is_object() || !json.contains("includes") || !json["includes"].is_object()) continue;
        for (const auto& include : json["includes"])
            if (include.is_object() && include.contains("file") && include["file"].is_string())
                open.push_back((fs::path(at).parent_path() / include["file"].get<std::string>()).lexically_normal());
    }
    return {out.begin(), out.end()};
}

std::optional<FileStamp> stamp_of(const std::string& file) {
    struct stat s {};
    if (::stat(file.c_str(), &s) != 0) return {};
    return FileStamp{s.st_mtim.tv_sec, s.st_mtim.tv_nsec, s.st_size, s.st_ino};
}

void WatchedFiles::watch(const std::vector<std::string>& files) {
    std::map<std::string, std::optional<FileStamp>> now;
    for (const std::string& file : files) {
        const auto before = seen_.find(file);
        now[file] = before != seen_.end() ? before->second : stamp_of(file);
    }
    seen_ = std::move(now);
}

std::vector<std::string> WatchedFiles::take_changed() {
    std::vector<std::string> out;
    for (auto& [file, seen] : seen_)
        if (const auto now = stamp_of(file); now != seen) {
            seen = now;
            out.push_back(file);
        }
    return out;
}

} // namespace sinew::live
