// zEmbedder: carried meshes follow affine motion exactly, and only tissues of the solver can carry.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include "engine/registry.h"
#include "solver/element/quadratic_tets.h"

using namespace bench;

namespace {

const solver::Mat3 stretch = (solver::Mat3() << 1.25, 0.5, 0, -0.25, 0.75, 0.125, 0.5, 0, 1.5).finished();
const solver::Vec3 shift(3, -2, 5);

solver::Points affine(solver::Points p) {
    for (solver::Vec3& x : p) x = stretch * x + shift;
    return p;
}

const engine::Wire<nodes::Body> body_in{.name = "body", .doc = "The body to deform."};
const engine::Output<nodes::Solved> solved_out{.name = "outSolved", .doc = "Its tets, moved by an affine map."};

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
        solver::Points midpoints;
        if (t.element == solver::ElementKind::quadratic)
            for (const auto& edge : solver::edges_of(t.tets.tets))
                midpoints.push_back(0.5 * (t.tets.vertices[static_cast<std::size_t>(edge[0])] +
                                           t.tets.vertices[static_cast<std::size_t>(edge[1])]));
        out.set(solved_out,
                nodes::Solved{{nodes::id_of(b)}, {b.rest}, {affine(t.tets.vertices)}, {affine(midpoints)}, {0}});
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
    Session s(scene +
              R"(, "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "bone.outBody"}]}},
        "e": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "t.outBody"}}},
        "b": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "bone.outBody"}}})");
    CHECK(codes([&] { s.pull("e", "outMeshes"); }) == Codes{"FE209"});
    CHECK(codes([&] { s.pull("b", "outMeshes"); }) == Codes{"FE218"});
}

TEST_CASE("a tissue's collision surface follows an affine motion exactly, with linear and quadratic tets", "[nodes]") {
    for (const std::string element : {"linear", "quadratic"}) {
        const std::string text =
            R"({"format": "sinew 1", "nodes": {)" + scene +
            R"(, "tets": {"type": "zTet", "inputs": {"mesh": {"from": "ball.outMesh"}, "element": ")" + element +
            R"("}},
            "shell": {"type": "polySphere", "inputs": {"radius": 2.1, "subdivisionsAxis": 9, "subdivisionsHeight": 7}},
            "s": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"}, "tets": {"from": "tets.outTets"},
                  "materials": [{"from": "flesh.outMaterial"}], "collisionShape": {"from": "shell.outMesh"}}},
            "a": {"type": "affine", "inputs": {"body": {"from": "s.outBody"}}},
            "e": {"type": "zEmbedder", "inputs": {"solved": {"from": "a.outSolved"}, "body": {"from": "s.outBody"}}},
            "blend": {"type": "zEmbedder", "inputs": {"envelope": 0.25, "solved": {"from": "a.outSolved"}, "body": {"from": "s.outBody"}}},
            "without": {"type": "zEmbedder", "inputs": {"solved": {"from": "b.outSolved"}, "body": {"from": "t.outBody"}}},
            "b": {"type": "affine", "inputs": {"body": {"from": "t.outBody"}}}}})";
        const auto graph = engine::read_graph(registry_with_affine(), text, "test.json").graph;
        Counter counter;
        engine::Evaluator evaluator({}, 1, &counter);
        const auto list = [&](const char* node) {
            return evaluator.pull({graph, {node, "outCollisionMeshes"}, 1}).as<nodes::MeshList>();
        };
        const auto shell = evaluator.pull({graph, {"shell", "outMesh"}, 1}).as<nodes::Mesh>();
        REQUIRE(list("e").meshes.size() == 1);
        CHECK(list("e").meshes[0].topology->digest == shell.topology->digest);
        CHECK(largest_difference(*list("e").meshes[0].points, affine(*shell.points)) < 1e-10);
        solver::Points quarter = affine(*shell.points);
        for (std::size_t i = 0; i < quarter.size(); ++i) quarter[i] = 0.25 * quarter[i] + 0.75 * (*shell.points)[i];
        CHECK(largest_difference(*list("blend").meshes[0].points, quarter) < 1e-10);
        CHECK(list("without").meshes.empty());
        CHECK(counter.warnings.empty());
    }
}

TEST_CASE("another collision surface moves nothing where nothing collides, and what rides is the new one", "[nodes]") {
    Session s(scene + R"(, "shell": {"type": "polySphere", "inputs": {"radius": 2.1, "subdivisionsAxis": 9}},
        "s": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "s.outBody"}]}},
        "e": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "s.outBody"}}})");
    const auto collision = [&] { return s.get<nodes::MeshList>("e", "outCollisionMeshes", 4).meshes; };
    REQUIRE(collision().empty());
    const engine::Digest bodies = s.pull("solver", "outMeshes", 4).digest();
    REQUIRE(s.counter.steps["solver"] == 4);
    s.set("s", "collisionShape", R"({"from": "shell.outMesh"})");
    REQUIRE(collision().size() == 1);
    const auto first = *collision()[0].points;
    s.set("shell", "radius", "1.5");
    CHECK(collision()[0].points->size() == first.size());
    CHECK(largest_difference(*collision()[0].points, first) == Approx(0.6).margin(0.05));
    // Nothing collides here, so the tissue moves as before.
    CHECK(s.pull("solver", "outMeshes", 4).digest() == bodies);
}

TEST_CASE("collision surfaces that cannot ride are refused at their input, and far vertices are warned of", "[nodes]") {
    const auto with = [](const std::string& shape) {
        return scene + R"(, "place": {"type": "transform", "inputs": {"mesh": {"from": "ball.outMesh"}, )" + shape +
               R"(}},
            "s": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}],
                  "collisionShape": {"from": "place.outMesh"}}})";
    };
    std::string text;
    CHECK(codes(with(R"("translate": [50, 0, 0])"), "s", "outBody", &text) == Codes{"FE239"});
    CHECK(text.find("collisionShape") != std::string::npos);
    CHECK(codes(scene + R"(, "nothing": {"type": "transform"},
            "s": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}],
                  "collisionShape": {"from": "nothing.outMesh"}}})",
                "s", "outBody", &text) == Codes{"FE201"});
    CHECK(text.find("collisionShape") != std::string::npos);
    Session wide(with(R"("scale": [4, 1, 1])"));
    wide.pull("s", "outBody");
    REQUIRE(wide.counter.warnings.size() == 1);
    CHECK(wide.counter.warnings[0].code == "FE239");
    CHECK(wide.counter.warnings[0].attribute == "collisionShape");
    Session near(with(R"("scale": [1.1, 1.1, 1.1])"));
    near.pull("s", "outBody");
    CHECK(near.counter.warnings.empty());
}

TEST_CASE("meshes that stand far from the tissue are not carried, and far vertices are warned of", "[nodes]") {
    const auto with = [](const std::string& place) {
        return scene + R"(, "place": {"type": "transform", "inputs": {"mesh": {"from": "ball.outMesh"}, )" + place +
               R"(}},
            "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "t.outBody"}]}},
            "e": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "t.outBody"},
                  "meshes": [{"from": "ball.outMesh"}, {"from": "place.outMesh"}]}})";
    };
    std::string text;
    CHECK(codes(with(R"("translate": [100, 0, 0])"), "e", "outMeshes", &text) == Codes{"FE239"});
    CHECK(text.find("e.meshes") != std::string::npos);
    CHECK(text.find("no vertex of place lies") != std::string::npos);
    CHECK(codes(with(R"("scale": [100, 100, 100])"), "e", "outMeshes") == Codes{"FE239"});
    Session wide(with(R"("scale": [4, 1, 1])"));
    wide.pull("e", "outMeshes");
    REQUIRE(wide.counter.warnings.size() == 1);
    CHECK(wide.counter.warnings[0].code == "FE239");
    CHECK(wide.counter.warnings[0].attribute == "meshes");
    CHECK(wide.counter.warnings[0].message.find("vertices of place lie") != std::string::npos);
    Session near(with(R"("scale": [1.1, 1.1, 1.1])"));
    near.pull("e", "outMeshes");
    CHECK(near.counter.warnings.empty());
}
