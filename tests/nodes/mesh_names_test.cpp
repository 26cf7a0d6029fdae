// Meshes of a list found by the names of their bodies.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "nodes/mesh_names.h"

using namespace bench;

TEST_CASE("a body's mesh is found by name also after the node was renamed", "[nodes]") {
    Session s(R"("cube": {"type": "polyCube"}, "ball": {"type": "polySphere"},
      "hip": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}}},
      "knee": {"type": "zBone", "inputs": {"mesh": {"from": "ball.outMesh"}, "enable": false}},
      "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "hip.outBody"}, {"from": "knee.outBody"}]}})");
    const engine::Plug plug{"solver", "outMeshes"};
    const auto meshes = s.get<nodes::MeshList>("solver", "outMeshes");
    const auto size_of = [&](const std::string& name) {
        const nodes::Mesh* mesh = nodes::find_mesh(*s.graph, plug, meshes, name);
        return mesh ? static_cast<int>(mesh->points->size()) : -1;
    };
    CHECK(size_of("hip") == 8);
    CHECK(size_of("knee") == static_cast<int>(s.get<nodes::Mesh>("ball", "outMesh").points->size()));
    CHECK(size_of("cube") == -1);
    s.graph = engine::Edit(s.graph).rename_node("hip", "femur").commit().graph;
    CHECK(size_of("femur") == 8);
    CHECK(size_of("hip") == -1);
    CHECK(nodes::mesh_names(*s.graph, plug, 2) == std::vector<std::string>{"femur", "knee"});
    CHECK(nodes::mesh_names(*s.graph, {"cube", "outMesh"}, 1).empty());
}
