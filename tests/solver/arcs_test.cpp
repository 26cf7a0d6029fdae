// Moves on which stiff bodies turn instead of stretching.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/arcs.h"
#include "tests/support/trial.h"

#include <Eigen/Geometry>

using namespace sinew::test;

namespace {

/// A potential of one free box in backward Euler, and the rate w x (x - c) + s of all its vertices.
struct Turning {
    TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 1, 1);
    Vec3 axis = Vec3(1, 2, -1).normalized(), shift{0.01, 0.02, -0.03};
    Trial t{mesh, ElasticLaw::stvk, ElementKind::linear, nowhere, material(1e6, 0.3)};
    ImplicitForm form;
    std::unique_ptr<Potential> potential;
    std::vector<double> direction;
    Turning(double angle) {
        t.use_backward_euler(1.0 / 24);
        t.start();
        potential = std::make_unique<Potential>(*t.scene);
        potential->take(t.state, t.in);
        potential->begin_step(t.state, t.in);
        backward_euler_form(t.state, t.in.step_size, form);
        potential->begin_stage(t.state, form, t.state.bones);
        for (const int v : potential->numbering().vertex_of_unknown) {
            const Vec3 d = angle * axis.cross(place(v) - centre()) + shift;
            for (int c = 0; c < 3; ++c) direction.push_back(d[c]);
        }
    }
    Vec3 place(int v) const { return mesh.vertices[static_cast<std::size_t>(v)]; }
    /// Of the vertices weighted by the tets about them.
    Vec3 centre() const {
        Vec3 sum = Vec3::Zero();
        double total = 0;
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
            const double w = potential->vertex_stiffness()[v];
            sum += w * mesh.vertices[v], total += w;
        }
        return sum / total;
    }
};

} // namespace

TEST_CASE("a rigid direction moves a body rigidly by any angle, and straight where stretch costs nothing") {
    for (const double angle : {0.01, 0.7, 2.5})
        for (const bool dear : {true, false}) {
            const Turning turning(angle);
            Arcs arcs;
            const std::vector<double>& x = turning.t.state.x;
            arcs.fit(*turning.potential, x, turning.direction, {dear ? 1e-12 : 1e12});
            for (const double share : {1.0, 0.25}) {
                std::vector<double> out;
                arcs.move(*turning.potential, x, turning.direction, share, out);
                const Mat3 turn = Eigen::AngleAxisd(share * angle, turning.axis).toRotationMatrix();
                for (int v = 0; v < static_cast<int>(turning.mesh.vertices.size()); ++v) {
                    const Vec3 p = turning.place(v), r = p - turning.centre();
                    const Vec3 expected = dear ? Vec3(turning.centre() + turn * r + share * turning.shift)
                                               : Vec3(p + share * (angle * turning.axis.cross(r) + turning.shift));
                    const Vec3 got(out[3 * static_cast<std::size_t>(v)], out[3 * static_cast<std::size_t>(v) + 1],
                                   out[3 * static_cast<std::size_t>(v) + 2]);
                    CHECK((got - expected).norm() < 1e-14);
                }
            }
        }
}

TEST_CASE("a stiff body that spins fast is not strained by its own damping, however strong that is") {
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 1, 1);
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : mesh.vertices) centre += p / static_cast<double>(mesh.vertices.size());
    for (const ElementKind kind : kinds)
        for (const Integrator scheme : {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2}) {
            Trial t(mesh, ElasticLaw::stvk, kind, nowhere, material(1e9, 0.3));
            t.in.integrator = scheme;
            t.in.step_size = 1.0 / 24;
            t.in.stiffness_damping = 1; // 24 steps
            t.in.tolerance_factor = 1;
            t.start();
            double energy = 0;
            for (std::size_t v = 0; v < t.nodes.size(); ++v) {
                const Vec3 speed = Vec3(0, 0, 10).cross(t.nodes[v] - centre);
                for (int c = 0; c < 3; ++c) t.state.v[3 * v + static_cast<std::size_t>(c)] = speed[c];
                energy += 0.5 * speed.squaredNorm() * 3.0 / static_cast<double>(t.nodes.size()); // 3 kg
            }
            for (int step = 0; step < 12; ++step) {
                t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
                INFO("quadratic " << (kind == ElementKind::quadratic) << " scheme " << static_cast<int>(scheme)
                                  << ", step " << step << ", moving with about " << energy << " J");
                CHECK(t.state.record.converged);
                if (step > 2) CHECK(t.state.record.energy < 1e-4 * energy);
            }
        }
}

TEST_CASE("a free stiff body that spins fast takes few Newton iterations and keeps its shape and spin") {
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 1, 1);
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : mesh.vertices) centre += p / static_cast<double>(mesh.vertices.size());
    for (const double modulus : {1e6, 1e9, 1e11}) {
        Trial t(mesh, ElasticLaw::stvk, ElementKind::linear, nowhere, material(modulus, 0.3));
        t.in.integrator = Integrator::tr_bdf2;
        t.in.step_size = 1.0 / 24;
        t.in.stiffness_damping = 1e-3;
        t.in.tolerance_factor = 1;
        t.start();
        // 10 rad/s about z: 24 degrees a step.
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
            const Vec3 speed = Vec3(0, 0, 10).cross(mesh.vertices[v] - centre);
            for (int c = 0; c < 3; ++c) t.state.v[3 * v + static_cast<std::size_t>(c)] = speed[c];
        }
        double turned = 0;
        Vec3 before = mesh.vertices.back() - mesh.vertices.front();
        const double length = before.norm();
        for (int step = 0; step < 12; ++step) {
            t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
            INFO("E " << modulus << ", " << t.state.record.newton_iterations << " iterations");
            CHECK(t.state.record.converged);
            CHECK(t.state.record.newton_iterations <= 16); // of two stages
            const Vec3 now = position(t.state, static_cast<int>(mesh.vertices.size()) - 1) - position(t.state, 0);
            CHECK(now.norm() == Approx(length).epsilon(modulus < 1e8 ? 1e-2 : 1e-4));
            turned +=
                std::atan2(before.head<2>().x() * now.y() - before.y() * now.x(), before.head<2>().dot(now.head<2>()));
            before = now;
        }
        CHECK(turned ==
              Approx(5.0).epsilon(0.06)); // 12 steps of 10/24 rad; the scheme's own phase error is 4.6 % of that
    }
}
