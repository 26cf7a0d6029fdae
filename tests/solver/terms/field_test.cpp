// What fields do to bodies, against closed forms. Derivatives, threads, saving and allocations: term_checks_test.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "tests/support/fields.h"
#include "tests/support/lattice_body.h"
#include "tests/support/trial.h"

using namespace sinew::test;
using enum FieldKind;

namespace {

constexpr Integrator integrators[] = {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2,
                                      Integrator::quasi_static};

void add_field(Trial& t, const TestField& field) {
    t.description.parts.push_back(field.part());
    t.in.parts.push_back(field.numbers());
}

/// A body that nothing holds, backward Euler.
Trial flying(const TetMesh& mesh, ElementKind kind, double density = 1000) {
    Trial t(mesh, ElasticLaw::neo_hookean, kind, nowhere, material(1e5, 0.3, density));
    t.use_backward_euler(1.0 / 24);
    return t;
}

/// A step under any scheme.
void go(Trial& t) {
    t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
    INFO("residual " << t.state.record.residual << " after " << t.state.record.newton_iterations);
    REQUIRE(t.state.record.converged);
}

/// Forces at all vertices where the body lies at rest [N]; nothing is held.
std::vector<double> loads(Trial& t) {
    t.in.integrator = Integrator::quasi_static;
    t.start();
    Trial::Judge judge(t, t.state);
    std::vector<double> gradient;
    judge.potential.evaluate(t.state.x, &gradient, nullptr);
    for (double& g : gradient) g = -g;
    return gradient;
}

Vec3 sum(const std::vector<double>& forces) {
    Vec3 out = Vec3::Zero();
    for (std::size_t i = 0; i < forces.size(); ++i) out[static_cast<Eigen::Index>(i % 3)] += forces[i];
    return out;
}

/// Torque about an axis through `place`.
double torque(const Trial& t, const std::vector<double>& forces, const Vec3& place, const Vec3& axis) {
    double out = 0;
    for (std::size_t v = 0; v < t.nodes.size(); ++v)
        out += axis.dot((t.nodes[v] - place).cross(Vec3(forces[3 * v], forces[3 * v + 1], forces[3 * v + 2])));
    return out;
}

TetMesh moved(TetMesh mesh, const Vec3& shift) {
    for (Vec3& p : mesh.vertices) p += shift;
    return mesh;
}

Vec3 centre(const Trial& t) {
    Vec3 out = Vec3::Zero();
    for (std::size_t v = 0; v < 4; ++v) out += 0.25 * position(t.state, static_cast<int>(v));
    return out;
}

} // namespace

TEST_CASE("a uniform field of a body's weight per volume loads it as gravity does, vertex by vertex") {
    const Vec3 g(3, -9.8, 1);
    for (const ElementKind kind : kinds) {
        TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 2, 2);
        for (std::size_t t = 0; t < mesh.tets.size(); ++t) mesh.coverage[t] = 0.3 + 0.7 / static_cast<double>(1 + t);
        Trial heavy = flying(mesh, kind, 1060), pushed = flying(mesh, kind, 1060);
        heavy.in.gravity = g;
        add_field(pushed, TestField(uniform, 1060 * g.norm()).towards(2 * g));
        const std::vector<double> a = loads(heavy), b = loads(pushed);
        double worst = 0, largest = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            worst = std::max(worst, std::abs(a[i] - b[i])), largest = std::max(largest, std::abs(a[i]));
        CHECK(largest > 0);
        CHECK(worst <= 2e-15 * largest);
    }
}

TEST_CASE("in a lattice that the surface cuts, fields reach what is inside: force and torque are those of the box") {
    const RotatedBox box({0.4, 0.2, 0.2}, 30, 30);
    const Vec3 axis = box.turn * Vec3(0, 0, 1), place = box.turn * Vec3(0, 3, 0);
    for (const ElementKind kind : kinds) {
        LatticeBody body(box.surface(1), box.surface(4), 0.11, ElasticLaw::stvk, kind, material(1e5, 0.3, 1060));
        TestField uniform_field = TestField(uniform, 10600).towards(axis), swirl = TestField(vortex, 700);
        swirl.around(axis).at(place).falling(1, 0.05);
        TestField heavy = TestField(gravity, 10).towards(axis);
        const auto gradient = [&](const TestField* f) {
            body.description.parts.clear(), body.in.parts.clear();
            if (f) body.description.parts = {f->part()}, body.in.parts = {f->numbers()};
            body.start();
            Potential potential(*body.scene);
            ImplicitForm form;
            quasi_static_form(body.state, form);
            potential.take(body.state, body.in);
            potential.begin_step(body.state, body.in);
            potential.begin_stage(body.state, form, body.state.bones);
            std::vector<double> out;
            potential.evaluate(body.state.x, &out, nullptr);
            return out;
        };
        CHECK((sum(gradient(&uniform_field)) + 10600 * 0.016 * axis).norm() < 1e-4 * 10600 * 0.016);
        body.in.gravity = 10 * axis;
        const std::vector<double> weight = gradient(nullptr);
        body.in.gravity = Vec3::Zero();
        for (const TestField* f : {&uniform_field, &heavy}) {
            const std::vector<double> other = gradient(f);
            double squares = 0, differences = 0;
            for (std::size_t i = 0; i < weight.size(); ++i)
                squares += weight[i] * weight[i], differences += std::pow(weight[i] - other[i], 2);
            CHECK(std::sqrt(differences / squares) < (kind == ElementKind::linear ? 1e-14 : 1e-3));
        }
        const std::vector<double> turning = gradient(&swirl);
        double torque = 0;
        for (std::size_t v = 0; v < turning.size() / 3; ++v)
            torque -= axis.dot((position(body.state, static_cast<int>(v)) - place)
                                   .cross(Vec3(turning[3 * v], turning[3 * v + 1], turning[3 * v + 2])));
        CHECK(torque == Approx(700 * 0.05 * 0.016).epsilon(kind == ElementKind::linear ? 2e-3 : 1e-4));
    }
}

TEST_CASE("a gravity field pulls on the mass that is there, also where layers change it over time") {
    for (const ElementKind kind : kinds)
        for (const Integrator integrator : integrators) {
            const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 4, 1, 1);
            std::vector<double> painted;
            for (std::size_t t = 0; t < mesh.tets.size(); ++t) painted.push_back(static_cast<double>(t % 3) / 2);
            const auto layered = [&] {
                Trial t(mesh, ElasticLaw::neo_hookean, kind, at_root, material(2e4, 0.4, 700));
                t.rest->layer_weights.push_back(painted);
                t.values().layers.push_back({5e4, 0.3, 2000, 1});
                t.in.integrator = integrator;
                t.in.tolerance_factor = 1e-4;
                return t;
            };
            Trial heavy = layered(), pulled = layered();
            heavy.in.gravity = Vec3(0, -9.8, 2);
            add_field(pulled, TestField(gravity, heavy.in.gravity.norm()).towards(heavy.in.gravity));
            heavy.start(), pulled.start();
            for (int step = 0; step < 6; ++step) {
                for (Trial* t : {&heavy, &pulled}) t->values().layers[1].mass_density = 2000 + 500 * step;
                go(heavy);
                go(pulled);
            }
            INFO(heavy.name() << ", integrator " << static_cast<int>(integrator));
            CHECK(heavy.distance_from([](const Vec3& p) { return p; }) > 0.003);
            CHECK(heavy.distance_from(pulled) < 1e-9);
        }
}

TEST_CASE("an air field of 10,388 N/m^3 holds a body of 1,060 kg/m^3 against gravity") {
    for (const ElementKind kind : kinds) {
        Trial t = flying(box_mesh({0.2, 0.1, 0.1}, 2, 1, 1), kind, 1060);
        t.in.gravity = Vec3(0, -9.8, 0);
        add_field(t, TestField(air, 10388).towards({0, 1, 0}));
        t.start();
        for (int step = 0; step < 24; ++step) REQUIRE(t.step());
        CHECK(t.distance_from([](const Vec3& p) { return p; }) < 1e-8); // of 4.9 m that it would have fallen
    }
}

TEST_CASE("a body in wind takes on the air's speed along the scheme's own sequence") {
    // m v' = (M/U)(U - v): backward Euler's v_n+1 = (v_n + h M/m) / (1 + h M/(m U)).
    const double h = 1.0 / 24, push = 3000, density = 800, top = 2.5;
    for (const ElementKind kind : kinds)
        for (const bool component : {false, true}) {
            Trial t = flying(box_mesh({0.1, 0.1, 0.1}, 1, 1, 1), kind, density);
            TestField wind = TestField(air, -push).towards({0, 0, -3}); // a negative magnitude blows the other way
            wind.values.air_speed = top;
            wind.rest.component_only = component;
            add_field(t, wind);
            t.start();
            for (std::size_t i = 0; i < t.state.v.size(); i += 3) t.state.v[i] = 1; // across
            double along = 0, across = 1;
            for (int step = 0; step < 80; ++step) {
                REQUIRE(t.step());
                along = (along + h * push / density) / (1 + h * push / (density * top));
                if (!component) across /= 1 + h * push / (density * top);
                CHECK(t.state.v[2] == Approx(along).epsilon(1e-7));
                CHECK(t.state.v[0] == Approx(across).epsilon(1e-6).margin(1e-9));
            }
            CHECK(along > 0.98 * top);
            // What is faster than the air is braked, or left alone.
            for (std::size_t i = 2; i < t.state.v.size(); i += 3) t.state.v[i] = 2 * top;
            REQUIRE(t.step());
            CHECK((t.state.v[2] < 1.999 * top) == !component);
        }
}

TEST_CASE("falling in drag ends at the speed where it carries the weight, exactly under every scheme") {
    const double density = 1060, g = 9.8;
    for (const ElementKind kind : kinds)
        for (const Integrator integrator : {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2}) {
            Trial t = flying(box_mesh({0.1, 0.1, 0.1}, 1, 1, 1), kind, density);
            t.in.integrator = integrator;
            t.in.gravity = Vec3(0, -g, 0);
            t.in.tolerance_factor = 1e-4;
            add_field(t, TestField(drag, 5000));
            t.start();
            double speed = 0;
            for (int step = 0; step < 200; ++step) {
                go(t);
                speed = (speed + g * t.in.step_size) / (1 + t.in.step_size * 5000 / density);
                if (integrator == Integrator::backward_euler) CHECK(-t.state.v[1] == Approx(speed).epsilon(1e-9));
            }
            CHECK(-t.state.v[1] == Approx(density * g / 5000).epsilon(1e-8));
        }
}

TEST_CASE("drag weakens on slow things and acts along its direction alone, where it is told so") {
    Trial t = flying(box_mesh({0.1, 0.1, 0.1}, 1, 1, 1), ElementKind::quadratic);
    t.in.gravity = Vec3(4, -9.8, 0);
    TestField mud = TestField(drag, 3000).towards({0, 2, 0});
    mud.rest.use_direction = true;
    mud.values.speed_attenuation = 8;
    add_field(t, mud);
    t.start();
    for (int step = 0; step < 120; ++step) REQUIRE(t.step());
    // density g = magnitude v^2 / 8
    CHECK(-t.state.v[1] == Approx(std::sqrt(1000 * 9.8 * 8 / 3000)).epsilon(1e-6));
    CHECK(t.state.v[0] == Approx(4 * 120.0 / 24).epsilon(1e-6));
}

TEST_CASE("a newton field pulls on a far cube as if all of it were in its middle, with the square of the distance") {
    // A cube has no quadrupole: the next term is of fourth order in its size over the distance.
    for (const ElementKind kind : kinds)
        for (const double distance : {2.0, 4.0}) {
            Trial t = flying(moved(box_mesh({0.2, 0.2, 0.2}, 4, 4, 4), {-0.1, -0.1, -0.1}), kind, 1100);
            add_field(t, TestField(newton, 30).at({0, distance, 0}).falling(2, 0.5));
            const Vec3 force = sum(loads(t));
            const double expected = 1100 * 0.008 * 30 * 0.25 / (distance * distance);
            INFO("force " << force.transpose() << " of " << expected);
            CHECK(force.y() == Approx(expected).epsilon(kind == ElementKind::linear ? 2e-4 : 2e-5));
            // What is lumped on the vertices of these tets is aslant, by the square of their size.
            CHECK(std::hypot(force.x(), force.z()) < (kind == ElementKind::linear ? 3e-4 : 1e-5) * expected);
        }
}

TEST_CASE("a body circles a newton field in Kepler's time") {
    // Acceleration 20 (0.5/r)^2 = 5/r^2; at r = 1 a circle of speed sqrt 5.
    const double period = 2 * M_PI / std::sqrt(5.0);
    double miss[2];
    for (const int fine : {0, 1}) {
        const int steps = fine ? 400 : 200;
        Trial t = flying(moved(regular_tet(0.01), {1, 0, 0}), ElementKind::linear);
        t.in.integrator = Integrator::tr_bdf2;
        t.in.step_size = period / steps;
        add_field(t, TestField(newton, 20).falling(2, 0.5));
        t.start();
        for (std::size_t i = 1; i < t.state.v.size(); i += 3) t.state.v[i] = std::sqrt(5.0);
        for (int step = 0; step < steps; ++step) {
            go(t);
            if (step == steps / 2 - 1) CHECK((centre(t) - Vec3(-1, 0, 0)).norm() < 2e-3);
        }
        miss[fine] = (centre(t) - Vec3(1, 0, 0)).norm();
    }
    CHECK(miss[1] < 1e-3);
    CHECK(std::log2(miss[0] / miss[1]) == Approx(2).margin(0.2));
}

TEST_CASE("a vortex that falls off with the distance from its axis gives every volume the same torque") {
    // Force M r0/rho around the axis: torque M r0 a volume, wherever it lies.
    const Vec3 axis = Vec3(1, 2, 3).normalized(), place(0.3, -0.4, 0.1);
    for (const ElementKind kind : kinds) {
        Trial t = flying(box_mesh({0.3, 0.2, 0.1}, 3, 2, 1), kind);
        add_field(t, TestField(vortex, 700).around(3 * axis).at(place).falling(1, 0.05));
        const std::vector<double> forces = loads(t);
        CHECK(torque(t, forces, place, axis) == Approx(700 * 0.05 * 0.006).epsilon(1e-12));
    }
}

TEST_CASE("a volume axis field turns a box by its polar moment and pushes it along the axis") {
    // In a cylinder, inverted, attenuation 1: M rho/R around the axis, so the torque is M/R times the integral of
    // rho^2.
    for (const ElementKind kind : kinds) {
        Trial t = flying(moved(box_mesh({0.2, 0.2, 0.2}, 4, 4, 4), {0.3, -0.1, -0.1}), kind);
        TestField f = TestField(volume_axis, 900).around({0, 0, -5});
        f.rest.volume = FieldVolume::cylinder;
        f.rest.invert_attenuation = true;
        f.values.attenuation = 1, f.values.radius = 2, f.values.height = 3;
        f.values.around_axis = -1;
        add_field(t, f);
        const double moment = 0.008 * (0.4 * 0.4 + (0.04 + 0.04) / 12);
        CHECK(torque(t, loads(t), Vec3::Zero(), Vec3(0, 0, 1)) ==
              Approx(900 / 2.0 * moment).epsilon(kind == ElementKind::linear ? 0.01 : 1e-12));

        f.values.around_axis = 0, f.values.along_axis = 2, f.values.attenuation = 0;
        t.description.parts = {f.part()}, t.in.parts = {f.numbers()};
        CHECK((sum(loads(t)) - Vec3(0, 0, -2 * 900 * 0.008)).norm() < 1e-12);
        f.values.radius = 0.25; // the box is outside
        t.in.parts = {f.numbers()};
        CHECK(sum(loads(t)).norm() < 1e-12);
    }
}

TEST_CASE("strength over distance: whole up to the reference distance, a power beyond, smoothly to zero at the end") {
    const auto at = [](const TestField& f, double distance) {
        return field_force(f.now(), Vec3(distance, 0, 0), Vec3::Zero());
    };
    const TestField push = TestField(radial, 100).falling(1.5, 0.2);
    CHECK(at(push, 0.8).x() == Approx(100 / 8.0));
    CHECK(at(push, 0.2).x() == Approx(100));
    CHECK(at(push, 0.05).x() == Approx(25));
    CHECK(at(push, 0).norm() == 0);
    CHECK(at(TestField(radial, -100).falling(2, 0.2), 0.6).x() == Approx(-100 / 9.0));
    CHECK(at(TestField(newton, 100).falling(3, 0.2), 0.4).x() == Approx(-100 / 8.0));
    const TestField wind = TestField(uniform, 100).towards({0, 4, 0}).falling(2, 0.5);
    CHECK(at(wind, 0.3).y() == Approx(100));
    CHECK(at(wind, 1).y() == Approx(25));
    const TestField ends = TestField(uniform, 100).towards({0, 1, 0}).ending(2);
    CHECK(at(ends, 1.6).y() == Approx(100));
    CHECK(at(ends, 1.8).y() == Approx(50));
    CHECK(at(ends, 1.9).y() == Approx(15.625));
    CHECK(at(ends, 2).norm() == 0);
    CHECK(at(ends, 3).norm() == 0);
    // Around the axis, and no matter where along it.
    const TestField swirl = TestField(vortex, 100).around({0, 0, 2}).falling(1, 0.5);
    CHECK((field_force(swirl.now(), Vec3(0, 2, 7), Vec3::Zero()) - Vec3(-25, 0, 0)).norm() < 1e-13);
}

TEST_CASE("the potential of a central field is the work of its force") {
    for (const TestField& f :
         {TestField(newton, 7).falling(2, 0.3), TestField(newton, 7).falling(1, 0.3),
          TestField(radial, -3).falling(0, 0.3), TestField(radial, 3).falling(2.7, 0.3).ending(1),
          TestField(newton, 2).falling(1 + 1e-10, 0.9).ending(1), TestField(radial, 3).ending(0.8)}) {
        const FieldAt now = f.now();
        double worst = 0;
        for (const double from : {0.0, 0.1, 0.29, 0.7, 0.85})
            for (const double to : {0.02, 0.31, 0.83, 0.97, 1.4}) {
                constexpr int parts = 20000;
                double work = 0;
                for (int i = 0; i < parts; ++i) {
                    const double x = from + (to - from) * (i + 0.5) / parts;
                    work += field_force(now, Vec3(x, 0, 0), Vec3::Zero()).x() * (to - from) / parts;
                }
                worst = std::max(worst, std::abs(field_potential(now, Vec3(0, to, 0), Vec3(0, 0, from)) + work));
            }
        CHECK(worst < 1e-7);
    }
}

TEST_CASE("without inertia drag does nothing and air pushes as on what is at rest") {
    for (const ElementKind kind : kinds) {
        std::vector<Trial> trials;
        for (const TestField& f : {TestField(uniform, 500), TestField(air, 500)}) {
            trials.emplace_back(box_mesh({0.3, 0.1, 0.1}, 3, 1, 1), ElasticLaw::stvk, kind, at_root, flesh(1e4, 0.3));
            add_field(trials.back(), f);
            add_field(trials.back(), TestField(drag, 1e5));
            trials.back().start();
            REQUIRE(trials.back().step(true));
            REQUIRE(trials.back().step(true));
        }
        CHECK(trials[0].distance_from([](const Vec3& p) { return p; }) > 0.01);
        CHECK(trials[0].distance_from(trials[1]) < 1e-8);
    }
}

TEST_CASE("under fields that depend on place, velocity and time every scheme keeps its order") {
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 1, 1);
    const double orders[] = {1, 2, 2};
    for (const ElementKind kind : kinds)
        for (std::size_t scheme = 0; scheme < 3; ++scheme) {
            std::vector<Vec3> tips;
            for (const int steps : {100, 200, 400}) {
                Trial t(mesh, ElasticLaw::neo_hookean, kind, at_root, material(2e4, 0.3));
                t.in.integrator = integrators[scheme];
                t.in.step_size = 0.2 / steps;
                t.in.tolerance_factor = 1e-3;
                t.in.stiffness_damping = 0.005; // calms modes that these steps do not resolve
                TestField wind = TestField(air).towards({0, 1, 0.3}).at({0.5, 0.2, 0}).falling(1, 0.2);
                wind.values.air_speed = 2;
                TestField swirls(turbulence);
                swirls.values.wavelength = 0.2;
                TestField fields[] = {TestField(newton).at({0.4, 0.3, 0}).falling(2, 0.2),
                                      TestField(vortex).at({0.1, 0, 0.2}), TestField(drag), wind, swirls};
                const double strengths[] = {15, 2e3, 2e3, 4e3, 2e3};
                for (const TestField& f : fields) add_field(t, f);
                t.start();
                for (int i = 1; i <= steps; ++i) {
                    const double time = i * t.in.step_size;
                    fields[4].values.evolution = 10 * time, fields[4].values.phase_x = 4 * time;
                    for (std::size_t k = 0; k < 5; ++k) {
                        fields[k].values.magnitude = strengths[k] * (1 - std::cos(25 * time));
                        t.in.parts[k] = fields[k].numbers();
                    }
                    go(t);
                }
                tips.push_back(position(t.state, static_cast<int>(mesh.vertices.size()) - 1));
            }
            CHECK((tips[2] - mesh.vertices.back()).norm() > 0.005);
            const double order = std::log2((tips[0] - tips[1]).norm() / (tips[1] - tips[2]).norm());
            INFO("element " << static_cast<int>(kind) << ", scheme " << scheme << ", order " << order);
            CHECK(order == Approx(orders[scheme]).margin(0.25));
        }
}

TEST_CASE("turbulence has mean 0 and a root mean square of its magnitude, with any number of layers") {
    for (const int level : {0, 3}) {
        TestField f(turbulence, 5);
        f.rest.noise_level = level;
        f.values.noise_ratio = 0.7;
        f.values.wavelength = 0.5;
        Vec3 mean = Vec3::Zero();
        double squares = 0;
        constexpr int count = 20000;
        for (int i = 0; i < count; ++i) {
            // An even spread over a large place: multiples of irrational numbers.
            f.values.evolution = std::fmod(i * 0.7548776662, 1) * 100;
            const Vec3 x(std::fmod(i * 0.8191725134, 1) * 100, std::fmod(i * 0.6710436067, 1) * 100,
                         std::fmod(i * 0.5497004779, 1) * -100);
            const Vec3 force = field_force(f.now(), x, Vec3::Zero());
            mean += force / count;
            squares += force.squaredNorm() / count;
        }
        CHECK(mean.norm() < 0.1);
        CHECK(std::sqrt(squares) == Approx(5).epsilon(0.02));
    }
}

TEST_CASE("the length of a direction or axis does not count, however long or short it is") {
    const Vec3 x(0.3, -0.2, 0.5);
    for (const double length : {1e300, 1e-300, 5.0}) {
        INFO(length);
        const Vec3 along = length * Vec3(0.6, 0, 0.8);
        const Vec3 pushed = field_force(TestField(uniform, 50).towards(along).now(), x, Vec3::Zero());
        CHECK((pushed - Vec3(30, 0, 40)).norm() < 1e-12);
        const Vec3 turned = field_force(TestField(vortex, 50).around(along).now(), x, Vec3::Zero());
        CHECK((turned - field_force(TestField(vortex, 50).around({3, 0, 4}).now(), x, Vec3::Zero())).norm() < 1e-12);
        CHECK(turned.norm() > 1);
    }
}

TEST_CASE("noise is what an implementation in another language makes of its description") {
    TestField f(turbulence, 1);
    f.values.evolution = 0.6;
    const Vec3 a = field_force(f.now(), Vec3(0.3, -1.7, 2.25), Vec3::Zero());
    CHECK((a - Vec3(0.240250313574253, 1.0271704973538462, -0.5821356807942594)).norm() < 1e-14);
    f.values.wavelength = 0.5;
    f.values.phase_y = 4;
    f.values.x = 1, f.values.evolution = 0.6;
    const Vec3 b = field_force(f.now(), Vec3(1.15, -2.85, 1.125), Vec3::Zero());
    CHECK((a - b).norm() < 1e-13);
}

TEST_CASE("the fields' total force is reported, and arrows show where it acts") {
    Trial t = flying(box_mesh({0.5, 0.2, 0.2}, 10, 4, 4), ElementKind::quadratic);
    add_field(t, TestField(uniform, 50).towards({0, 0, -2}));
    add_field(t, TestField(gravity, 2).towards({1, 0, 0}));
    t.start();
    REQUIRE(t.step());
    CHECK(value_of(t.state.record.measured, "field", "force_x_N") == Approx(2 * 1000 * 0.02));
    CHECK(value_of(t.state.record.measured, "field", "force_y_N") == Approx(0).margin(1e-12));
    CHECK(value_of(t.state.record.measured, "field", "force_z_N") == Approx(-50 * 0.02));
    Trial::Judge judge(t, t.state);
    Marks marks;
    judge.potential.marks(t.state.x, marks);
    REQUIRE(marks.size() == 2);
    CHECK(marks[0].what == "uniformField");
    CHECK(marks[1].what == "gravityField");
    for (std::size_t k = 0; k < 2; ++k) {
        CHECK(marks[k].marks.size() > 100);
        CHECK(marks[k].marks.size() <= 300);
        for (const Mark& m : marks[k].marks) {
            CHECK(m.value == Approx(k == 0 ? 50 : 2000));
            CHECK((m.to - m.from).normalized().dot(k == 0 ? Vec3(0, 0, -1) : Vec3(1, 0, 0)) == Approx(1));
            CHECK(m.part == static_cast<int>(k));
        }
    }
}

TEST_CASE("fields that cannot be used are refused by name") {
    const auto refused = [](const TestField& f, const char* what) {
        Trial t = flying(regular_tet(0.1), ElementKind::linear);
        add_field(t, f);
        t.start();
        try {
            advance(*t.workspace, t.state, std::span(&t.in, 1));
            FAIL("taken");
        } catch (const Error& e) {
            CHECK(e.code == "FE304");
            CHECK(e.body == 0);
            CHECK_THAT(e.what(), Catch::Contains(what));
        }
    };
    refused(TestField(uniform, 1).towards({0, 0, 0}), "direction");
    refused(TestField(vortex, 1).around({0, 0, 0}), "axis");
    refused(TestField(radial, 1).falling(-1, 1), "attenuation");
    refused(TestField(radial, 1).falling(1, 0), "referenceDistance");
    refused(TestField(radial, 1).ending(0), "maxDistance");
    refused(TestField(drag, -1), "magnitude");
    TestField wind(air, 1);
    wind.values.air_speed = 0;
    refused(wind, "airSpeed");

    Trial t = flying(regular_tet(0.1), ElementKind::linear);
    t.add_bone({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    t.description.parts.push_back(TestField(uniform, 1).part({0, 1}));
    t.in.parts.push_back(TestField(uniform, 1).numbers());
    try {
        t.start();
        FAIL("taken");
    } catch (const Error& e) {
        CHECK(e.code == "FE218");
        CHECK(e.body == 1);
    }
}
