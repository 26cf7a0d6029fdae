// What touches a body that is switched off, or is attached to it, moves as against one that is held everywhere.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/sliding/sliding.h"
#include "tests/support/contact_parts.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

enum class Tie { contact, fixed, sliding };

/// A block above the middle of a slab that does not move: all of its vertices are held, or it is off.
struct OnSlab {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;
    int newton = 0;

    OnSlab(Tie tie, ElementKind kind, ElementKind of_slab, bool held) {
        const auto box = [&](const Vec3& size, const Vec3& corner, int n, ElementKind element) {
            TetMesh mesh = box_mesh(size, n, n, n);
            for (Vec3& p : mesh.vertices) p += corner;
            auto out = tissue(mesh, ElasticLaw::neo_hookean);
            out->element = element;
            return out;
        };
        const auto block = box(Vec3::Constant(0.1), {0.11, 0.101, 0.09}, 3, kind);
        const auto slab = box({0.3, 0.1, 0.3}, Vec3::Zero(), 5, of_slab);
        if (held) slab->fixed_vertices = vertices_where(slab->tets.vertices, [](const Vec3&) { return true; });
        description.bodies = {block, slab};
        in.bodies = {material(3e4, 0.3), material(3e4, 0.3)};
        if (!held) std::get<TissueInputs>(in.bodies[1]).enable = 0;
        in.gravity = Vec3(0.5, -9.8, 0.2);
        in.step_size = 1.0 / 48;
        in.linear_method = LinearMethod::direct;
        if (tie == Tie::contact) {
            ContactValues values;
            values.stiffness = 1e7, values.friction = 0.2;
            let_collide(description, in, 2, values);
            return;
        }
        AttachmentRest a;
        a.source = 0, a.target = 1;
        for (const Vec3& p : block->surface) a.source_weights.push_back(p.y() < 0.1011 ? 1 : 0);
        description.attachments = {a};
        in.attachments = {{1e7, 1, 0}};
        if (tie == Tie::sliding) in.attachments[0].set_mode(AttachmentMode::sliding);
    }
    void step(int count) {
        if (!workspace) {
            scene = std::make_shared<const Scene>(description);
            workspace = std::make_unique<Workspace>(scene);
            state = initial_state(*scene, in);
        }
        for (int i = 0; i < count; ++i) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
            newton += state.record.newton_iterations;
        }
    }
};

} // namespace

TEST_CASE("a body that is off is to what touches it or is attached to it as one that is held", "[contact][sliding]") {
    for (const Tie tie : {Tie::contact, Tie::fixed, Tie::sliding})
        for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
            INFO(static_cast<int>(tie) << " " << static_cast<int>(kind));
            OnSlab held(tie, kind, ElementKind::linear, true), off(tie, kind, ElementKind::linear, false);
            held.step(15), off.step(15);
            double apart = 0, moved = 0;
            for (std::size_t v = 0; v < off.scene->vertex_count(0); ++v) {
                const Vec3 there = position(off.state, static_cast<int>(v));
                apart = std::max(apart, (there - position(held.state, static_cast<int>(v))).norm());
                moved = std::max(moved,
                                 (there - Eigen::Map<const Vec3>(off.scene->numbering().rest.data() + 3 * v)).norm());
            }
            CHECK(moved > 1e-3);
            CHECK(apart < 1e-6 * moved);
            // Newton would not go straight there if the body that is off gave way in the matrix.
            CHECK(off.newton <= held.newton + 2);
            OnSlab of_two(tie, kind, ElementKind::quadratic, false);
            of_two.step(15);
            CHECK(2 * of_two.newton < 3 * held.newton);
        }
}
