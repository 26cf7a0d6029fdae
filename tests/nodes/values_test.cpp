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

nodes::SimulationState small_state() {
    nodes::SimulationState s;
    s.scene.scale = 10;
    s.scene.bodies = {{1, 2}, {3, 4}};
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
    CHECK(changed([](auto& s) { s.scene.attachments[0].hi = 9; }));
    CHECK(changed([](auto& s) { s.scene.links[0][1] = 2; }));
    CHECK(changed([](auto& s) { s.state.x[2] = 4; }));
    CHECK(changed([](auto& s) { s.state.v[0] = 1e-300; }));
    const auto attachments_changed = [&](auto edit) {
        return changed([&](auto& s) {
            solver::AttachmentMemory kept = attachments_kept(s.state.memories);
            edit(kept);
            s.state.memories[0] = attachments_memory(kept);
            REQUIRE(attachments_kept(s.state.memories) == kept);
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
