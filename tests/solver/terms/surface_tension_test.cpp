// What surface tension does to bodies, against closed forms. Derivatives, threads, saving and allocations:
// term_checks_test.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/surface_tension/surface_tension.h"
#include "tests/support/loaded_body.h"

using namespace sinew::test;

namespace {

const Vec3 size(0.3, 0.1, 0.2);

double area_measured(const State& state) { return value_of(state.record.measured, "surfaceTension", "area_m2"); }

} // namespace

TEST_CASE("the mean stress of a body under surface tension is that of Laplace's law for its area and volume") {
    // Where strains are small the mean change of volume is the mean stress over the bulk modulus, whatever the shape:
    // -(2/3) g A / (V K). A ball has A/V = 3/R, so -2 g / (R K).
    const double youngs = 1e5, tension = 1;
    for (const ElementKind kind : kinds) {
        LoadedBody b(box_mesh(size, 3, 1, 2), kind, material(youngs, 0.3));
        b.load(surface_tension_type, tension);
        b.settle();
        const double area = 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
        CHECK(area_measured(b.state) == Approx(area).epsilon(1e-3));
        const double expected = -2.0 / 3 * tension * area / (size.prod() * bulk_modulus(youngs, 0.3));
        CHECK(b.tet_volume_now() / size.prod() - 1 == Approx(expected).epsilon(1e-3));
        // Stress by its virial, exactly: the sum of f.x over the nodes is -2 g A.
        CHECK(b.elastic_virial() == Approx(-2 * tension * area_measured(b.state)).epsilon(1e-7));
        b.in.parts = {{-1}}; // spreads
        b.settle();
        CHECK(b.tet_volume_now() / size.prod() - 1 == Approx(-expected).epsilon(1e-3));
    }
}

TEST_CASE("a ball in the lattice under surface tension has the pressure of Laplace's law") {
    const double youngs = 1e5, tension = 1, radius = 0.05;
    for (const ElementKind kind : kinds) {
        LoadedBody b(box_mesh(size, 3, 1, 2), kind, material(youngs, 0.3));
        b.use(lattice_ball(radius, 0.025, ElasticLaw::log_neo_hookean, kind, 24));
        b.load(surface_tension_type, tension);
        b.start();
        const double volume = 4.0 / 3 * M_PI * std::pow(radius, 3);
        b.settle();
        // The polygons of the ball have 1.2 % less volume and 0.6 % less area than the sphere.
        CHECK(b.elastic_virial() / (3 * volume) == Approx(-2 * tension / radius).epsilon(0.015));
        CHECK(b.elastic_virial() == Approx(-2 * tension * area_measured(b.state)).epsilon(1e-7));
    }
}

TEST_CASE("an open sheet pulls its edges with tension times their length") {
    for (const ElementKind kind : kinds) {
        LoadedBody b(box_mesh(size, 3, 1, 2), kind, material(1000, 0.3));
        const auto on_top = [](const Vec3& p) { return p.z() > size.z() - 1e-9; };
        std::erase_if(b.rest->triangles, [&](const Triangle& t) {
            return !std::all_of(t.begin(), t.end(),
                                [&](int v) { return on_top(b.rest->surface[static_cast<std::size_t>(v)]); });
        });
        b.load(surface_tension_type, 3);
        const std::vector<Vec3> f = b.forces();
        Vec3 left = Vec3::Zero(), inside = Vec3::Zero();
        for (std::size_t v = 0; v < f.size(); ++v) {
            if (b.nodes[v].x() < 1e-9) left += f[v];
            if (b.nodes[v].x() > 1e-9 && b.nodes[v].x() < size.x() - 1e-9) inside += f[v];
        }
        CHECK(left.x() == Approx(3 * size.y()).epsilon(1e-12));
        CHECK(inside.norm() < 1e-12);
        CHECK(b.net_force().norm() < 1e-12);

        // Painted with a share of x over the length, the sum over all of the sheet of g'(x) da pulls towards more.
        LoadedBody painted(b);
        painted.rest = std::make_shared<TissueRest>(*b.rest);
        painted.description.bodies[0] = painted.rest;
        painted.load(surface_tension_type, 3, painted.weights([](const Vec3& p) { return p.x() / size.x(); }));
        Vec3 weak = Vec3::Zero(), strong = Vec3::Zero();
        const std::vector<Vec3> g = painted.forces();
        for (std::size_t v = 0; v < g.size(); ++v) (painted.nodes[v].x() < size.x() / 2 ? weak : strong) += g[v];
        CHECK((weak + strong).norm() < 1e-12);
        CHECK(weak.x() > 0);
        // The energy's derivative along a stretch of x about x = 0: the mean of the painted tension times the area.
        double work = 0;
        for (std::size_t v = 0; v < g.size(); ++v) work += g[v].x() * painted.nodes[v].x();
        CHECK(work == Approx(-3 * 0.5 * size.x() * size.y()).epsilon(1e-12));
    }
}
