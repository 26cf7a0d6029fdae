// What pressure does to bodies, against closed forms. Derivatives, threads, saving and allocations:
// term_checks_test.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/terms/pressure/pressure.h"
#include "tests/support/loaded_body.h"

#include <Eigen/Geometry>

using namespace sinew::test;

namespace {

constexpr Integrator integrators[] = {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2,
                                      Integrator::quasi_static};
const Vec3 size(0.3, 0.1, 0.2);

LoadedBody box(ElementKind kind, const Where& held = nowhere, ElasticLaw law = ElasticLaw::log_neo_hookean) {
    return LoadedBody(box_mesh(size, 3, 1, 2), kind, material(1000, 0.45), held, law);
}

/// The volume of a closed surface, by its triangles.
double volume_of(const Points& p, const std::vector<Triangle>& triangles) {
    double sum = 0;
    for (const Triangle& t : triangles)
        sum += p[static_cast<std::size_t>(t[0])].dot(
                   p[static_cast<std::size_t>(t[1])].cross(p[static_cast<std::size_t>(t[2])])) /
               6;
    return sum;
}

} // namespace

TEST_CASE("a body under pressure shrinks alike everywhere, by the stretch that its law gives") {
    const auto table = accuracy()["spheres_and_balls"]["ball_E1000_nu0.45"];
    for (const ElementKind kind : kinds)
        for (const ElasticLaw law : {ElasticLaw::neo_hookean, ElasticLaw::log_neo_hookean, ElasticLaw::corotational}) {
            const double stretch = table[std::string(law_facts(law).reference)]["stretch_under_pressure_500"];
            LoadedBody b = box(kind, nowhere, law);
            b.load(pressure_type, 500);
            b.settle();
            for (const auto& [i, j] : edges_of(b.rest->tets.tets))
                CHECK((position(b.state, i) - position(b.state, j)).norm() ==
                      Approx(stretch * (b.node(i) - b.node(j)).norm()).epsilon(1e-7));
            // A layer's envelope below 0 pushes outwards.
            b.in.parts = {{-0.2}};
            b.settle();
            CHECK(b.tet_volume_now() > size.prod());
        }
}

TEST_CASE("in the lattice a ball under pressure shrinks by its law's stretch, and the mean stress is the pressure") {
    const double stretch = accuracy()["spheres_and_balls"]["ball_E1000_nu0.45"]["nh"]["stretch_under_pressure_500"];
    for (const ElementKind kind : kinds) {
        LoadedBody b = box(kind);
        b.use(lattice_ball(0.05, 0.03, ElasticLaw::log_neo_hookean, kind));
        const double at_rest = volume_of(b.rest->surface, b.rest->triangles);
        b.load(pressure_type, 500);
        b.settle();
        // Measured by where the surface is; its triangles bend with the tets, a little.
        const double volume = value_of(b.state.record.measured, "pressure", "volume_m3");
        CHECK(std::cbrt(volume / at_rest) == Approx(stretch).epsilon(1e-3));
        CHECK(b.elastic_virial() / (3 * volume) == Approx(-500).epsilon(2e-3));
    }
}

TEST_CASE("pressure on a closed surface works on the volume that its tets enclose, however they are bent") {
    for (const ElementKind kind : kinds) {
        LoadedBody b = box(kind);
        b.load(pressure_type, 700);
        b.in.integrator = Integrator::quasi_static;
        b.start();
        const auto energy = [&](double envelope) {
            LoadedBody other(b);
            other.in.parts = {{envelope}};
            other.start();
            other.state.x = b.state.x;
            LoadedBody::Judge judge(other, other.state);
            return judge.potential.evaluate(other.state.x, nullptr, nullptr);
        };
        b.place(everywhere, [](const Vec3& p) {
            return Vec3(p.x() + 0.2 * p.y() * p.z(), p.y() * (1 + p.x()), p.z() + 0.5 * p.x() * p.x());
        });
        CHECK(energy(1) - energy(0) == Approx(700 * (b.tet_volume_now() - size.prod())).epsilon(1e-9));
        // Virial of the forces: -3 p V.
        double virial = 0;
        const std::vector<Vec3> with = b.forces();
        b.in.parts = {{0}};
        const std::vector<Vec3> without = b.forces();
        for (std::size_t v = 0; v < with.size(); ++v)
            virial += (with[v] - without[v]).dot(position(b.state, static_cast<int>(v)));
        CHECK(virial == Approx(-3 * 700 * b.tet_volume_now()).epsilon(1e-10));
    }
}

TEST_CASE("painted pressure pushes with its integral over the projected area, and turns with the surface") {
    for (const ElementKind kind : kinds) {
        // The painted top of a box, with what the paint leaves on the sides, which cancels.
        LoadedBody b = box(kind);
        b.load(pressure_type, 300, b.weights([](const Vec3& p) { return p.z() > size.z() - 1e-9 ? 1 : 0; }));
        const double force = 300 * size.x() * size.y();
        CHECK((b.net_force() - Vec3(0, 0, -force)).norm() < 1e-12 * force);
        const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
        b.place(everywhere, [&](const Vec3& p) { return Vec3(turn * p + Vec3(1, 0, 3)); });
        CHECK((b.net_force() - turn * Vec3(0, 0, -force)).norm() < 1e-10 * force);
        b.in.parts = {{-2}};
        CHECK((b.net_force() - turn * Vec3(0, 0, 2 * force)).norm() < 1e-10 * force);

        // Pressure like depth in water on a ball that the lattice does not fit: Archimedes.
        LoadedBody ball = box(kind);
        ball.use(lattice_ball(0.1, 0.06, ElasticLaw::stvk, kind));
        ball.load(pressure_type, 2000, ball.weights([](const Vec3& p) { return 0.5 - p.z() / 0.2; }));
        const double lift = 2000 / 0.2 * volume_of(ball.rest->surface, ball.rest->triangles);
        CHECK((ball.net_force() - Vec3(0, 0, lift)).norm() < 1e-8 * lift);
    }
}

TEST_CASE("pressure on one face of a cantilever bends it as the same load per area does while it is small") {
    for (const ElementKind kind : kinds) {
        const auto on_top = [](const Vec3& p) { return p.z() > size.z() - 1e-9; };
        LoadedBody b = box(kind, at_root);
        std::erase_if(b.rest->triangles, [&](const Triangle& t) {
            return !std::all_of(t.begin(), t.end(),
                                [&](int v) { return on_top(b.rest->surface[static_cast<std::size_t>(v)]); });
        });
        LoadedBody dead(b);
        dead.rest = std::make_shared<TissueRest>(*b.rest);
        b.load(pressure_type, 1e-4);
        b.settle(1);
        // The same on the nodes: to the corners of linear triangles, to the middles of the edges of quadratic ones.
        Points loads(b.nodes.size(), Vec3::Zero());
        const auto edges = edges_of(b.rest->tets.tets);
        for (const Triangle& t : b.rest->triangles)
            for (std::size_t i = 0; i < 3; ++i) {
                const int p = t[i], q = t[(i + 1) % 3], r = t[(i + 2) % 3];
                const double third = (b.node(q) - b.node(p)).cross(b.node(r) - b.node(p)).norm() / 6;
                const std::array<int, 2> edge{std::min(p, q), std::max(p, q)};
                const auto middle =
                    static_cast<std::size_t>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin());
                const std::size_t node =
                    kind == ElementKind::linear ? static_cast<std::size_t>(p) : b.rest->tets.vertices.size() + middle;
                loads[node].z() -= 1e-4 * third;
            }
        dead.values().forces = loads;
        dead.settle(1);
        const double moved = b.distance_from([](const Vec3& p) { return p; });
        CHECK(moved > 1e-8);
        CHECK(b.distance_from(dead) < 1e-4 * moved);
    }
}

TEST_CASE("a hanging block under pressure is in balance under every scheme") {
    for (const ElementKind kind : kinds)
        for (const Integrator integrator : integrators) {
            LoadedBody b(box_mesh({0.1, 0.1, 0.1}, 2, 2, 2), kind, material(2e4, 0.4, 1000));
            b.in.integrator = Integrator::quasi_static;
            b.in.gravity = Vec3(9.8, 0, 0);
            b.load(pressure_type, 4000);
            b.add_bone({{0, -1, -1}, {0, 2, -1}, {0, 0, 3}});
            b.attach_root(0, 1, 1e6);
            b.settle(1);
            // l^3 where mu (l^2 - 1) + 3 lambda ln l = -p l^3; the springs and the weight add a little.
            CHECK(b.tet_volume_now() == Approx(1e-3 * 0.8972).epsilon(0.01));
            const std::vector<double> x = b.state.x;
            b.in.integrator = integrator, b.in.step_size = 1.0 / 24;
            b.settle(4);
            double moved = 0;
            for (std::size_t i = 0; i < x.size(); ++i) moved = std::max(moved, std::abs(b.state.x[i] - x[i]));
            CHECK(moved < 1e-8);
        }
}

TEST_CASE("an envelope that rises within a step gives its mean impulse under TR-BDF2") {
    for (const ElementKind kind : kinds) {
        LoadedBody b(box_mesh(size, 3, 1, 2), kind, material(1e9, 0.3, 1000));
        b.in.integrator = Integrator::tr_bdf2;
        b.in.step_size = 1e-3;
        b.load(pressure_type, 300, b.weights([](const Vec3& p) { return p.z() > size.z() - 1e-9 ? 1 : 0; }));
        b.in.parts = {{0}};
        b.settle(1);
        b.in.parts = {{1}};
        b.settle(1);
        Vec3 momentum = Vec3::Zero();
        const double mass = 1000 * size.prod();
        // Uniform to what a body this stiff bends.
        for (std::size_t v = 0; v < b.nodes.size(); ++v)
            momentum += mass / static_cast<double>(b.nodes.size()) *
                        Vec3(b.state.v[3 * v], b.state.v[3 * v + 1], b.state.v[3 * v + 2]);
        CHECK(momentum.z() == Approx(-0.5 * 300 * size.x() * size.y() * 1e-3).epsilon(0.02));
    }
}

TEST_CASE("a surface that reaches out of its tets is pressed all the same") {
    for (const ElementKind kind : kinds) {
        LoadedBody b = box(kind, at_root);
        for (Vec3& p : b.rest->surface) p = 1.04 * (p - 0.5 * size) + 0.5 * size;
        b.rest->embedding = embed(b.rest->tets, b.rest->surface);
        const ClippedSurface clipped = clip_surface(b.rest->surface, b.rest->triangles, CarrierTets(b.rest->tets));
        CHECK(std::all_of(clipped.is_outside.begin(), clipped.is_outside.end(), [](char o) { return o != 0; }));
        b.load(pressure_type, 10);
        b.settle(1);
        // Its lever on the tets is as much larger as its volume.
        LoadedBody fits = box(kind, at_root);
        fits.load(pressure_type, 10);
        fits.settle(1);
        CHECK((b.tet_volume_now() - size.prod()) / (fits.tet_volume_now() - size.prod()) ==
              Approx(std::pow(1.04, 3)).epsilon(0.02));
    }
}

TEST_CASE("pressures and tensions that are no numbers are refused with the body") {
    for (const bool in_weights : {false, true}) {
        LoadedBody b = box(ElementKind::linear);
        const double nan = std::numeric_limits<double>::quiet_NaN();
        b.load(pressure_type, in_weights ? 1 : nan, b.weights([&](const Vec3&) { return in_weights ? nan : 1; }));
        try {
            b.start();
            FAIL("taken");
        } catch (const Error& e) {
            CHECK(e.code == "FE202");
            CHECK(e.body == 0);
        }
    }
}
