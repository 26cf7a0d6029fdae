// A body that is switched off does not move, and what touches it or is attached to it moves as against one that is held
// everywhere.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact_memory.h"
#include "solver/terms/sliding/sliding.h"
#include "tests/support/contact_parts.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

enum class Tie { contact, fixed, sliding };
constexpr Tie ties[] = {Tie::contact, Tie::fixed, Tie::sliding};
constexpr ElementKind kinds[] = {ElementKind::linear, ElementKind::quadratic};

/// A block that touches the middle of a slab or is attached to it.
struct OnSlab {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;
    int newton = 0;

    /// `held`: flags by place the slab's vertices that do not move.
    OnSlab(Tie tie, ElementKind of_block, ElementKind of_slab, LinearMethod method,
           const std::function<bool(const Vec3&)>& held = {}, int fineness = 5) {
        const auto box = [&](const Vec3& size, const Vec3& corner, int n, ElementKind element) {
            TetMesh mesh = box_mesh(size, n, n, n);
            for (Vec3& p : mesh.vertices) p += corner;
            auto out = tissue(mesh, ElasticLaw::neo_hookean);
            out->element = element;
            return out;
        };
        const auto block = box(Vec3::Constant(0.1), {0.11, 0.101, 0.09}, 3, of_block);
        const auto slab = box({0.3, 0.1, 0.3}, Vec3::Zero(), fineness, of_slab);
        if (held) slab->fixed_vertices = vertices_where(slab->tets.vertices, held);
        description.bodies = {block, slab};
        in.bodies = {material(3e4, 0.3), material(3e4, 0.3)};
        in.gravity = Vec3(0.5, -9.8, 0.2);
        in.step_size = 1.0 / 48;
        in.linear_method = method;
        if (tie == Tie::contact) {
            ContactValues values;
            values.stiffness = 1e7, values.friction = 0.2, values.damping = 1e4;
            let_collide(description, in, 2, values);
            return;
        }
        AttachmentRest a;
        a.source = 0, a.target = 1;
        for (const Vec3& p : block->surface) a.source_weights.push_back(p.y() < 0.1011 ? 1 : 0);
        description.attachments = {a};
        in.attachments = {{1e7, 1, 1e4}};
        if (tie == Tie::sliding) in.attachments[0].set_mode(AttachmentMode::sliding);
    }
    void switch_slab(bool on) { std::get<TissueInputs>(in.bodies[1]).enable = on ? 1 : 0; }
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
    std::vector<double> slab_in(const std::vector<double>& v) const {
        return {v.begin() + 3 * scene->first_vertex(1), v.end()};
    }
};

} // namespace

TEST_CASE("a body that is off is to what touches it or is attached to it as one that is held", "[contact][sliding]") {
    const auto everywhere = [](const Vec3&) { return true; };
    for (const Tie tie : ties)
        for (const ElementKind kind : kinds)
            for (const LinearMethod method : {LinearMethod::direct, LinearMethod::automatic, LinearMethod::iterative}) {
                INFO(static_cast<int>(tie) << " " << static_cast<int>(kind) << " " << static_cast<int>(method));
                OnSlab held(tie, kind, ElementKind::linear, method, everywhere),
                    off(tie, kind, ElementKind::linear, method);
                off.switch_slab(false);
                held.step(15), off.step(15);
                double apart = 0, moved = 0;
                for (std::size_t v = 0; v < off.scene->vertex_count(0); ++v) {
                    const Vec3 there = position(off.state, static_cast<int>(v));
                    apart = std::max(apart, (there - position(held.state, static_cast<int>(v))).norm());
                    const double* modelled = off.scene->numbering().rest.data() + 3 * v;
                    moved = std::max(moved, (there - Eigen::Map<const Vec3>(modelled)).norm());
                }
                CHECK(moved > 1e-3);
                CHECK(apart < (method == LinearMethod::direct ? 1e-6 : 1e-3) * moved);
                CHECK(off.slab_in(off.state.x) == off.slab_in(off.scene->numbering().rest));
                // Newton would not go straight there if the body that is off gave way in the matrix.
                // Where the method goes by the number of unknowns, of which one that is off has some, it may be
                // another.
                if (method == LinearMethod::automatic) continue;
                CHECK(4 * off.newton <= 5 * held.newton);
                // A quadratic one, which has other points that touch, takes about as many.
                OnSlab of_two(tie, kind, ElementKind::quadratic, method);
                of_two.switch_slab(false);
                of_two.step(15);
                CHECK(2 * of_two.newton < 3 * held.newton);
                if (tie != Tie::contact) continue;
                ContactMemory kept;
                contacts_kept(off.state.memories, kept);
                CHECK(kept.contacts.size() > 3);
                CHECK(kept.couplings.empty()); // of what presses on what is off nothing is laid out anew
            }
}

TEST_CASE("a body that is switched off while it moves stands, and what touches it sees it stand",
          "[contact][sliding]") {
    const auto bottom = [](const Vec3& p) { return p.y() < 1e-9; };
    for (const Tie tie : ties)
        for (const ElementKind kind : kinds)
            for (const Integrator scheme : {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2}) {
                INFO(static_cast<int>(tie) << " " << static_cast<int>(kind) << " " << static_cast<int>(scheme));
                // More unknowns than a factor is always made anew for, so that one of when both moved is there yet.
                OnSlab on(tie, ElementKind::linear, kind, LinearMethod::automatic, bottom, 6);
                on.in.integrator = scheme;
                on.step(6);
                OnSlab stood(tie, ElementKind::linear, kind, LinearMethod::automatic, bottom, 6);
                stood.in = on.in;
                stood.step(0);
                // The same, but for a slab that has not moved before.
                stood.state = on.state;
                const auto first = 3 * stood.scene->first_vertex(1);
                History& h = stood.state.history;
                for (auto* v : {&stood.state.v, &h.v})
                    if (!v->empty()) std::fill(v->begin() + first, v->end(), 0.0);
                h.acceleration.clear();
                if (!h.x.empty()) std::copy(stood.state.x.begin() + first, stood.state.x.end(), h.x.begin() + first);
                if (tie == Tie::fixed && scheme == Integrator::backward_euler) REQUIRE(on.state.linear.factor);
                const std::vector<double> there = on.slab_in(on.state.x);
                CHECK(on.slab_in(on.state.v) != std::vector<double>(there.size(), 0.0));
                on.switch_slab(false), stood.switch_slab(false);
                for (int k = 0; k < 4; ++k) {
                    on.step(1), stood.step(1);
                    CHECK(on.slab_in(on.state.x) == there);
                    CHECK(on.state.x == stood.state.x);
                }
            }
}
