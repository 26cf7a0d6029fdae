// Contact between bodies that are attached: what an attachment holds firmly stays as it was modelled, overlap and all.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/marks_of.h"
#include "solver/mesh/primitives.h"
#include "solver/terms/contact/contact.h"
#include "tests/support/contact_parts.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

namespace {

constexpr double overlap = 0.01, contact_stiffness = 1e6;

/// A cube that was modelled with its bottom in a slab of bone, and is attached to it there.
struct CubeInSlab {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;

    explicit CubeInSlab(double attachment_stiffness) {
        TetMesh mesh = box_mesh(Vec3::Constant(0.1), 3, 3, 3);
        for (Vec3& p : mesh.vertices) p += Vec3(-0.05, -overlap, -0.05);
        const auto cube = tissue(mesh, ElasticLaw::neo_hookean);
        const SurfaceMesh box = make_cube(0.4, 0.1, 0.4, 12, 2, 12);
        Points slab = box.points;
        for (Vec3& p : slab) p.y() -= 0.05;
        description.bodies = {cube, bone(slab, box.triangles)};
        AttachmentRest a;
        a.source = 0, a.target = 1;
        for (const Vec3& p : cube->surface) a.source_weights.push_back(p.y() < 1e-9 - overlap ? 1 : 0);
        description.attachments = {a};
        in.bodies = {material(1e6, 0.3), BoneInputs{slab}};
        in.attachments = {{attachment_stiffness, 1, 0}};
        in.mass_damping = 20;
        ContactValues values;
        values.stiffness = contact_stiffness;
        let_collide(description, in, 2, values);
        scene = std::make_shared<const Scene>(description);
        workspace = std::make_unique<Workspace>(scene);
        state = initial_state(*scene, in);
    }
    void step(int count) {
        for (int i = 0; i < count; ++i) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
    }
    double measured(const char* name) const { return value_of(state.record.measured, "contact", name); }
    std::size_t listed() {
        marks_of(*workspace, state, in);
        return contacts_shown(*workspace).size();
    }
    /// How deep the middle of its bottom is.
    double depth() const {
        double low = 0;
        int count = 0;
        const Points now = surface_positions(*scene, state, 0);
        for (std::size_t v = 0; v < now.size(); ++v)
            if (scene->tissue(0)->surface[v].y() < 1e-9 - overlap) low += now[v].y(), ++count;
        return -low / count;
    }
};

} // namespace

TEST_CASE("contact: what an attachment holds more firmly than contact would push stays where it is", "[contact]") {
    CubeInSlab held(1e8);
    held.step(20);
    CHECK(held.measured("contacts") == 0);
    CHECK(held.listed() == 0);
    CHECK(held.depth() == Approx(overlap).epsilon(1e-9));
    // Let go, the same points are pushed out.
    held.in.attachments[0].set_mode(AttachmentMode::none);
    held.step(1);
    CHECK(held.measured("contacts") > 8);
    CHECK(held.listed() > 8);
    held.step(120);
    CHECK(held.depth() < 0.02 * overlap);
}

TEST_CASE("contact: against a softer attachment contact pushes", "[contact]") {
    // Springs of both over the same area: contact x depth = attachment x (overlap - depth).
    constexpr double attachment = 2e5;
    CubeInSlab soft(attachment);
    soft.step(160);
    CHECK(soft.measured("contacts") > 8);
    CHECK(soft.depth() == Approx(overlap * attachment / (attachment + contact_stiffness)).epsilon(0.03));
}

TEST_CASE("contact: what two attachments hold to the same place of a third body stays where it is", "[contact]") {
    // Two low blocks that were modelled in each other by a centimetre, both with their bottoms on one bone, which does
    // not collide.
    SceneDescription description;
    StepInputs in = still_inputs();
    for (const double x : {0.0, 0.1 - overlap}) {
        TetMesh mesh = box_mesh({0.1, 0.02, 0.1}, 3, 2, 5);
        for (Vec3& p : mesh.vertices) p.x() += x;
        description.bodies.emplace_back(tissue(mesh, ElasticLaw::neo_hookean));
        in.bodies.emplace_back(material(1e5, 0.3));
    }
    const SurfaceMesh box = make_cube(0.6, 0.1, 0.4, 12, 2, 12);
    Points slab = box.points;
    for (Vec3& p : slab) p.y() -= 0.05;
    description.bodies.emplace_back(bone(slab, box.triangles));
    in.bodies.emplace_back(BoneInputs{slab});
    ContactValues values;
    values.stiffness = contact_stiffness;
    for (int body = 0; body < 2; ++body) {
        AttachmentRest a;
        a.source = body, a.target = 2;
        for (const Vec3& p :
             std::get<std::shared_ptr<const TissueRest>>(description.bodies[std::size_t(body)])->surface)
            a.source_weights.push_back(p.y() < 1e-9 ? 1 : 0);
        description.attachments.push_back(a);
        in.attachments.push_back({2.1 * contact_stiffness, 1, 0}); // in series more than contact
        description.parts.push_back({&contact_type, {body}, std::make_shared<ContactRest>()});
        put_fields(values, std::span(in.parts.emplace_back(contact_type.values.size())));
    }
    in.mass_damping = 20;
    const auto scene = std::make_shared<const Scene>(description);
    Workspace workspace(scene);
    State state = initial_state(*scene, in);
    const auto contacts_after = [&](int steps) {
        for (int i = 0; i < steps; ++i) {
            state = advance(workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
        return value_of(state.record.measured, "contact", "contacts");
    };
    const auto reach = [&] { // of the first in the second
        double left = 1, right = 0;
        for (const Vec3& p : surface_positions(*scene, state, 0)) right = std::max(right, p.x());
        for (const Vec3& p : surface_positions(*scene, state, 1)) left = std::min(left, p.x());
        return right - left;
    };
    CHECK(contacts_after(10) == 0);
    CHECK(reach() == Approx(overlap).epsilon(1e-9));
    // Softer in series than contact, they are pushed apart; and more so where one lets go.
    in.attachments[1].stiffness = 1.9 * contact_stiffness;
    CHECK(contacts_after(60) > 4);
    const double pressed = reach();
    CHECK(pressed < 0.95 * overlap);
    in.attachments[1].stiffness = 0;
    contacts_after(60);
    CHECK(reach() < 0.05 * overlap);
}
