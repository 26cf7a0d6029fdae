// zEmbedder: carried meshes follow affine motion exactly, and only tissues of the solver can carry.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include "engine/registry.h"

using namespace bench;

namespace {

const solver::Mat3 stretch = (solver::Mat3() << 1.25, 0.5, 0, -0.25, 0.75, 0.125, 0.5, 0, 1.5).finished();
const solver::Vec3 shift(3, -2, 5);

solver::Points affine(solver::Points p) {
    for (solver::Vec3& x : p) x = stretch * x + shift;
    return p;
}

const engine::Wire<nodes::Body> body_in{.name = "body", .doc = "The body to deform."};
const engine::Output<nodes::Solved> solved_out{.name = "outSolved",
                                               .doc = "Its tets, moved by an affine map."};

/// All node types and one more that moves a tissue's tets by a given affine map.
std::shared_ptr<const engine::Registry> registry_with_affine() {
    auto registry = std::make_shared<engine::Registry>();
    nodes::register_all(*registry);
    engine::NodeType type;
    type.name = "affine";
    type.doc = "Test: moves tets by an affine map.";
    type.inputs = {engine::describe(body_in)};
    type.outputs = {engine::describe(solved_out)};
    type.compute = [](const engine::Reads& in, engine::Writes& out) {
        const nodes::Body& b = in[body_in];
        const auto& t = *std::get<std::shared_ptr<const solver::TissueRest>>(b.rest->data);
        out.set(solved_out, nodes::Solved{{nodes::id_of(b)}, {b.rest}, {affine(t.tets.vertices)}, {}});
    };
    registry->add(std::move(type));
    return registry;
}

const std::string scene =
    R"("ball": {"type": "polySphere", "inputs": {"radius": 2}}, "flesh": {"type": "zMaterial"},
    "t": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}},
    "helix": {"type": "polyHelix"}, "far": {"type": "polyPlane", "inputs": {"width": 30, "height": 30}},
    "bone": {"type": "zBone", "inputs": {"mesh": {"from": "helix.outMesh"}}})";

} // namespace

TEST_CASE("carried meshes follow an affine motion exactly, inside the tets and outside", "[nodes]") {
    const std::string text = R"({"format": "sinew 1", "nodes": {)" + scene +
                             R"(, "a": {"type": "affine", "inputs": {"body": {"from": "t.outBody"}}},
        "e": {"type": "zEmbedder", "inputs": {"solved": {"from": "a.outSolved"}, "body": {"from": "t.outBody"},
              "meshes": [{"from": "helix.outMesh"}, {"from": "far.outMesh"}]}},
        "own": {"type": "zEmbedder", "inputs": {"solved": {"from": "a.outSolved"}, "body": {"from": "t.outBody"}}},
        "half": {"type": "zEmbedder", "inputs": {"envelope": 0.5, "solved": {"from": "a.outSolved"}, "body": {"from": "t.outBody"}}},
        "off": {"type": "zEmbedder", "inputs": {"envelope": 0, "solved": {"from": "a.outSolved"}, "body": {"from": "t.outBody"}}}}})";
    const auto graph = engine::read_graph(registry_with_affine(), text, "test.json").graph;
    engine::Evaluator evaluator;
    const auto list = [&](const char* node) {
        return evaluator.pull({graph, {node, "outMeshes"}, 1}).as<nodes::MeshList>();
    };
    const auto mesh = [&](const char* node) {
        return *evaluator.pull({graph, {node, "outMesh"}, 1}).as<nodes::Mesh>().points;
    };
    const nodes::MeshList carried = list("e");
    REQUIRE(carried.meshes.size() == 2);
    CHECK(largest_difference(*carried.meshes[0].points, affine(mesh("helix"))) < 1e-12);
    CHECK(largest_difference(*carried.meshes[1].points, affine(mesh("far"))) < 1e-10);
    REQUIRE(list("own").meshes.size() == 1);
    CHECK(largest_difference(*list("own").meshes[0].points, affine(mesh("ball"))) < 1e-12);
    CHECK(largest_difference(*list("off").meshes[0].points, mesh("ball")) == 0);
    solver::Points middle = affine(mesh("ball"));
    for (std::size_t i = 0; i < middle.size(); ++i) middle[i] = 0.5 * (middle[i] + mesh("ball")[i]);
    CHECK(largest_difference(*list("half").meshes[0].points, middle) < 1e-12);
}

TEST_CASE("a simulated tissue's own mesh comes out of embedder and solver alike", "[nodes]") {
    Session s(scene +
              R"(, "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "t.outBody"}]}},
        "e": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "t.outBody"}}})");
    CHECK(largest_difference(*s.get<nodes::MeshList>("e", "outMeshes", 3).meshes[0].points,
                             *s.get<nodes::MeshList>("solver", "outMeshes", 3).meshes[0].points) < 1e-13);
}

TEST_CASE("an embedder refuses bones and bodies of other solvers", "[nodes]") {
    Session s(
        scene +
        R"(, "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "bone.outBody"}]}},
        "e": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "t.outBody"}}},
        "b": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "bone.outBody"}}})");
    CHECK(codes([&] { s.pull("e", "outMeshes"); }) == Codes{"FE209"});
    CHECK(codes([&] { s.pull("b", "outMeshes"); }) == Codes{"FE218"});
}
