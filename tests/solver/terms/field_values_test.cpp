// Fields: numbers of small cases that are known by hand.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/fields.h"
#include "tests/support/trial.h"

using namespace sinew::test;

TEST_CASE("drag dissipates half of the square of speed, less where it is slow") {
    TestField mud(FieldKind::drag, 5);
    mud.values.speed_attenuation = 2;
    const auto of = [&](double speed) { return field_dissipation(mud.now(), speed * Vec3(2, -1, 2) / 3); };
    // Its derivative is v^2 / 2 up to a speed of 2 m/s and v beyond.
    CHECK(of(0) == 0);
    CHECK(of(1) == Approx(1.0 / 6).epsilon(1e-14));
    CHECK(of(2) == Approx(4.0 / 3).epsilon(1e-14));
    CHECK(of(3) == Approx(4.0 / 3 + 2.5).epsilon(1e-14));
}

TEST_CASE("a field's strength is that of where the step ends, however far it goes") {
    // A point-like body of 1000 kg/m^3 at 1 m flies off at 30 m/s through drag that falls with the square of the
    // distance: at the end of a step of backward Euler rho (v - 30) / h = -D v / x^2.
    const double h = 0.02, density = 1000, d = 5e4, start = 1, speed = 30;
    TetMesh mesh = regular_tet(1e-4);
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : mesh.vertices) middle += 0.25 * p;
    for (Vec3& p : mesh.vertices) p += Vec3(start, 0, 0) - middle;
    for (const ElementKind kind : kinds) {
        Trial t(mesh, ElasticLaw::neo_hookean, kind, nowhere, material(1e6, 0.3, density));
        t.use_backward_euler(h);
        const TestField mud = TestField(FieldKind::drag, d).falling(2, 1);
        t.description.parts.push_back(mud.part());
        t.in.parts.push_back(mud.numbers());
        t.start();
        for (std::size_t i = 0; i < t.state.v.size(); i += 3) t.state.v[i] = speed;
        REQUIRE(t.step());
        double low = 0, high = speed; // v, by bisection
        for (int i = 0; i < 100; ++i) {
            const double v = 0.5 * (low + high), x = start + h * v;
            (density * (v - speed) / h + d * v / (x * x) > 0 ? high : low) = v;
        }
        CHECK(t.state.v[0] == Approx(low).epsilon(1e-3));
        CHECK(low < 0.8 * speed);
    }
}
