// Graph files, with all node types, and graphs that include graphs. Nothing is evaluated.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/atomic_file.h"
#include "engine/format/graph_file.h"
#include "engine/format/layout.h"
#include "nodes/register_all.h"
#include "tests/fuzz/targets/refused.h"
#include "tests/fuzz/targets/targets.h"
#include "tests/tools/temporary_folder.h"

#include <cstdlib>
#include <filesystem>

namespace sinew::fuzz {

namespace {

namespace fs = std::filesystem;

const std::shared_ptr<const engine::Registry>& registry() {
    static const auto types = nodes::make_registry();
    return types;
}

/// Of this process alone; gone at the end.
const fs::path& folder() {
    static const test::TemporaryFolder one;
    return one.path();
}

/// What is read can be written, and is then the same.
void check_round_trip(const engine::Graph& graph, const std::string& file, const engine::FileAccess& files) {
    const std::string written = engine::write_graph(graph);
    const auto again = engine::read_graph(registry(), written, file, files).graph;
    promise(engine::write_graph(*again) == written, "a graph that was written is another one");
}

} // namespace

void read_graph_text(std::string_view bytes) {
    static const auto files = engine::FileAccess::within(folder());
    static const std::string file = (folder() / "graph.json").string();
    refused_or_read([&] {
        const auto graph = engine::read_graph(registry(), bytes, file, files).graph;
        check_round_trip(*graph, file, files);
        const std::string neat = engine::laid_out(bytes);
        promise(engine::laid_out(neat) == neat, "what is laid out is laid out in another way");
    });
}

void read_included_graphs(std::string_view bytes) {
    static const auto files = engine::FileAccess::within(folder());
    const std::vector<std::string_view> texts = files_in(bytes);
    if (texts.size() > 4) return;
    std::vector<fs::path> paths;
    for (std::size_t i = 0; i < texts.size(); ++i) {
        paths.push_back(folder() / (std::string(1, static_cast<char>('a' + i)) + ".json"));
        engine::write_file_soon(paths.back(), texts[i]);
    }
    refused_or_read([&] {
        const auto graph = engine::load_graph(registry(), paths.front().string(), files).graph;
        check_round_trip(*graph, paths.front().string(), files);
    });
    for (const fs::path& path : paths) fs::remove(path);
}

} // namespace sinew::fuzz
