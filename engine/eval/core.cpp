// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/core.h"

#include "engine/check.h"
#include "engine/eval/carry_chains.h"

#include <algorithm>

namespace sinew::engine {

namespace {
constexpr std::size_t kept_programs = 8; // snapshots whose keys and chains are remembered: undo finds them again

std::unique_ptr<tbb::global_control> threads_beyond_cores(int threads) {
    constexpr auto allowed = tbb::global_control::max_allowed_parallelism;
    const auto wanted = static_cast<std::size_t>(std::max(threads, 0));
    if (wanted <= tbb::global_control::active_value(allowed)) return nullptr;
    return std::make_unique<tbb::global_control>(allowed, wanted);
}

} // namespace

Core::Core(const StorePolicy& policy, int threads, Observer* watcher)
    : values(policy.value_bytes)
    , states(policy.state_bytes, std::max(1, policy.state_every))
    , scratch(policy.scratch_entries)
    , disk(policy.disk_folder.empty()
               ? std::nullopt
               : std::optional<DiskStore>(std::in_place, policy.disk_folder, ".kept", policy.files))
    , frames(policy.disk_folder.empty() || !policy.keeps_frames
                 ? nullptr
                 : std::make_unique<FrameStore>(policy.disk_folder, policy.disk_bytes, policy.build, policy.files))
    , more_threads(threads_beyond_cores(threads))
    , arena(threads > 0 ? threads : tbb::task_arena::automatic)
    , observer_(watcher) {}

std::shared_ptr<Program> Core::program_of(const std::shared_ptr<const Graph>& graph) {
    const auto it = std::find_if(programs.begin(), programs.end(), [&](const auto& p) { return p->graph() == graph; });
    if (it != programs.end()) {
        std::rotate(it, it + 1, programs.end());
        return programs.back();
    }
    if (programs.size() >= kept_programs) programs.erase(programs.begin());
    programs.push_back(std::make_shared<Program>(graph));
    return programs.back();
}

std::pair<std::shared_ptr<Program>, int> Core::prepare(const std::shared_ptr<const Graph>& graph,
                                                       const std::string& node) {
    FileContents contents;
    while (true) {
        std::unique_lock lock(mutex);
        const std::shared_ptr<Program> program = program_of(graph);
        const int at = program->find(node);
        if (at < 0) {
            Diagnostic d;
            d.code = "DG102";
            d.node = node;
            d.message = "there is no such node";
            d.hint = name_hint(node, graph->node_names(), "nodes");
            throw Failure(std::move(d));
        }
        bool complete = true;
        for (const std::string& path : program->file_paths(at)) complete = complete && contents.contains(path);
        if (complete) {
            if (program->set_files(at, contents)) {
                // The snapshot used last before this one is most often the one that was edited.
                if (programs.size() > 1 && programs.back() == program)
                    carry_chains(*programs[programs.size() - 2], *program, at);
                return {program, at};
            }
            std::erase(programs,
                       program); // a file has changed: everything that was derived from it is out of date
            continue;
        }
        const std::vector<std::string> paths = program->file_paths(at);
        lock.unlock(); // large files are read while others go on
        for (const std::string& path : paths) contents.insert_or_assign(path, files.of(path, graph->files()));
    }
}

void Core::learn(const Digest& plug, const Digest& content) {
    if (frames && contents.find(plug) != content) learned.push_back({plug, content});
    contents.put(plug, content);
}

void Core::recall() {
    if (!frames || recalled) return;
    recalled = true;
    frames->read_rows([&](const PlugContent& row) {
        if (!contents.find(row.plug)) contents.put(row.plug, row.content);
    });
}

void Core::keep(const Digest& key, const std::optional<Digest>& by_content, const NodeType& type,
                const EntryPtr& entry) {
    for (std::size_t i = 0; i < type.outputs.size(); ++i) {
        const Digest plug = plug_key(key, type.outputs[i].name);
        learn(plug, entry->digest(i));
        if (!entry->has(static_cast<int>(i))) continue;
        if (const Digest aside = entry->outputs[i].aside_digest(); aside != Digest{}) learn(aside_key(plug), aside);
    }
    if (by_content && values.find(*by_content) == entry) return values.alias(key, *by_content);
    if (entry->is_whole() && made.find(key)) ++made_again; // its row outlived it
    if (entry->is_whole()) made.put(key, key);
    values.put(key, entry);
    if (by_content) values.alias(*by_content, key);
    most_stored_bytes = std::max(most_stored_bytes, stored_bytes());
}

void Core::keep_state(Program& program, int simulation, int frame, const Digest& key,
                      const std::optional<Digest>& key_before, StoredState state) {
    Place& p = program.place(simulation);
    p.reached = key;
    states.put(key, p.chain.front(), frame - p.start_frame, std::move(state), key_before, program.reached());
    most_stored_bytes = std::max(most_stored_bytes, stored_bytes());
}

FlightPtr Core::claim(const Digest& key, const Graph* graph) {
    auto flight = std::make_shared<Flight>();
    flight->graph = graph;
    flights[key] = flight;
    return flight;
}

void Core::land(const Digest& key, const FlightPtr& flight, const NodeType& type, EntryPtr entry,
                std::exception_ptr error, const std::optional<Digest>& by_content) {
    {
        const std::lock_guard lock(mutex);
        if (entry) keep(key, by_content, type, entry);
        flight->done = true;
        flight->entry = std::move(entry);
        flight->error = std::move(error);
        flights.erase(key);
    }
    landed.notify_all();
}

} // namespace sinew::engine
