// Inertial damping takes the momentum of translation, rotation, shear and scaling and leaves waves; frozen bodies
// stand.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "tests/support/sheets.h"
#include "tests/support/trial.h"

#include <numbers>

using namespace sinew::test;

namespace {

constexpr double pi = std::numbers::pi;
constexpr Integrator dynamic[] = {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2};

/// A bar of 1 m without Poisson's effect, in which waves run at 10 m/s, free in space.
struct Bar : Trial {
    explicit Bar(Integrator scheme, double damping, ElementKind kind = ElementKind::linear)
        : Trial(box_mesh({1, 0.1, 0.1}, 32, 1, 1), ElasticLaw::stvk, kind, nowhere, material(1e5, 0, 1000)) {
        in.integrator = scheme;
        in.step_size = 1.0 / 2400;
        in.tolerance_factor = 1e-4;
        values().inertial_damping = damping;
        values().compression_resistance = 0;
        start();
    }
    void set_velocity(const Map& of) {
        for (std::size_t v = 0; v < nodes.size(); ++v) {
            const Vec3 u = of(nodes[v]);
            std::copy_n(u.data(), 3, state.v.begin() + static_cast<std::ptrdiff_t>(3 * v));
        }
    }
    void run(int steps) {
        for (int k = 0; k < steps; ++k) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
    }
    /// Share of a velocity field in the velocities, by masses as the scene has them.
    double part(const Map& field) const {
        Potential potential(*scene);
        potential.take(state, in);
        const std::vector<double>& mass = potential.masses().weight();
        double both = 0, own = 0;
        for (std::size_t v = 0; v < nodes.size(); ++v) {
            const Vec3 u = field(nodes[v]), w(state.v[3 * v], state.v[3 * v + 1], state.v[3 * v + 2]);
            both += mass[v] * u.dot(w), own += mass[v] * u.squaredNorm();
        }
        return both / own;
    }
};

/// The fourth longitudinal mode of a free bar of 1 m: 20 Hz at 10 m/s, orthogonal to all affine fields.
Vec3 wave(const Vec3& p) { return {std::cos(4 * pi * p.x()), 0, 0}; }

} // namespace

TEST_CASE("full inertial damping takes a drift at once, while a wave travels on", "[dynamics]") {
    for (const Integrator scheme : dynamic) {
        INFO(static_cast<int>(scheme));
        Bar damped(scheme, 1), free(scheme, 0);
        for (Bar* bar : {&damped, &free}) {
            bar->set_velocity([](const Vec3& p) { return Vec3(0.05 * wave(p) + Vec3(0.3, 0.2, -0.1)); });
            bar->run(60); // half a period
        }
        const auto along = [](const Vec3&) { return Vec3(1, 0, 0); };
        CHECK(free.part(along) == Approx(0.3).epsilon(1e-6));
        CHECK(std::abs(damped.part(along)) < 1e-7);
        CHECK(std::abs(damped.part([](const Vec3&) { return Vec3(0, 1, 0); })) < 1e-7);
        // cos(pi) = -1; backward Euler loses exp(-h w^2 t / 2) = 0.92 of it.
        const double left =
            scheme == Integrator::backward_euler ? std::exp(-0.5 * damped.in.step_size * std::pow(40 * pi, 2) / 40) : 1;
        CHECK(damped.part(wave) == Approx(-0.05 * left).epsilon(0.02));
        CHECK(damped.part(wave) == Approx(free.part(wave)).epsilon(1e-3));
    }
}

TEST_CASE("all twelve affine motions lose their momentum, nothing else does", "[dynamics]") {
    for (const ElementKind kind : kinds) {
        Bar bar(Integrator::backward_euler, 1, kind);
        bar.in.step_size = 1e-5; // forces have no time to answer
        bar.in.gravity = Vec3(0, -9.8, 0);
        Mat3 rate;
        rate << 0.3, -2, 0.5, 1, 0.2, -0.7, 0.4, 0.9, -0.6;
        bar.set_velocity([&](const Vec3& p) { return Vec3(rate * p + Vec3(1, 2, 3)); });
        bar.run(1);
        double most = 0;
        for (std::size_t i = 0; i < bar.state.v.size(); ++i)
            most = std::max(most, std::abs(bar.state.v[i] + (i % 3 == 1 ? 9.8e-5 : 0)));
        CHECK(most < 1e-9); // of 3
        bar.start();
        const auto bend = [](const Vec3& p) { return Vec3(0, std::cos(4 * pi * p.x()), 0); };
        bar.set_velocity(bend);
        bar.run(1);
        CHECK(bar.part(bend) == Approx(1).epsilon(1e-3));
    }
}

TEST_CASE("the share that inertial damping takes hangs on time, not on steps", "[dynamics]") {
    for (const Integrator scheme : dynamic)
        for (const int steps : {1, 4, 9}) {
            Bar bar(scheme, 0.75);
            bar.in.step_size = affine_damping_time / steps;
            bar.set_velocity([](const Vec3&) { return Vec3(2, 0, 0); });
            bar.run(steps);
            INFO(steps);
            CHECK(bar.part([](const Vec3&) { return Vec3(1, 0, 0); }) == Approx(2 * 0.25).epsilon(1e-9));
        }
}

TEST_CASE("a body in one plane and one of a single tet lose momentum without a singular matrix", "[dynamics]") {
    Trial flat(box_mesh({1, 0.5, 0.5}, 2, 1, 1), ElasticLaw::stvk, ElementKind::linear, nowhere, material(1e3, 0.3));
    flat.use_backward_euler(1e-6);
    flat.values().inertial_damping = 1;
    flat.start();
    flat.place(everywhere, [](const Vec3& p) { return Vec3(p.x(), p.y(), 0); });
    for (std::size_t i = 0; i < flat.state.v.size(); i += 3) flat.state.v[i] = 3, flat.state.v[i + 2] = 1;
    flat.state = advance(*flat.workspace, flat.state, std::span(&flat.in, 1));
    for (const double v : flat.state.v) CHECK(std::abs(v) < 0.05);
}

TEST_CASE("inertial damping outside of 0 to 1 is refused", "[dynamics]") {
    for (const double wrong : {-0.1, 1.1, std::nan("")}) {
        Bar bar(Integrator::backward_euler, 0);
        bar.values().inertial_damping = wrong;
        try {
            bar.run(1);
            FAIL("taken");
        } catch (const Error& e) {
            CHECK(e.code == "FE304");
            CHECK(e.body == 0);
        }
    }
}

TEST_CASE("a frozen body stands where it is to the bit, and goes on from rest", "[dynamics]") {
    for (const Integrator scheme : dynamic)
        for (const ElementKind kind : kinds) {
            INFO(static_cast<int>(scheme));
            Bar bar(scheme, 0.5, kind);
            bar.in.step_size = 1.0 / 24;
            bar.in.gravity = Vec3(0, -9.8, 0);
            bar.run(3);
            const std::vector<double> there = bar.state.x;
            bar.values().enable = 0;
            bar.run(2);
            CHECK(bar.state.x == there);
            CHECK(bar.state.v == std::vector<double>(there.size(), 0.0));
            CHECK(bar.state.record.residual == 0);
            bar.values().enable = 1;
            bar.run(1);
            // From rest: g h^2 by backward Euler, so by BDF2, which has no past to go on from, and half by TR-BDF2.
            const double share = scheme == Integrator::tr_bdf2 ? 0.5 : 1;
            for (std::size_t v = 0; v < there.size(); v += 3)
                CHECK(bar.state.x[v + 1] - there[v + 1] == Approx(-share * 9.8 / 576).epsilon(1e-5));
        }
}

TEST_CASE("a frozen body without any hold has its place in a quasi-static step", "[dynamics]") {
    Trial two(box_mesh({1, 0.25, 0.25}, 4, 1, 1), ElasticLaw::neo_hookean, ElementKind::linear, at_root,
              material(1e4, 0.3));
    two.description.bodies.push_back(tissue(box_mesh({1, 0.25, 0.25}, 4, 1, 1), ElasticLaw::neo_hookean));
    two.in.bodies.push_back(material(1e4, 0.3));
    std::get<TissueInputs>(two.in.bodies[1]).enable = 0;
    two.in.gravity = Vec3(0, -1, 0);
    two.start();
    const std::vector<double> before = two.state.x;
    CHECK(two.step());
    const std::size_t first = 3 * two.scene->first_vertex(1);
    CHECK(std::equal(before.begin() + static_cast<std::ptrdiff_t>(first), before.end(),
                     two.state.x.begin() + static_cast<std::ptrdiff_t>(first)));
    CHECK(two.state.x[first - 2] < before[first - 2] - 1e-3); // the other body's tip has sunk
}

namespace {

/// A sheet of 1 m x 0.25 m, free in space, whose waves along the warp run at 10 m/s: sqrt(tensileStiffness / mass).
struct FreeSheet {
    Sheet sheet = make_sheet(evenly(0, 1, 32), 0.25, 4, Weave::diagonal);
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    StepInputs in;
    State state;
    FreeSheet(Integrator scheme, double damping, double step_size) {
        scene = std::make_shared<const Scene>(SceneDescription{{cloth(sheet.points, sheet.triangles)}, {}});
        in.gravity = Vec3::Zero();
        in.integrator = scheme, in.step_size = step_size;
        in.max_newton_iterations = 40, in.tolerance_factor = 1e-4;
        ClothInputs values = cloth_material(50, 20, 1e-4, 0.5);
        values.inertial_damping = damping;
        in.bodies = {values};
        state = initial_state(*scene, in);
        workspace = std::make_unique<Workspace>(scene);
    }
    ClothInputs& values() { return std::get<ClothInputs>(in.bodies[0]); }
    void run(int steps) {
        for (int k = 0; k < steps; ++k) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
    }
    /// Share of a velocity field in the velocities, by masses of a third of each face.
    double part(const std::function<Vec3(const Vec3&)>& field) const {
        double both = 0, own = 0;
        for (const Triangle& t : sheet.triangles)
            for (const int v : t) {
                const auto i = static_cast<std::size_t>(v);
                const Vec3 u = field(sheet.points[i]), w(state.v[3 * i], state.v[3 * i + 1], state.v[3 * i + 2]);
                both += u.dot(w), own += u.squaredNorm();
            }
        return both / own;
    }
    void set_velocity(const std::function<Vec3(const Vec3&)>& of) {
        for (std::size_t v = 0; v < sheet.points.size(); ++v) {
            const Vec3 u = of(sheet.points[v]);
            std::copy_n(u.data(), 3, state.v.begin() + static_cast<std::ptrdiff_t>(3 * v));
        }
    }
};

} // namespace

TEST_CASE("inertial damping of cloth takes a drift at once, while a wave travels on", "[dynamics][cloth]") {
    for (const Integrator scheme : dynamic) {
        INFO(static_cast<int>(scheme));
        FreeSheet free(scheme, 1, 1.0 / 2400);
        const Vec3 drift(0.3, -0.2, 0.1);
        // A wave of 20 Hz, small beside the sheet, and the drift with it.
        free.set_velocity([&](const Vec3& p) -> Vec3 { return drift + 0.01 * wave(p); });
        free.run(1);
        CHECK(std::abs(free.part([&](const Vec3&) { return drift; })) < 1e-4);
        free.run(29); // a quarter of its period: the wave stands at its turning point
        CHECK(std::abs(free.part(wave)) < 0.002);
        free.run(30); // and half of it: it runs the other way
        CHECK(free.part(wave) < (scheme == Integrator::backward_euler ? -0.0075 : -0.0095));
    }
}

TEST_CASE("inertial damping of cloth takes its share by time, however many steps that are", "[dynamics][cloth]") {
    for (const int steps : {1, 4, 10}) {
        INFO(steps);
        FreeSheet free(Integrator::backward_euler, 0.6, 1.0 / 24 / steps);
        free.set_velocity([](const Vec3&) { return Vec3(0, 0, 1); });
        free.run(steps);
        CHECK(free.part([](const Vec3&) { return Vec3(0, 0, 1); }) == Approx(0.4).epsilon(1e-6));
    }
}

TEST_CASE("a frozen cloth stands where it is to the bit, and goes on from rest", "[dynamics][cloth]") {
    for (const Integrator scheme : dynamic) {
        INFO(static_cast<int>(scheme));
        FreeSheet free(scheme, 0.5, 1.0 / 24);
        free.in.gravity = Vec3(0, -9.8, 0);
        free.run(3);
        const std::vector<double> there = free.state.x;
        free.values().enable = 0;
        free.run(2);
        CHECK(free.state.x == there);
        CHECK(free.state.v == std::vector<double>(there.size(), 0.0));
        free.values().enable = 1;
        free.run(1);
        // BDF2 has no past to go on from, and begins as backward Euler.
        const double share = scheme == Integrator::tr_bdf2 ? 0.5 : 1;
        for (std::size_t v = 0; v < there.size(); v += 3)
            CHECK(free.state.x[v + 1] - there[v + 1] == Approx(-share * 9.8 / 576).epsilon(1e-5));
    }
}

TEST_CASE("inertial damping of cloth outside of 0 to 1 is refused", "[dynamics][cloth]") {
    for (const double damping : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
        FreeSheet free(Integrator::backward_euler, 0, 1.0 / 24);
        free.values().inertial_damping = damping;
        try {
            free.run(1);
            FAIL("taken");
        } catch (const Error& e) {
            CHECK(e.code == "FE304");
            CHECK(e.body == 0);
        }
    }
}
