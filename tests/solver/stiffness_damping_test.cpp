// Stiffness damping: Rayleigh's about rest for every scheme, none of it in rotations, second order where the scheme is.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/trial.h"

#include <Eigen/Geometry>
#include <random>

using namespace sinew::test;

namespace {

constexpr Integrator moving_schemes[] = {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2};

/// A body under any law; the anisotropic one about the x axis.
Trial trial(const TetMesh& mesh, ElasticLaw law, ElementKind kind, const Where& held, const TissueInputs& values) {
    Trial t(mesh, law, kind, held, values);
    if (needs_direction(law)) t.rest->stiff_directions.assign(mesh.tets.size(), Vec3(1, 0, 0));
    return t;
}

/// m x'' + c x' + k x = 0 by each scheme, written out: where x is after every step.
std::vector<double> exact_sequence(Integrator scheme, double m, double c, double k, double h, double x, double v,
                                   int steps) {
    // Solves y' = A y + r for y' = (x', v') - the implicit stage y' = r + reach f(y') with f(x, v) = (v, -(k x + c
    // v)/m).
    const auto implicit = [&](double reach, double rx, double rv, double& nx, double& nv) {
        nv = (rv - reach * k / m * rx) / (1 + reach * c / m + reach * reach * k / m);
        nx = rx + reach * nv;
    };
    std::vector<double> out;
    double last_x = x, last_v = v;
    for (int i = 0; i < steps; ++i) {
        double nx = 0, nv = 0;
        if (scheme == Integrator::backward_euler || (scheme == Integrator::bdf2 && i == 0)) {
            implicit(h, x, v, nx, nv);
        } else if (scheme == Integrator::bdf2) {
            implicit(2 * h / 3, (4 * x - last_x) / 3, (4 * v - last_v) / 3, nx, nv);
        } else {
            const double g = 2 - std::sqrt(2.0), half = 0.5 * g * h, w = 1 / (g * (2 - g)), u = (1 - g) * (1 - g) * w;
            double gx = 0, gv = 0;
            implicit(half, x + half * v, v - half * (k * x + c * v) / m, gx, gv);
            implicit(half, w * gx - u * x, w * gv - u * v, nx, nv);
        }
        last_x = x, last_v = v;
        x = nx, v = nv;
        out.push_back(x);
    }
    return out;
}

} // namespace

TEST_CASE("stiffness damping of small motions is Rayleigh's, step by step, for every law and scheme") {
    const TetMesh mesh = regular_tet(0.1);
    const double e = 2e4, nu = 0.3, density = 1000, h = 1.0 / 200, beta = 4e-3;
    const double mu = e / (2 * (1 + nu)), lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
    // A vertex of a regular tet: the gradient of its barycentric coordinate points at it, 1 / height long.
    const Vec3 up = (mesh.vertices[3] - (mesh.vertices[0] + mesh.vertices[1] + mesh.vertices[2]) / 3).normalized();
    const Vec3 across = (mesh.vertices[1] - mesh.vertices[0]).normalized();
    const double height = 0.1 * std::sqrt(2.0 / 3), volume = std::pow(0.1, 3) / (6 * std::sqrt(2.0));
    const double amplitude = 1e-6;
    for (const ElasticLaw law : all_laws)
        for (const Integrator scheme : moving_schemes)
            for (const bool along : {true, false}) {
                INFO("law " << static_cast<int>(law) << " scheme " << static_cast<int>(scheme) << " along " << along);
                Trial t = trial(mesh, law, ElementKind::linear, nowhere, material(e, nu, density));
                t.rest->fixed_vertices = {0, 1, 2};
                t.in.integrator = scheme;
                t.in.step_size = h;
                t.in.stiffness_damping = beta;
                t.in.tolerance_factor = 1e-2;
                t.start();
                const Vec3 direction = along ? up : across;
                set_position(t.state, 3, mesh.vertices[3] + amplitude * direction);
                const double k = volume / (height * height) * (along ? 2 * mu + lambda : mu), m = density * volume / 4;
                const std::vector<double> expected = exact_sequence(scheme, m, beta * k, k, h, amplitude, 0, 12);
                for (const double x : expected) {
                    t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
                    CHECK(t.state.record.converged);
                    CHECK((position(t.state, 3) - mesh.vertices[3]).dot(direction) ==
                          Approx(x).margin(1e-4 * amplitude));
                }
            }
}

TEST_CASE("stiffness damping does not slow the fall of a stiff pendulum") {
    // A rod that hangs on one vertex turns by some degrees a frame; strains stay below 1e-4. Damping by a matrix
    // that does not turn with it would hold it back.
    const TetMesh mesh = box_mesh({1, 0.05, 0.05}, 8, 1, 1);
    for (const ElementKind kind : kinds)
        for (const ElasticLaw law : all_laws)
            for (const Integrator scheme : moving_schemes) {
                INFO("quadratic " << (kind == ElementKind::quadratic) << " law " << static_cast<int>(law) << " scheme "
                                  << static_cast<int>(scheme));
                Vec3 tip[2];
                for (const bool damped : {false, true}) {
                    Trial t = trial(mesh, law, kind, nowhere, material(1e9, 0.3));
                    t.rest->fixed_vertices = {0};
                    t.in.integrator = scheme;
                    t.in.gravity = Vec3(0, -9.8, 0);
                    t.in.step_size = 1.0 / 24;
                    t.in.stiffness_damping = damped ? 1e-3 : 0;
                    t.in.tolerance_factor = 1;
                    t.start();
                    for (int frame = 0; frame < 10; ++frame) {
                        t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
                        CHECK(t.state.record.converged);
                    }
                    tip[damped] = position(
                        t.state, vertices_where(mesh.vertices, [](const Vec3& p) { return p.x() > 1 - 1e-9; })[0]);
                }
                CHECK(tip[0].y() < -0.5);
                CHECK((tip[1] - tip[0]).norm() < 0.02);
            }
}

TEST_CASE("with stiffness damping each scheme keeps its order on a bar that swings far") {
    const TetMesh mesh = box_mesh({0.4, 0.1, 0.1}, 4, 1, 1);
    for (const auto& [scheme, order] :
         {std::pair{Integrator::backward_euler, 1.0}, {Integrator::bdf2, 2.0}, {Integrator::tr_bdf2, 2.0}}) {
        std::vector<Vec3> tips;
        for (const int steps : {64, 128, 256}) {
            Trial t(mesh, ElasticLaw::neo_hookean, ElementKind::linear, at_root, material(2e4, 0.3));
            t.in.integrator = scheme;
            t.in.gravity = Vec3(0, -9.8, 0);
            t.in.step_size = 0.2 / steps;
            t.in.stiffness_damping = 0.01;
            t.in.tolerance_factor = 1e-5;
            t.start();
            for (int i = 0; i < steps; ++i) t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
            tips.push_back(position(t.state, static_cast<int>(mesh.vertices.size()) - 1));
        }
        CHECK((tips[2] - mesh.vertices.back()).norm() > 0.1);
        INFO("scheme " << static_cast<int>(scheme));
        CHECK(std::log2((tips[0] - tips[1]).norm() / (tips[1] - tips[2]).norm()) == Approx(order).margin(0.15));
    }
}

TEST_CASE("the damping's gradient and Hessian converge to finite differences at second order, and project to no "
          "negative curvature") {
    const TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, 2, 1, 1);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (const ElementKind kind : kinds)
        for (const ElasticLaw law : all_laws)
            for (const Integrator scheme : moving_schemes) {
                INFO("quadratic " << (kind == ElementKind::quadratic) << " law " << static_cast<int>(law) << " scheme "
                                  << static_cast<int>(scheme));
                TissueInputs values = material(1e4, 0.4);
                values.transverse_anisotropy = 0.5;
                Trial t = trial(mesh, law, kind, at_root, values);
                t.in.integrator = scheme;
                t.in.step_size = 0.01;
                t.in.stiffness_damping = 0.05; // five times the elastic part
                t.start();
                State& s = t.state;
                const auto shaken = [&](double by) {
                    std::vector<double> x = t.scene->numbering().rest;
                    for (double& c : x) c += by * normal(random);
                    return x;
                };
                s.x = shaken(0.004), s.history.x = shaken(0.004), s.history.v = s.v = shaken(0.1);
                s.history.step_size = t.in.step_size;
                const std::vector<double> between = shaken(0.004);
                ImplicitForm form;
                if (scheme == Integrator::backward_euler) backward_euler_form(s, t.in.step_size, form);
                if (scheme == Integrator::bdf2) bdf2_form(s, t.in.step_size, form);
                if (scheme == Integrator::tr_bdf2) tr_bdf2_bdf2_form(s, between, s.v, t.in.step_size, nullptr, form);
                Potential p(*t.scene);
                p.take(s, t.in);
                p.begin_step(s, t.in);
                p.begin_stage(s, form, s.bones);
                const std::vector<double> x = shaken(0.004), direction = [&] {
                    std::vector<double> d(x.size());
                    for (const int v : p.numbering().vertex_of_unknown)
                        for (std::size_t c = 0; c < 3; ++c)
                            d[3 * static_cast<std::size_t>(v) + c] = 0.0005 * normal(random);
                    return d;
                }();
                const auto at = [&](double by) {
                    std::vector<double> y = x;
                    for (std::size_t i = 0; i < y.size(); ++i) y[i] += by * direction[i];
                    return y;
                };
                std::vector<double> g, plus, minus, unknown(3 * p.unknown_count()), hd(3 * p.unknown_count());
                for (std::size_t u = 0; u < p.unknown_count(); ++u)
                    for (std::size_t c = 0; c < 3; ++c)
                        unknown[3 * u + c] =
                            direction[3 * static_cast<std::size_t>(p.numbering().vertex_of_unknown[u]) + c];
                p.evaluate(x, &g, nullptr);
                BlockMatrix h(p.pattern());
                p.assemble(x, false, h);
                multiply(h, unknown.data(), hd.data());
                double slope = 0, gradient_error[2], hessian_error[2];
                for (std::size_t i = 0; i < g.size(); ++i) slope += g[i] * unknown[i];
                for (int i = 0; i < 2; ++i) {
                    const double by = i ? 0.5 : 1;
                    const double high = p.evaluate(at(by), &plus, nullptr), low = p.evaluate(at(-by), &minus, nullptr);
                    gradient_error[i] = std::abs((high - low) / (2 * by) - slope);
                    hessian_error[i] = 0;
                    for (std::size_t k = 0; k < g.size(); ++k)
                        hessian_error[i] += std::pow((plus[k] - minus[k]) / (2 * by) - hd[k], 2);
                }
                CHECK(std::log2(gradient_error[0] / gradient_error[1]) == Approx(2).margin(0.2));
                CHECK(std::log2(hessian_error[0] / hessian_error[1]) / 2 == Approx(2).margin(0.2));
                p.assemble(x, true, h);
                for (int k = 0; k < 20; ++k) {
                    for (double& u : unknown) u = normal(random);
                    multiply(h, unknown.data(), hd.data());
                    double curvature = 0;
                    for (std::size_t i = 0; i < hd.size(); ++i) curvature += unknown[i] * hd[i];
                    CHECK(curvature > 0);
                }
            }
}
