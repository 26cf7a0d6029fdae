// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/unfinished.h"

#include "tools/cli/atomic_file.h"
#include "tools/cli/body_files.h"
#include "tools/cli/json_text.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace sinew::cli {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

std::string host_name() {
    char name[256] = {};
    return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

fs::path mark_of(const fs::path& folder, const UnfinishedRun& run) {
    return folder / frame_file_name("unfinished", run.first, "json");
}

bool runs_here(const json& j) {
    const auto process = static_cast<pid_t>(j.value("process", 0));
    if (process <= 0 || j.value("host", "") != host_name()) return false;
    return kill(process, 0) == 0 || errno == EPERM;
}

std::optional<UnfinishedRun> read_mark(const fs::path& file, const engine::FileAccess& files) {
    constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 20;
    const auto text = files.read(file.string(), most_bytes);
    if (!std::holds_alternative<std::string>(text)) return {};
    const json j = json::parse(std::get<std::string>(text), nullptr, false);
    if (!j.is_object()) return {};
    try {
        UnfinishedRun run;
        run.graph = j.value("graph", "");
        run.first = j.at("first").get<int>(), run.last = j.at("last").get<int>(), run.count = j.value("count", 0);
        if (const auto it = j.find("error"); it != j.end() && it->is_object())
            run.error = {it->value("frame", 0), it->value("code", ""), it->value("node", ""), it->value("message", "")};
        run.is_alive = !run.error && runs_here(j);
        return run;
    } catch (const json::exception&) {
        return {};
    }
}

std::vector<fs::path> marks_in(const fs::path& folder) {
    std::vector<fs::path> out;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("unfinished.") && name.ends_with(".json") && entry.is_regular_file(error))
            out.push_back(entry.path());
    }
    return out;
}

} // namespace

void mark_unfinished(const fs::path& folder, const UnfinishedRun& run, const engine::FileAccess& files) {
    json j = {{"graph", run.graph},
              {"first", run.first},
              {"last", run.last},
              {"count", run.count},
              {"process", static_cast<int>(getpid())},
              {"host", host_name()}};
    if (run.error)
        j["error"] = {{"frame", run.error->frame},
                      {"code", run.error->code},
                      {"node", run.error->node},
                      {"message", run.error->message}};
    write_file(mark_of(folder, run), json_text(j, 1) + "\n", files);
}

void mark_finished(const fs::path& folder, const UnfinishedRun& run, const engine::FileAccess& files) {
    std::error_code error;
    for (const fs::path& file : marks_in(folder))
        if (const auto other = read_mark(file, files);
            file == mark_of(folder, run) ||
            (other && !other->is_alive && other->first >= run.first && other->last <= run.last))
            fs::remove(file, error);
}

std::vector<UnfinishedRun> find_unfinished(const fs::path& folder) {
    std::vector<UnfinishedRun> out;
    for (const fs::path& file : marks_in(folder))
        if (auto run = read_mark(file, {})) out.push_back(std::move(*run));
    std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return out;
}

} // namespace sinew::cli
