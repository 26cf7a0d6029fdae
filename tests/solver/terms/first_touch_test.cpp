// Friction of what lands within a step: by Coulomb's law and by momentum, whatever the solver makes of it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact.h"
#include "tests/support/term_checks.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

namespace {

constexpr double side = 0.2, thick = 0.02, density = 1000, mass = density * side * side * thick;

/// A plate that lies or flies above a bone's flat top at y = 0: flat, so that it does not tip over, and stiff.
struct Landing {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;

    Landing(double height, const Vec3& velocity, const ContactValues& values) {
        TetMesh plate = box_mesh({side, thick, side}, 4, 1, 4), ground = box_mesh({3, 0.2, 3}, 1, 1, 1);
        for (Vec3& p : plate.vertices) p += Vec3(0.31, height, 0.27);
        for (Vec3& p : ground.vertices) p += Vec3(-1.5, -0.2, -1.5);
        const auto below = tissue(ground, ElasticLaw::stvk);
        description.bodies.emplace_back(tissue(plate, ElasticLaw::stvk));
        in.bodies.emplace_back(material(1e9, 0, density));
        description.bodies.emplace_back(bone(below->surface, below->triangles));
        in.bodies.emplace_back(BoneInputs{below->surface});
        for (const int body : {0, 1}) {
            description.parts.push_back({&contact_type, {body}, std::make_shared<ContactRest>()});
            put_fields(values, std::span(in.parts.emplace_back(contact_type.values.size())));
        }
        in.integrator = Integrator::backward_euler;
        scene = std::make_shared<const Scene>(description);
        workspace = std::make_unique<Workspace>(scene);
        const std::vector<InitialMotion> motions = {{velocity, {0, 0, 0}}, {}};
        state = initial_state(*scene, in, motions);
    }
    void step(int count = 1) {
        for (int i = 0; i < count; ++i) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
    }
    /// Of the centre of mass.
    Vec3 mean(const std::vector<double>& values) const {
        const TissueRest& t = *scene->tissue(0);
        Vec3 sum = Vec3::Zero();
        double volume = 0;
        for (const Tet& tet : t.tets.tets) {
            const auto p = [&](std::size_t i) { return t.tets.vertices[std::size_t(tet[i])]; };
            const double v = std::abs((p(1) - p(0)).cross(p(2) - p(0)).dot(p(3) - p(0))) / 6;
            volume += v;
            for (const int c : tet) sum += v / 4 * Eigen::Map<const Vec3>(values.data() + 3 * c);
        }
        return sum / volume;
    }
};

ContactValues with(double friction, bool slides = true) {
    ContactValues v;
    v.stiffness = 1e6, v.friction = friction, v.slides = slides ? 1 : 0;
    return v;
}

} // namespace

TEST_CASE("contact: what lands sliding loses mu times as much momentum along as across, in that step",
          "[contact][friction]") {
    constexpr double mu = 0.3, across = 1;
    for (const Integrator integrator : {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2})
        for (const double height : {0.0, 0.02})
            for (const Vec3& along : {Vec3(1, 0, 0), Vec3(-1.2, 0, 1.6)}) {
                Landing l(height, Vec3(along.x(), -across, along.z()), with(mu));
                l.in.integrator = integrator;
                l.step();
                const Vec3 lost = Vec3(along.x(), -across, along.z()) - l.mean(l.state.v);
                INFO("integrator " << static_cast<int>(integrator) << ", from " << height << " m, lost "
                                   << lost.transpose() << " m/s");
                CHECK(-lost.y() > 0.3 * across);
                CHECK(lost.x() == Approx(-mu * lost.y() * along.x() / along.norm()).epsilon(0.01));
                CHECK(lost.z() == Approx(-mu * lost.y() * along.z() / along.norm()).epsilon(0.01).margin(1e-3));
            }
}

TEST_CASE("contact: what lands and need not slide is pushed back to where it came in", "[contact][friction]") {
    // The springs of contact and friction are as stiff as each other, so the force is along the way since then, and
    // what is lost is along the velocity.
    for (const auto& [values, along] :
         {std::pair{with(0.8), 0.5}, {with(10), 2.0}, {with(0, false), 0.5}, {with(0, false), 2.0}})
        for (const double height : {0.0, 0.01, 0.03}) {
            Landing l(height, Vec3(along, -1, 0), values);
            l.step();
            const Vec3 v = l.mean(l.state.v);
            INFO("friction " << values.friction << ", at " << along << " m/s from " << height
                             << " m: " << v.transpose());
            CHECK(v.y() > -0.8);
            CHECK(along - v.x() == Approx(along * (1 + v.y())).epsilon(0.01));
        }
}

TEST_CASE("contact: what lands with much friction lies where it came down", "[contact][friction]") {
    constexpr double height = 0.02, g = 9.8, along = 0.7;
    for (const bool slides : {true, false}) {
        Landing l(height, Vec3(along, -1, 0), with(2, slides));
        const double before = l.mean(l.state.x).x();
        l.step();
        l.in.gravity = Vec3(0, -g, 0);
        l.step(60);
        INFO((slides ? "sliding" : "fixed"));
        CHECK(l.mean(l.state.x).x() - before == Approx(height * along).margin(1e-5));
        CHECK(l.mean(l.state.x).y() == Approx(0.5 * thick - mass * g / (1e6 * side * side)).epsilon(1e-3));
    }
}
