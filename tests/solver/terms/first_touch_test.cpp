// Friction of what lands within a step: by Coulomb's law and by momentum, whatever the solver makes of it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact.h"
#include "tests/support/term_checks.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

namespace {

constexpr double side = 0.2, thick = 0.02, density = 1000, mass = density * side * side * thick;

/// What lies or flies above a bone's flat top at y = 0: a plate, flat, so that it does not tip over, and stiff, or
/// another body.
struct Landing {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;

    Landing(double height, const Vec3& velocity, const ContactValues& values)
        : Landing(box_mesh({side, thick, side}, 4, 1, 4), 1e9, height, velocity, values) {}
    Landing(TetMesh plate, double young, double height, const Vec3& velocity, const ContactValues& values,
            TetMesh ground = box_mesh({3, 0.2, 3}, 1, 1, 1)) {
        Vec3 high = Vec3::Zero();
        for (const Vec3& p : ground.vertices) high = high.cwiseMax(p);
        for (Vec3& p : plate.vertices) p += Vec3(0.31, height, 0.27);
        for (Vec3& p : ground.vertices) p -= Vec3(high.x() / 2, high.y(), high.z() / 2);
        const auto below = tissue(ground, ElasticLaw::stvk);
        description.bodies.emplace_back(tissue(plate, ElasticLaw::stvk));
        in.bodies.emplace_back(material(young, 0, density));
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

TEST_CASE("contact: a soft body that hits the ground sliding loses mu times as much along as across, over the impact",
          "[contact][friction]") {
    // How hard it presses changes from step to step, by the most where it hits, and friction is renewed as it does.
    constexpr double mu = 0.3;
    TetMesh cube = box_mesh({side, side, side}, 4, 4, 4);
    const Mat3 turn =
        (Eigen::AngleAxisd(0.6, Vec3::UnitX()) * Eigen::AngleAxisd(0.4, Vec3::UnitZ())).toRotationMatrix();
    for (Vec3& p : cube.vertices) p = turn * p;
    double lowest = 0;
    for (const Vec3& p : cube.vertices) lowest = std::min(lowest, p.y());
    Landing l(cube, 1e5, 0.01 - lowest, Vec3(6, -3, 0), with(mu));
    const Vec3 before = l.mean(l.state.v);
    l.step(6); // it is off the ground again
    const Vec3 change = l.mean(l.state.v) - before;
    CHECK(change.y() > 3);
    CHECK(-change.x() / change.y() == Approx(mu).epsilon(0.01));
}

TEST_CASE("contact: what falls onto the ground within the step that it begins to fall in is braked there too",
          "[contact][friction]") {
    // At the start of the step nothing moves towards the ground: gravity alone brings it there.
    constexpr double mu = 0.3, g = 9.8, along = 0.5;
    for (const Integrator integrator : {Integrator::backward_euler, Integrator::bdf2})
        for (const double height : {0.001, 0.005}) {
            Landing l(height, Vec3(along, 0, 0), with(mu));
            l.in.integrator = integrator, l.in.gravity = Vec3(0, -g, 0);
            l.step();
            const Vec3 v = l.mean(l.state.v);
            const double pushed = v.y() + g * l.in.step_size;
            INFO("integrator " << static_cast<int>(integrator) << ", from " << height << " m: " << v.transpose());
            CHECK(pushed > 0.2);
            CHECK(along - v.x() == Approx(mu * pushed).epsilon(0.01));
        }
}

TEST_CASE("contact: what falls onto a slope that is rough enough stays where it came down", "[contact][friction]") {
    // Gravity turned: the ground is a slope of 18 degrees, and straight down is not along its normal.
    constexpr double g = 9.8, slope = 18 * std::numbers::pi / 180, height = 0.0005;
    for (const bool slides : {true, false}) {
        Landing l(height, Vec3(0, 0, 0), with(0.6, slides));
        l.in.gravity = g * Vec3(std::sin(slope), -std::cos(slope), 0);
        const double before = l.mean(l.state.x).x();
        l.step();
        INFO((slides ? "sliding" : "fixed"));
        const double down = height * std::tan(slope), give = mass * g * std::sin(slope) / (1e6 * side * side);
        CHECK(l.mean(l.state.x).x() - before == Approx(down).margin(2 * give));
    }
}

TEST_CASE("contact: ground of fine triangles that sweeps by below a body drags it by mu times its weight",
          "[contact][friction]") {
    // In a step the ground moves several of the body's edges far, so its points come in by the body's side, a hair
    // above the bottom that they slide along from there.
    constexpr double mu = 0.3, g = 9.8, speed = 3;
    Landing l(box_mesh({side, thick, side}, 8, 1, 8), 1e9, 0, Vec3(0, 0, 0), with(mu),
              box_mesh({9, 0.2, 1.2}, 180, 1, 24));
    l.in.gravity = Vec3(0, -g, 0);
    l.step(20);
    auto& ground = std::get<BoneInputs>(l.in.bodies[1]).positions;
    constexpr int steps = 10;
    const Vec3 before = l.mean(l.state.v);
    for (int k = 0; k < steps; ++k) {
        for (Vec3& p : ground) p.x() += speed * l.in.step_size;
        l.step();
    }
    const Vec3 change = l.mean(l.state.v) - before;
    CHECK(change.x() == Approx(mu * g * steps * l.in.step_size).epsilon(0.01));
    CHECK(std::abs(change.z()) < 1e-4);
    CHECK(std::abs(change.y()) < 1e-4);
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
