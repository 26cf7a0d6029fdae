// Values on wires: digests see everything but the clock; bodies are found again by what they are.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include "nodes/simulation_state.h"
#include "solver/terms/attachment/anchors.h"

using namespace bench;
using engine::Digest;
using nodes::BodyId;

namespace {

template <class T>
Digest digest(T v) {
    return engine::Value::of<T>(std::move(v)).digest();
}

solver::TermMemory attachments_memory(const solver::AttachmentMemory& kept) {
    solver::TermMemory memory{"attachment", 1, {}};
    keep_attachments(kept, memory);
    return memory;
}

solver::AttachmentMemory copy_of(const solver::AttachmentView& view) {
    solver::AttachmentMemory out{{}, view.starts};
    for (const auto& anchors : view.anchors) out.anchors.emplace_back(anchors.begin(), anchors.end());
    return out;
}

nodes::SimulationState small_state() {
    nodes::SimulationState s;
    s.scene.scale = 10;
    s.scene.bodies = {{1, 2}, {3, 4}};
    s.scene.modelled = {{}, {std::make_shared<const solver::Points>(solver::Points{{4, 5, 6}}), {7, 8}}};
    s.scene.attachments = {{5, 6}};
    s.scene.links = {{1, 0}};
    s.state.x = {1, 2, 3};
    s.state.v = {0, -1, 0};
    s.state.memories = {attachments_memory({{{{.source = {.tet = 3},
                                               .target = {.vertices = {7, 8, 9}, .coordinates = {0.5, 0.25, 0.25, 0}},
                                               .area_weight = 2}}},
                                            {{.painted = 2, .longest = 0.5}}})};
    s.state.bones = {{solver::Vec3(1, 2, 3)}, {}};
    s.state.steps = 4;
    s.state.record.residual = 1e-7;
    return s;
}

} // namespace

TEST_CASE("a state's digest covers every field but the seconds", "[nodes]") {
    const Digest base = digest(small_state());
    const auto changed = [&](auto edit) {
        nodes::SimulationState s = small_state();
        edit(s);
        return digest(std::move(s)) != base;
    };
    CHECK(changed([](auto& s) { s.residual_body = 1; }));
    CHECK(changed([](auto& s) { s.scene.scale = 11; }));
    CHECK(changed([](auto& s) { s.scene.bodies[1].lo = 9; }));
    CHECK(changed([](auto& s) { s.scene.modelled[1].digest.lo = 9; }));
    CHECK(changed([](auto& s) { s.scene.modelled[1].points = std::make_shared<const solver::Points>(2); }));
    CHECK(changed([](auto& s) { s.scene.attachments[0].hi = 9; }));
    CHECK(changed([](auto& s) { s.scene.links[0][1] = 2; }));
    CHECK(changed([](auto& s) { s.state.x[2] = 4; }));
    CHECK(changed([](auto& s) { s.state.v[0] = 1e-300; }));
    const auto attachments_changed = [&](auto edit) {
        return changed([&](auto& s) {
            solver::AttachmentMemory kept = copy_of(attachments_kept(s.state.memories));
            edit(kept);
            s.state.memories[0] = attachments_memory(kept);
            REQUIRE(copy_of(attachments_kept(s.state.memories)) == kept);
        });
    };
    CHECK_FALSE(attachments_changed([](auto&) {}));
    CHECK(attachments_changed([](auto& k) { k.anchors[0][0].source.tet = 4; }));
    CHECK(attachments_changed([](auto& k) { k.anchors[0][0].source.vertices[1] = 4; }));
    CHECK(attachments_changed([](auto& k) { k.anchors[0][0].source.coordinates[3] = 1; }));
    CHECK(attachments_changed([](auto& k) { k.anchors[0][0].target.tet = 4; }));
    CHECK(attachments_changed([](auto& k) { k.anchors[0][0].target.vertices[1] = 4; }));
    CHECK(attachments_changed([](auto& k) { k.anchors[0][0].target.coordinates[3] = 1; }));
    CHECK(attachments_changed([](auto& k) { k.anchors[0][0].offset[1] = 1; }));
    CHECK(attachments_changed([](auto& k) { k.anchors[0][0].area_weight = 1; }));
    CHECK(attachments_changed([](auto& k) { k.anchors.emplace_back(), k.starts.emplace_back(); }));
    CHECK(attachments_changed([](auto& k) { k.starts[0].painted = 1; }));
    CHECK(attachments_changed([](auto& k) { k.starts[0].left_out = 1; }));
    CHECK(attachments_changed([](auto& k) { k.starts[0].max_distance = 1; }));
    CHECK(attachments_changed([](auto& k) { k.starts[0].longest = 1; }));
    CHECK(attachments_changed([](auto& k) { k.starts[0].source_size = 1; }));
    CHECK(changed([](auto& s) { s.state.bones[0][0].x() = 2; }));
    CHECK(changed([](auto& s) { s.state.parts = {{1.0}}; }));
    CHECK(changed([](auto& s) { s.state.steps = 5; }));
    CHECK(changed([](auto& s) { s.state.linear.factor_steps_left = 5; }));
    CHECK(changed([](auto& s) { s.state.linear.late_iterations = 5; }));
    CHECK(changed([](auto& s) { s.state.linear.fresh_iterations = 5; }));
    const auto with_factor = [](solver::FactorSource of) {
        nodes::SimulationState s = small_state();
        s.state.linear.factor = std::make_shared<const solver::FactorSource>(std::move(of));
        return digest(std::move(s));
    };
    const Digest factored = with_factor({1, {2}, {0}});
    CHECK(factored != base);
    CHECK(factored == with_factor({1, {2}, {0}}));
    CHECK(factored != with_factor({2, {2}, {0}}));
    CHECK(factored != with_factor({1, {3}, {0}}));
    CHECK(factored != with_factor({1, {2}, {1}}));
    CHECK(changed([](auto& s) { s.state.history.step_size = 5; }));
    CHECK(changed([](auto& s) { s.state.history.x = {1}; }));
    CHECK(changed([](auto& s) { s.state.history.v = {1}; }));
    CHECK(changed([](auto& s) { s.state.history.acceleration = {1}; }));
    CHECK(changed([](auto& s) { s.state.memories.push_back({"elastic", 1, std::vector{std::byte{1}}}); }));
    CHECK(changed([](auto& s) { s.state.history.bones = {{}}; }));
    CHECK(changed([](auto& s) { s.state.history.values.emplace(); }));
    CHECK(changed([](auto& s) { s.state.record.halvings = 1; }));
    CHECK(changed([](auto& s) { s.state.record.residual = 1; }));
    CHECK(changed([](auto& s) { s.state.record.converged = false; }));
    CHECK(changed([](auto& s) { s.state.record.newton_iterations = 1; }));
    CHECK(changed([](auto& s) { s.state.record.linear_iterations = 1; }));
    CHECK(changed([](auto& s) { s.state.record.factorizations = 1; }));
    CHECK(changed([](auto& s) { s.state.record.substeps = 1; }));
    CHECK(changed([](auto& s) { s.state.record.energy = 1; }));
    CHECK(changed([](auto& s) { s.state.record.min_j = 0; }));
    CHECK(changed([](auto& s) { s.state.record.inverted = 1; }));
    CHECK(changed([](auto& s) {
        s.state.record.measured.push_back({solver::find_measure("attachment", "max_stretch_m"), 1});
    }));
    for (const int part : {0, 1})
        CHECK(changed([&](auto& s) {
            s.state.record.measured.push_back({solver::find_measure("hold", "force_x_N"), 1, part});
            s.state.record.measured.push_back({solver::find_measure("hold", "force_x_N"), 2, 1 - part});
        }));
    CHECK_FALSE(changed([](auto& s) { s.state.record.seconds_assembly = 1; }));
    CHECK_FALSE(changed([](auto& s) { s.state.record.seconds_factor = 1; }));
    CHECK_FALSE(changed([](auto& s) { s.state.record.seconds_solve = 1; }));
    CHECK_FALSE(changed([](auto& s) { s.state.record.seconds_other = 1; }));
}

TEST_CASE("a saved state loads bit for bit, and damaged bytes are refused", "[nodes]") {
    const std::vector<std::byte> bytes = nodes::save(small_state());
    CHECK(digest(nodes::load_simulation(bytes)) == digest(small_state()));
    for (std::size_t n = 0; n < bytes.size(); ++n)
        CHECK(codes([&] { nodes::load_simulation({bytes.data(), n}); }) == Codes{"IO403"});
    std::vector<std::byte> wrong(bytes);
    wrong[0] ^= std::byte{1};
    CHECK(codes([&] { nodes::load_simulation(wrong); }) == Codes{"IO403"});
}

TEST_CASE("a mesh's digest sees points and connectivity, and only its maker pays for the connectivity", "[nodes]") {
    const auto mesh = [](double z, int last) {
        return nodes::Mesh::from(solver::SurfaceMesh::from_triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, z}},
                                                                     {{0, 1, 2}, {0, 1, last}}));
    };
    CHECK(digest(mesh(1, 3)) == digest(mesh(1, 3)));
    CHECK(digest(mesh(1, 3)) != digest(mesh(2, 3)));
    CHECK(digest(mesh(1, 3)) != digest(mesh(1, 2)));
    CHECK(digest(mesh(0.0, 3)) == digest(mesh(-0.0, 3)));
    const nodes::Mesh m = mesh(1, 3);
    const engine::Value fresh = engine::Value::of<nodes::Mesh>(mesh(1, 3));
    const engine::Value moved = engine::Value::of<nodes::Mesh>(m.with_points(*m.points));
    CHECK(moved.bytes() < fresh.bytes());
    CHECK(moved.digest() == fresh.digest());
}

TEST_CASE("tets are told apart by what of them is solid, and by their element") {
    const auto tets = [](double coverage) {
        solver::TetMesh mesh;
        mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        mesh.tets = {{0, 1, 2, 3}};
        mesh.coverage = {coverage};
        return nodes::TetMeshValue::from(std::move(mesh));
    };
    CHECK(tets(0.5).digest == tets(0.5).digest);
    CHECK(tets(0.5).digest != tets(1).digest);
    CHECK(tets(1).with_element(solver::ElementKind::quadratic).digest != tets(1).digest);
    CHECK(tets(1).with_element(solver::ElementKind::linear).digest == tets(1).digest);
}

TEST_CASE("a scene's key changes with each of its fields") {
    nodes::SceneKey key;
    key.bodies = {Digest{1, 1}, Digest{2, 2}}, key.attachments = {Digest{3, 3}}, key.links = {{0, 1}};
    key.forces = {Digest{4, 4}}, key.reach = {{0, 1}};
    const Digest before = key.digest();
    const auto changes = [&](const std::function<void(nodes::SceneKey&)>& edit) {
        nodes::SceneKey other = key;
        edit(other);
        return other.digest() != before;
    };
    CHECK_FALSE(changes([](nodes::SceneKey&) {}));
    CHECK(changes([](nodes::SceneKey& k) { k.scale = 1; }));
    CHECK(changes([](nodes::SceneKey& k) { std::swap(k.bodies[0], k.bodies[1]); }));
    CHECK(changes([](nodes::SceneKey& k) { k.bodies.pop_back(); }));
    CHECK(changes([](nodes::SceneKey& k) { k.attachments[0] = Digest{5, 5}; }));
    CHECK(changes([](nodes::SceneKey& k) { std::swap(k.links[0][0], k.links[0][1]); }));
    CHECK(changes([](nodes::SceneKey& k) { k.forces[0] = Digest{5, 5}; }));
    CHECK(changes([](nodes::SceneKey& k) { k.reach[0] = {0}; }));
}

TEST_CASE("a body is another one with another value of a force or of its start, and contact stands aside") {
    const auto value = [](const std::string& inputs) {
        return bench::Session(
                   R"("ball": {"type": "polySphere"}, "flesh": {"type": "zMaterial", "inputs": {"pressure": 5}},
            "b": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}])" +
                   inputs + "}}")
            .pull("b", "outBody");
    };
    const auto id = [](const engine::Value& v) { return nodes::id_of(v.as<nodes::Body>()); };
    const engine::Value plain = value("");
    CHECK(id(value("")) == id(plain));
    CHECK(value("").aside_digest() == plain.aside_digest());
    for (const char* inputs : {R"(, "pressureEnvelope": 0.5)", R"(, "initialVelocity": [0, 1, 0])",
                               R"(, "initialAngularVelocity": [0, 1, 0])"}) {
        INFO(inputs);
        const engine::Value v = value(inputs);
        CHECK(id(v) != id(plain));
        CHECK(id(v).rest == id(plain).rest);
        CHECK(v.digest() != plain.digest());
        CHECK(v.aside_digest() == plain.aside_digest());
    }
    for (const char* inputs :
         {R"(, "contactFriction": 0.5)", R"(, "collisionSets": "1")", R"(, "collisions": false)"}) {
        INFO(inputs);
        const engine::Value v = value(inputs);
        CHECK(id(v) == id(plain));
        CHECK(v.digest() == plain.digest());
        CHECK(v.aside_digest() != plain.aside_digest());
        CHECK(v.whole_digest() != plain.whole_digest());
    }
}

TEST_CASE("a body is found by its rest data, then by its values, then by its earlier place", "[nodes]") {
    const Digest a{1, 1}, b{2, 2}, p{3, 3}, q{4, 4};
    const std::vector<BodyId> bodies{{a, p}, {b, p}, {b, q}, {a, p}};
    CHECK(nodes::find_body(std::vector<BodyId>{{a, p}, {b, p}}, {a, q}) == 0); // the only one of that shape
    CHECK(nodes::find_body(bodies, {b, q}) == 2);
    CHECK(nodes::find_body(bodies, {b, p}) == 1);
    CHECK(nodes::find_body(bodies, {{9, 9}, p}) == nodes::body_missing);
    CHECK(nodes::find_body(bodies, {b, {9, 9}}) == nodes::body_ambiguous);
    CHECK(nodes::find_body(bodies, {a, p}) == nodes::body_ambiguous);
    CHECK(nodes::find_body(bodies, {a, p}, 3) == 3);
    CHECK(nodes::find_body(bodies, {a, p}, 1) == nodes::body_ambiguous);
    CHECK(nodes::find_body(bodies, {a, p}, 77) == nodes::body_ambiguous);
}
