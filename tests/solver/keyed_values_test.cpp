// Values that change over time: every scheme must see them where it looks, or it loses its order.
// SPDX-License-Identifier: GPL-3.0-or-later
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
