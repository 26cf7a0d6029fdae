// How high things jump that fall on a bone under TR-BDF2, whose trapezoid stage must not push once more by the force
// that has just stopped them.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/terms/contact/contact.h"
#include "tests/support/contact_parts.h"
#include "tests/support/sheets.h"
#include "tests/support/solver_scenes.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

constexpr double drop = 0.04, gravity = 9.8;

/// A bone with its top at y = 0, and what is above it.
struct Falling {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;

    template <class Body, class Values>
    Falling(const Body& body, const Values& values, double thickness) {
        SurfaceMesh floor = make_cube(0.6, 0.02, 0.6, 1, 1, 1);
        for (Vec3& p : floor.points) p.y() -= 0.01;
        description.bodies = {body, bone(floor.points, floor.triangles)};
        in.bodies = {values, BoneInputs{floor.points}};
        in.integrator = Integrator::tr_bdf2;
        in.gravity = Vec3(0, -gravity, 0);
        for (const double thick : {thickness, 0.0}) {
            auto rest = std::make_shared<ContactRest>();
            rest->thickness = thick, rest->is_volume = thick == 0;
            description.parts.push_back({&contact_type, {static_cast<int>(in.parts.size())}, std::move(rest)});
            ContactValues contact;
            contact.stiffness = thick > 0 ? 1e5 : 1e6;
            put_fields(contact, std::span(in.parts.emplace_back(contact_type.values.size())));
        }
        scene = std::make_shared<const Scene>(description);
        workspace = std::make_unique<Workspace>(scene);
        state = initial_state(*scene, in);
    }
    double height() const {
        double sum = 0;
        const Points points = surface_positions(*scene, state, 0);
        for (const Vec3& p : points) sum += p.y();
        return sum / static_cast<double>(points.size());
    }
    /// How high it gets within a second after it has landed, as a share of how far it fell.
    double rebound(int substeps) {
        in.step_size = 1.0 / 24 / substeps;
        const double above = height();
        double lowest = above, highest = 0;
        bool landed = false;
        for (int step = 0; step < 24 * substeps; ++step) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
            landed = landed || value_of(state.record.measured, "contact", "contacts") > 0;
            if (!landed) continue;
            lowest = std::min(lowest, height()), highest = std::max(highest, height() - lowest);
        }
        CHECK(landed);
        return highest / drop;
    }
};

} // namespace

TEST_CASE("contact: with TR-BDF2 a sheet that lands flat does not jump", "[contact]") {
    for (const int substeps : {1, 4, 16}) {
        INFO(substeps << " sub-steps");
        Sheet sheet = make_sheet(evenly(0, 0.08, 8), 0.08, 8, Weave::crossed);
        for (Vec3& p : sheet.points) p = Vec3(p.x(), drop, p.y());
        Falling f(cloth(sheet.points, sheet.triangles), cloth_material(500, 100, 1e-3, 0.2), 0.001);
        CHECK(f.rebound(substeps) < 0.1);
    }
}

TEST_CASE("contact: with TR-BDF2 a block that lands rises by less than it fell", "[contact]") {
    for (const int substeps : {1, 4, 16}) {
        INFO(substeps << " sub-steps");
        TetMesh mesh = box_mesh(Vec3::Constant(0.04), 2, 2, 2);
        for (Vec3& p : mesh.vertices) p.y() += drop;
        Falling f(tissue(mesh, ElasticLaw::neo_hookean), material(1e5, 0.3, 1000), 0);
        CHECK(f.rebound(substeps) < 1);
    }
}

TEST_CASE("contact: with TR-BDF2 a block comes to rest as deep as its weight presses", "[contact]") {
    TetMesh mesh = box_mesh(Vec3::Constant(0.04), 2, 2, 2);
    for (Vec3& p : mesh.vertices) p.y() += 0.01;
    Falling f(tissue(mesh, ElasticLaw::neo_hookean), material(1e6, 0, 1000), 0);
    f.in.mass_damping = 30;
    f.rebound(4);
    const double weight = 1000 * gravity * 0.04 * 0.04 * 0.04;
    CHECK(value_of(f.state.record.measured, "contact", "force_N") == Catch::Detail::Approx(weight).epsilon(1e-4));
    CHECK(value_of(f.state.record.measured, "contact", "max_depth_m") ==
          Catch::Detail::Approx(weight / (1e6 * 0.04 * 0.04)).epsilon(0.01));
}
