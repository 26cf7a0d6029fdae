// Pulls one mesh by the name of its body, as the README shows.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/evaluator.h"
#include "engine/format/graph_file.h"
#include "nodes/mesh_names.h"
#include "nodes/register_all.h"

#include <iostream>

int main(int, char** words) {
    try {
        const auto loaded = sinew::engine::load_graph(sinew::nodes::make_registry(), words[1]);
        sinew::engine::Evaluator evaluator;
        const sinew::engine::Plug plug{"solver", "outMeshes"};
        const auto value = evaluator.pull({loaded.graph, plug, 1});
        const auto& meshes = value.as<sinew::nodes::MeshList>();
        if (const auto* mesh = find_mesh(*loaded.graph, plug, meshes, words[2]))
            std::cout << mesh->points->size() << "\n";
    } catch (const sinew::engine::Failure& failure) {
        for (const auto& d : failure.diagnostics()) std::cerr << to_text(d) << "\n";
        return 1;
    }
}
