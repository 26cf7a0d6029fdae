// Values that change over time: every scheme must see them where it looks, or it loses its order.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/integrate/implicit_form.h"
#include "tests/support/trial.h"

using namespace sinew::test;

namespace {

struct Scheme {
    Integrator integrator;
    double order;
};
constexpr Scheme schemes[] = {{Integrator::backward_euler, 1}, {Integrator::bdf2, 2}, {Integrator::tr_bdf2, 2}};

} // namespace

TEST_CASE("under gravity that changes, every scheme falls to the exact place at its order") {
    const double g = 9.8, omega = 7, end = 0.5;
    for (const auto& [integrator, order] : schemes) {
        double error[2];
        for (const int fine : {0, 1}) {
            const int steps = fine ? 160 : 80;
            Trial t(regular_tet(0.1), ElasticLaw::neo_hookean, ElementKind::linear, nowhere, material(1e5, 0.3));
            t.in.integrator = integrator;
            t.in.step_size = end / steps;
            t.start();
            const double start = position(t.state, 0).z();
            for (int i = 1; i <= steps; ++i) {
                t.in.gravity = Vec3(0, 0, -g * std::cos(omega * i * t.in.step_size));
                t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
            }
            error[fine] =
                std::abs(position(t.state, 0).z() - start + g / (omega * omega) * (1 - std::cos(omega * end)));
        }
        INFO("scheme " << static_cast<int>(integrator) << ", errors " << error[0] << " " << error[1]);
        CHECK(std::log2(error[0] / error[1]) == Approx(order).margin(0.15));
    }
}

TEST_CASE("a muscle whose excitation, stiffness and loads are keyed swings at each scheme's order") {
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 1, 1);
    for (const auto& [integrator, order] : schemes) {
        std::vector<Vec3> tips;
        for (const int steps : {50, 100, 200}) {
            TissueInputs values = material(2e4, 0.3);
            values.fibers = {{2e4, 0.5, 0, 1}};
            Trial t(mesh, ElasticLaw::neo_hookean, ElementKind::linear, at_root, values);
            FiberRest fiber;
            fiber.directions.assign(mesh.tets.size(), Vec3(0.8, 0, 0.6));
            fiber.weights.assign(mesh.tets.size(), 1.0);
            t.rest->fibers = {fiber};
            t.in.integrator = integrator;
            t.in.step_size = 0.2 / steps;
            t.in.tolerance_factor = 1e-3;
            t.start();
            for (int i = 1; i <= steps; ++i) {
                const double time = i * t.in.step_size;
                t.values().fibers[0].excitation = std::sin(20 * time);
                t.values().layers[0].youngs_modulus = 2e4 * (1 + 0.5 * std::sin(30 * time));
                t.values().forces.assign(t.nodes.size(), Vec3(0, 0.02 * std::sin(25 * time), 0));
                t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
                REQUIRE(t.state.record.converged);
                if (i == steps / 2) { // what lies between frames is all in the state
                    State copy = load(save(t.state));
                    CHECK(save(copy) == save(t.state));
                    t.state = std::move(copy);
                    t.workspace = std::make_unique<Workspace>(t.scene);
                }
            }
            tips.push_back(position(t.state, static_cast<int>(mesh.vertices.size()) - 1));
        }
        CHECK((tips[2] - mesh.vertices.back()).norm() > 0.01);
        INFO("scheme " << static_cast<int>(integrator));
        CHECK(std::log2((tips[0] - tips[1]).norm() / (tips[1] - tips[2]).norm()) == Approx(order).margin(0.2));
    }
}

TEST_CASE("a body that a turning bone lets go flies on the way it was going, under every scheme") {
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 1, 1);
    for (const auto& [integrator, order] : schemes) {
        Trial t(mesh, ElasticLaw::stvk, ElementKind::linear, nowhere, material(1e9, 0.3));
        t.add_bone({{0, -1, -1}, {0, 2, -1}, {0, 0, 2}});
        t.attach_root(0, 1, 1e8);
        t.in.integrator = integrator;
        t.in.step_size = 1.0 / 24;
        t.in.tolerance_factor = 1;
        t.start();
        double speed = 0;
        for (int step = 1; step <= 16; ++step) {
            // 1.2 m/s along y, then the bone stands and lets go.
            for (Vec3& p : std::get<BoneInputs>(t.in.bodies[1]).positions)
                if (step <= 10) p.y() += 0.05;
            if (step == 11) t.in.attachments[0].envelope = 0;
            const double before = position(t.state, 0).y();
            t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
            speed = (position(t.state, 0).y() - before) / t.in.step_size;
        }
        INFO("scheme " << static_cast<int>(integrator));
        CHECK(speed == Approx(1.2).epsilon(0.2));
    }
}

namespace {

/// A beam that is next to rigid on a bone that swings about z, in gravity that swings too.
struct Swinging {
    ElementKind kind = ElementKind::linear;
    ElasticLaw law = ElasticLaw::stvk;
    bool known = true;            ///< what is at gamma of each step is told
    int most_iterations = 200;    ///< of Newton's; few make steps be halved
    int halvings = 0;             ///< that there were
    double stray = 0, chased = 0; ///< at the end: greatest distance [m], or difference in speed [m/s], from the bone's

    static constexpr double swing = 0.6, omega = 12;
    static double angle(double t) { return swing * std::sin(omega * t); }
    static Mat3 turn(double t) { return Eigen::AngleAxisd(angle(t), Vec3(0, 0, 1)).toRotationMatrix(); }

    Swinging& run(int steps, double end = 0.5) {
        const Points corners = {{0, -0.1, -0.1}, {0, 0.2, -0.1}, {0, 0, 0.2}};
        Trial t(box_mesh({0.3, 0.1, 0.1}, 3, 1, 1), law, kind, nowhere, material(1e8, 0.3));
        t.add_bone(corners);
        t.attach_root(0, 1, 1e10);
        t.in.attachments[0].damping = 1e4;
        t.in.integrator = Integrator::tr_bdf2;
        t.in.step_size = end / steps;
        t.in.tolerance_factor = 1e-2;
        t.in.max_newton_iterations = most_iterations;
        t.in.max_halvings = most_iterations < 200 ? 3 : 0;
        t.start();
        const auto set = [&](StepInputs& in, double time) {
            Points& positions = std::get<BoneInputs>(in.bodies[1]).positions;
            for (std::size_t i = 0; i < corners.size(); ++i) positions[i] = turn(time) * corners[i];
            in.gravity = Vec3(9.8 * std::sin(15 * time), -9.8 * std::cos(9 * time), 0);
        };
        for (std::size_t v = 0; v < t.nodes.size(); ++v) { // it swings already
            const Vec3 speed = Vec3(0, 0, swing * omega).cross(t.nodes[v]);
            for (std::size_t c = 0; c < 3; ++c) t.state.v[3 * v + c] = speed[static_cast<Eigen::Index>(c)];
        }
        for (int i = 1; i <= steps; ++i) {
            StepInputs now = t.in;
            set(now, i * t.in.step_size);
            if (known) {
                StepInputs within = t.in;
                set(within, (i - 1 + tr_bdf2_gamma) * t.in.step_size);
                now.at_gamma = std::make_shared<const StepInputs>(std::move(within));
            }
            t.state = advance(*t.workspace, t.state, std::span(&now, 1));
            halvings += t.state.record.halvings;
            REQUIRE(t.state.record.converged);
        }
        for (std::size_t v = 0; v < t.nodes.size(); ++v) {
            const Vec3 there = turn(end) * t.nodes[v];
            const Vec3 speed = Vec3(0, 0, swing * omega * std::cos(omega * end)).cross(there);
            stray = std::max(stray, (position(t.state, static_cast<int>(v)) - there).norm());
            chased =
                std::max(chased, (Vec3(t.state.v[3 * v], t.state.v[3 * v + 1], t.state.v[3 * v + 2]) - speed).norm());
        }
        return *this;
    }
};

} // namespace

TEST_CASE("a beam on a fast bone that is known at gamma of each step moves as fast as it, to second order") {
    for (const ElementKind kind : kinds)
        for (const ElasticLaw law : laws) {
            const auto run = [&](bool known, int steps) {
                Swinging s{kind, law, known};
                return s.run(steps);
            };
            const Swinging coarse = run(true, 24), fine = run(true, 48), guessed = run(false, 24);
            INFO("element " << int(kind) << ", law " << int(law) << ": " << coarse.stray << " m, " << coarse.chased
                            << " m/s, finer " << fine.stray << " m, " << fine.chased << " m/s, guessed "
                            << guessed.stray << " m, " << guessed.chased << " m/s");
            CHECK(coarse.stray < 2e-5); // of 30 cm
            CHECK(coarse.chased < 0.65 * guessed.chased);
            CHECK(coarse.stray < 0.25 * guessed.stray);
            CHECK(coarse.chased < 0.02); // of 2 m/s
            CHECK(std::log2(coarse.chased / fine.chased) > 1.6);
        }
}

TEST_CASE("where steps are halved, what is known at gamma of the whole still counts") {
    const auto run = [](bool known) {
        Swinging s{ElementKind::linear, ElasticLaw::stvk, known, 3};
        return s.run(12);
    };
    const Swinging told = run(true), guessed = run(false);
    INFO(told.chased << " m/s, guessed " << guessed.chased << " m/s");
    CHECK(told.halvings > 5);
    CHECK(guessed.halvings > 5);
    CHECK(told.stray < 2e-5);
    CHECK(told.chased < 0.5 * guessed.chased);
}

TEST_CASE("what is told for gamma is what acts there: a force that is on there alone") {
    // Over one step from rest TR-BDF2 gives a free body the speed h (w1 a(0) + w2 a(gamma) + w3 a(1)), w = (1/(2g),
    // ...): with a(0) = a(1) = 0 the middle weight alone.
    const double h = 0.01, g = tr_bdf2_gamma, push = 3;
    for (const bool by_gravity : {false, true}) {
        Trial t(regular_tet(0.1), ElasticLaw::neo_hookean, ElementKind::linear, nowhere, material(1e5, 0.3));
        t.in.integrator = Integrator::tr_bdf2;
        t.in.step_size = h;
        t.start();
        t.in.mass_damping = 0;
        const double mass = 1000 * std::pow(0.1, 3) / (6 * std::sqrt(2.0));
        StepInputs within = t.in;
        if (by_gravity)
            within.gravity = Vec3(0, 0, push / mass);
        else
            std::get<TissueInputs>(within.bodies[0]).forces.assign(4, Vec3(0, 0, push / 4));
        t.in.at_gamma = std::make_shared<const StepInputs>(within);
        const State after = advance(*t.workspace, t.state, std::span(&t.in, 1));
        // Stage 1: v = (g h / 2) a; stage 2 without force: v' = c1 v - c2 v0.
        const double speed = 0.5 * g * h * push / mass / (g * (2 - g));
        for (std::size_t v = 0; v < 4; ++v) CHECK(after.v[3 * v + 2] == Approx(speed).epsilon(1e-9));
        CHECK(after.history.values.has_value());
        CHECK(after.history.values->gravity == t.in.gravity); // the next step starts from the end of this one
    }
}

TEST_CASE("volume conservation that comes or goes between gamma and the end of a step does not stop it") {
    for (const ElementKind kind : kinds)
        for (const double end : {0.0, 1e6}) {
            Trial t(box_mesh({0.3, 0.1, 0.1}, 3, 1, 1), ElasticLaw::stvk, kind, at_root, material(1e5, 0.3));
            t.in.integrator = Integrator::tr_bdf2;
            t.in.gravity = Vec3(0, 0, -9.8);
            t.start();
            StepInputs within = t.in;
            std::get<TissueInputs>(within.bodies[0]).layers[0].volume_conservation = 1e6 - end;
            t.in.at_gamma = std::make_shared<const StepInputs>(within);
            t.values().layers[0].volume_conservation = end;
            t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
            CHECK(t.state.record.converged);
        }
}

TEST_CASE("what is told for gamma is checked like the rest") {
    Trial t(box_mesh({0.3, 0.1, 0.1}, 3, 1, 1), ElasticLaw::stvk, ElementKind::linear, nowhere, material(1e5, 0.3));
    t.add_bone(root_plate());
    t.attach_root(0, 1, 1e8);
    t.in.integrator = Integrator::tr_bdf2;
    t.start();
    const auto code = [&](const std::function<void(StepInputs&)>& spoil) {
        StepInputs within = t.in, now = t.in;
        spoil(within);
        now.at_gamma = std::make_shared<const StepInputs>(within);
        try {
            (void)advance(*t.workspace, t.state, std::span(&now, 1));
        } catch (const Error& e) {
            return e.code;
        }
        return std::string();
    };
    CHECK(code([](StepInputs&) {}) == "");
    CHECK(code([](StepInputs& in) { std::get<BoneInputs>(in.bodies[1]).positions.pop_back(); }) == "FE211");
    CHECK(code([](StepInputs& in) { std::get<BoneInputs>(in.bodies[1]).positions[0].x() = NAN; }) == "FE202");
    CHECK(code([](StepInputs& in) { in.gravity.x() = NAN; }) == "FE304");
    CHECK(code([](StepInputs& in) { std::get<TissueInputs>(in.bodies[0]).layers[0].youngs_modulus = NAN; }) == "FE304");
}
