// Tissues through lattices that do not fit them: what is cut is integrated where it is solid.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/cut_tets.h"
#include "solver/error.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/tet_quadrature.h"
#include "solver/newton/potential.h"
#include "solver/system.h"
#include "tests/support/lattice_body.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

constexpr ElementKind kinds[] = {ElementKind::linear, ElementKind::quadratic};

/// The catalogue's bars, turned by 30 degrees about two axes against the lattice, with x = 0 held by springs.
struct Bar : LatticeBody {
    RotatedBox box;
    Bar(const RotatedBox& of, double tet_size, ElasticLaw law, ElementKind element, const TissueInputs& with,
        double stiffness)
        : LatticeBody(of.surface(1), of.surface(64), tet_size, law, element, with)
        , box(of) {
        hold([&](const Vec3& p) { return box.local(p).x() < 1e-9; }, stiffness);
        start();
    }
    Vec3 local(const Vec3& v) const { return box.turn.transpose() * v; }
    Vec3 tip() const {
        const Vec3 middle(box.size.x(), box.size.y() / 2, box.size.z() / 2);
        return local(mean_displacement([&](const Vec3& p) { return (box.local(p) - middle).norm() < 1e-9; }));
    }
};
RotatedBox askew(const Vec3& size) { return RotatedBox(size, 30, 30); }

/// Elongation of a bar that hangs in small gravity, over the exact one.
double elongation(double tet_size, ElementKind element) {
    const double length = 0.4, g = 0.01, modulus = 1e5;
    Bar bar(askew({length, 0.1, 0.1}), tet_size, ElasticLaw::corotational, element, material(modulus, 0), 1e9);
    bar.in.gravity = bar.box.turn * Vec3(g, 0, 0);
    bar.solve();
    CHECK(bar.state.record.inverted == 0);
    const auto mean_at = [&](double x) {
        return bar
            .local(bar.mean_displacement([&](const Vec3& p) { return std::abs(bar.box.local(p).x() - x) < 1e-9; }))
            .x();
    };
    return (mean_at(length) - mean_at(0)) / (1000 * g * length * length / (2 * modulus));
}

} // namespace

TEST_CASE("a whole tet's four points are the usual ones, and a cut one's are exact to degree 2 and inside", "[cut]") {
    const FourPoints whole = four_points(whole_moments(4).value.data());
    CHECK(whole.exact);
    for (std::size_t c = 0; c < 4; ++c) {
        int near = 0;
        for (const Barycentric& b : whole.point) {
            near += b[c] > 0.5;
            CHECK(b[c] == Approx(usual_coordinate(b[c] > 0.5)).epsilon(1e-9));
        }
        CHECK(near == 1);
    }
    // Wedges, corners and prisms of a tet: all that planes cut off is convex.
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    std::exponential_distribution<double> exponential;
    for (int trial = 0; trial < 500; ++trial) {
        Barycentric through{}, plane{};
        double sum = 0;
        for (double& b : through) sum += b = exponential(random);
        for (double& b : through) b /= sum;
        double value = 0;
        for (std::size_t c = 0; c < 4; ++c) plane[c] = normal(random), value += plane[c] * through[c];
        for (double& p : plane) p -= value;
        TetMoments part;
        const std::array<Barycentric, 4> corners{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
        add_positive_part(plane, corners, 1, part);
        if (part.volume() < 1e-7) continue;
        const FourPoints points = four_points(part.value.data());
        CHECK(points.exact);
        const MomentTensors exact(part.value.data());
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < 4; ++j) {
                double mean = 0;
                for (const Barycentric& b : points.point) mean += 0.25 * b[i] * b[j];
                CHECK(mean == Approx(exact.second[i][j] / exact.volume).epsilon(1e-9).margin(1e-12));
            }
        for (const Barycentric& b : points.point) {
            double above = 0;
            for (std::size_t c = 0; c < 4; ++c) above += plane[c] * b[c];
            CHECK(above > 0);
            CHECK(*std::min_element(b.begin(), b.end()) > 0);
        }
    }
}

TEST_CASE("tissues weigh what their solid does, and where it is", "[cut]") {
    const RotatedBox box = askew({0.3, 0.13, 0.1});
    const double weight = 1100 * box.size.prod();
    for (const ElementKind element : kinds)
        for (const double size : {0.15, 0.06}) {
            LatticeBody body(box.surface(1), box.surface(1), size, ElasticLaw::stvk, element, material(1e4, 0.3, 1100));
            body.start();
            Potential potential(*body.scene);
            ImplicitForm form;
            quasi_static_form(body.state, form);
            body.in.gravity = Vec3(0, 0, -10);
            potential.take(body.state, body.in);
            potential.begin_step(body.state, body.in);
            potential.begin_stage(body.state, form, body.state.bones);
            std::vector<double> gradient;
            potential.evaluate(body.state.x, &gradient, nullptr);
            double force = 0;
            Vec3 moment = Vec3::Zero();
            for (std::size_t u = 0; u < gradient.size() / 3; ++u) {
                const double f = gradient[3 * u + 2] / 10;
                force += f, moment += f * position(body.state, body.scene->numbering().vertex_of_unknown[u]);
            }
            CHECK(force == Approx(weight).epsilon(1e-12));
            CHECK((moment / force - box.at(0.5 * box.size)).norm() < 1e-4 * box.size.x());
        }
}

TEST_CASE("a turned bar hangs as long as it should, for both elements and tets as large as it is thick", "[cut]") {
    for (const double size : {0.1, 0.05})
        for (const ElementKind element : kinds) {
            CAPTURE(size, static_cast<int>(element));
            CHECK(elongation(size, element) == Approx(1).epsilon(3e-4));
        }
}

TEST_CASE("cantilevers through turned lattices sag as they should within 2 % with 800 quadratic tets", "[cut]") {
    Bar small(askew({0.4, 0.1, 0.1}), 0.05, ElasticLaw::corotational, ElementKind::quadratic, material(1e5, 0.3), 1e9);
    small.in.gravity = small.box.turn * Vec3(0, 0, -9.81e-4);
    small.solve();
    CHECK(small.rest->tets.tets.size() < 900);
    CHECK(small.tip().z() == Approx(-0.39284e-4).epsilon(0.02));

    for (const ElasticLaw law : {ElasticLaw::stvk, ElasticLaw::log_neo_hookean}) {
        Bar large(askew({0.8, 0.1, 0.1}), 0.06, law, ElementKind::quadratic, material(1e6, 0.4), 1e10);
        for (int quarter = 1; quarter <= 4; ++quarter) {
            large.in.gravity = large.box.turn * Vec3(0, 0, -9.81 * quarter / 4);
            large.solve();
        }
        CHECK(large.rest->tets.tets.size() < 1200);
        CHECK(large.state.record.inverted == 0);
        CHECK(large.tip().z() == Approx(law == ElasticLaw::stvk ? -0.449623 : -0.449817).epsilon(0.02));
        CHECK(large.tip().x() == Approx(law == ElasticLaw::stvk ? -0.160287 : -0.157282).epsilon(0.04));
    }
}

TEST_CASE("Cook's panel through a turned lattice, within 2 % with under 3,000 quadratic tets, without locking",
          "[cut]") {
    const RotatedBox box = askew({1, 1, 0.25});
    const auto panel = [](const Vec3& p) {
        return Vec3(0.48 * p.x(), 0.44 * p.x() * (1 - p.y()) + p.y() * (0.44 + 0.16 * p.x()), 0.4 * p.z() - 0.05);
    };
    const double reference[] = {0.094832, 0.09597}, ratio[] = {0.3, 0.49};
    for (const int k : {0, 1}) {
        LatticeBody body(box.surface(1, panel), box.surface(64, panel), 0.06, ElasticLaw::log_neo_hookean,
                         ElementKind::quadratic, material(1e5, ratio[k]));
        body.hold([&](const Vec3& p) { return box.local(p).x() < 1e-9; }, 1e9);
        body.start();
        body.pull([&](const Vec3& p) { return box.local(p).x() > 0.48 - 1e-9; }, box.turn * Vec3(0, 3125, 0));
        body.solve();
        CHECK(body.rest->tets.tets.size() < 3000);
        CHECK(body.state.record.inverted == 0);
        const Vec3 corner =
            body.mean_displacement([&](const Vec3& p) { return (box.local(p) - Vec3(0.48, 0.6, 0)).norm() < 1e-9; });
        CHECK((box.turn.transpose() * corner).y() == Approx(reference[k]).epsilon(0.02));
    }
}

TEST_CASE("the energy of a smooth case converges at fourth order on lattices that cut it", "[cut]") {
    // A ball under the body force a x; its triangles enclose the ball's volume.
    const double modulus = 1e5, nu = 0.3, a = 1e-2, h = 100;
    SurfaceMesh ball = make_sphere(1, 80, 80);
    const double grown = std::cbrt(4 * std::numbers::pi / 3 / enclosed_volume(ball.points, ball.triangles));
    for (Vec3& p : ball.points) p *= grown;
    const double lambda = modulus * nu / ((1 + nu) * (1 - 2 * nu)), mu = modulus / (2 * (1 + nu)),
                 cubic = a / (10 * (lambda + 2 * mu)), linear = cubic * (5 * lambda + 6 * mu) / (3 * lambda + 2 * mu),
                 exact = 0.5 * a * 4 * std::numbers::pi * (linear / 5 - cubic / 7); // u = linear r - cubic r^3
    const auto error = [&](double size, ElementKind element) {
        LatticeBody body(ball, ball, size, ElasticLaw::corotational, element, material(modulus, nu));
        // A long implicit step with the velocities h a x / density at its start is the statics of that force.
        body.in.integrator = Integrator::backward_euler;
        body.in.step_size = h;
        body.in.tolerance_factor = 1e-5;
        body.start();
        for (std::size_t i = 0; i < body.state.v.size(); ++i) body.state.v[i] = h * a / 1000 * body.state.x[i];
        body.solve();
        return std::abs(body.state.record.energy / exact - 1);
    };
    const double coarse = error(1, ElementKind::quadratic), fine = error(0.4, ElementKind::quadratic);
    CHECK(coarse < 0.01);
    CHECK(std::log(coarse / fine) / std::log(1 / 0.4) > 3);
    CHECK(std::log(error(0.7, ElementKind::linear) / error(0.35, ElementKind::linear)) / std::log(2) > 1.8);
}

TEST_CASE("on cut tets gradients and Hessians are those of the energy, with means, fibres and damping", "[cut]") {
    const RotatedBox box = askew({0.2, 0.12, 0.1});
    for (const ElementKind element : kinds)
        for (const ElasticLaw law : {ElasticLaw::stvk, ElasticLaw::neo_hookean, ElasticLaw::log_neo_hookean,
                                     ElasticLaw::corotational, ElasticLaw::anisotropic}) {
            TissueInputs values = material(1e4, 0.47);
            values.layers[0].volume_conservation = 5e4;
            values.transverse_anisotropy = 0.4;
            values.fibers = {{2e4, 0.5, 0.7, 1}};
            LatticeBody body(box.surface(1), box.surface(1), 0.09, law, element, values);
            const std::size_t tets = body.rest->tets.tets.size();
            body.rest->stiff_directions.assign(tets, Vec3(1, 1, 0).normalized());
            body.rest->fibers = {{Points(tets, Vec3(0, 1, 1).normalized()), std::vector<double>(tets, 1.0)}};
            body.in.stiffness_damping = 0.02;
            body.start();
            std::mt19937 random(4);
            std::normal_distribution<double> normal;
            for (double& v : body.state.v) v = 0.02 * normal(random);
            Potential potential(*body.scene);
            ImplicitForm form;
            backward_euler_form(body.state, body.in.step_size, form);
            potential.take(body.state, body.in);
            potential.begin_step(body.state, body.in);
            potential.begin_stage(body.state, form, body.state.bones);
            std::vector<double> x = body.state.x, direction(x.size()), g, plus, minus;
            for (double& c : x) c += 0.001 * normal(random);
            for (double& d : direction) d = normal(random);
            const auto moved = [&](double t) {
                std::vector<double> out = x;
                for (std::size_t i = 0; i < x.size(); ++i) out[i] += t * direction[i];
                return out;
            };
            const double t = 1e-6;
            const double up = potential.evaluate(moved(t), &plus, nullptr),
                         down = potential.evaluate(moved(-t), &minus, nullptr);
            potential.evaluate(x, &g, nullptr);
            double slope = 0; // nothing is held, so unknowns are vertices
            for (std::size_t i = 0; i < g.size(); ++i) slope += g[i] * direction[i];
            CAPTURE(static_cast<int>(element), static_cast<int>(law));
            CHECK((up - down) / (2 * t) == Approx(slope).epsilon(1e-6));
            BlockMatrix hessian(potential.pattern());
            potential.assemble(x, false, hessian);
            std::vector<double> product(g.size());
            multiply(hessian, direction.data(), product.data());
            double off = 0, size = 0;
            for (std::size_t i = 0; i < g.size(); ++i) {
                off += std::pow((plus[i] - minus[i]) / (2 * t) - product[i], 2);
                size += product[i] * product[i];
            }
            CHECK(std::sqrt(off / size) < 1e-6);
        }
}

TEST_CASE("a tet is inverted where its solid is, not where it is empty", "[cut]") {
    const TetMesh whole = regular_tet(1);
    const auto inverted_with = [&](std::optional<std::size_t> solid_corner) {
        TetMesh mesh = whole;
        if (solid_corner) {
            // A corner of half the size.
            TetMoments part;
            std::array<Barycentric, 4> piece{};
            for (std::size_t k = 0; k < 4; ++k) piece[k][k] += 0.5, piece[k][*solid_corner] += 0.5;
            part.add(piece, 0.125);
            mesh.coverage = {0.125};
            mesh.cut = {4, {0}, {part.value.begin(), part.value.end()}};
        }
        auto rest = tissue(mesh, ElasticLaw::stvk);
        rest->element = ElementKind::quadratic;
        const Scene scene(SceneDescription{{rest}, {}});
        StepInputs in = still_inputs();
        in.bodies = {material(1e4, 0.3)};
        State s = initial_state(scene, in);
        // The middle of the edge between corners 0 and 1 moves close to corner 1, which folds there.
        set_position(s, 4, 0.1 * position(s, 0) + 0.9 * position(s, 1));
        Potential potential(scene);
        ImplicitForm form;
        quasi_static_form(s, form);
        potential.take(s, in);
        potential.begin_step(s, in);
        potential.begin_stage(s, form, s.bones);
        StepRecord record;
        potential.describe(s.x, record);
        CHECK((record.min_j > 0) == (record.inverted == 0));
        return record.inverted;
    };
    CHECK(inverted_with({}) == 1);
    CHECK(inverted_with(1) == 1);
    CHECK(inverted_with(0) == 0);
    CHECK(inverted_with(2) == 0);
}

TEST_CASE("cut tets give the same bits for one thread and two", "[cut]") {
    State states[2];
    for (const std::size_t threads : {1, 2}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Bar bar(askew({0.4, 0.1, 0.1}), 0.05, ElasticLaw::neo_hookean, ElementKind::quadratic, material(1e5, 0.45),
                1e8);
        bar.in.gravity = Vec3(0, 0, -3);
        bar.in.integrator = Integrator::tr_bdf2;
        bar.in.stiffness_damping = 0.01;
        bar.solve(2);
        states[threads - 1] = bar.state;
    }
    CHECK(states[0].x == states[1].x);
    CHECK(states[0].v == states[1].v);
}

TEST_CASE("lattices and elements that do not fit together, and moments that are none, are refused", "[cut]") {
    const RotatedBox box = askew({0.2, 0.12, 0.1});
    const auto code = [&](const std::function<void(TissueRest&)>& change) -> std::string {
        LatticeBody body(box.surface(1), box.surface(1), 0.09, ElasticLaw::stvk, ElementKind::linear,
                         material(1e4, 0.3));
        change(*body.rest);
        try {
            body.start();
        } catch (const Error& e) {
            CHECK(e.body == 0);
            return e.code;
        }
        return "none";
    };
    CHECK(code([](TissueRest&) {}) == "none");
    CHECK(code([](TissueRest& t) { t.element = ElementKind::quadratic; }) == "FE226");
    CHECK(code([](TissueRest& t) { t.tets.cut.moments.pop_back(); }) == "FE204");
    CHECK(code([](TissueRest& t) { t.tets.cut.moments[2] = std::nan(""); }) == "FE202");
    CHECK(code([](TissueRest& t) { t.tets.cut.tets.back() = 100000; }) == "FE203");
    CHECK(code([](TissueRest& t) { std::swap(t.tets.cut.tets[0], t.tets.cut.tets[1]); }) == "FE203");
}
