// Cloth against closed forms. Derivatives, threads, saving and allocations: term_checks_test.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/cloth/cloth.h"

#include "solver/error.h"
#include "solver/integrate/standing_form.h"
#include "solver/mesh/primitives.h"
#include "solver/terms/cloth/check_cloth.h"
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"
#include "tests/support/sheets.h"
#include "tests/support/term_checks.h"

#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace sinew::test {

namespace {

/// A wavy sheet in two layers that moving loads deform.
ExampleScene wavy(bool held, double damping, int fineness) {
    Sheet sheet = make_sheet(evenly(0, 0.3, 4 * fineness), 0.2, 3 * fineness, Weave::crossed);
    for (Vec3& p : sheet.points) p.z() = 0.03 * std::sin(20 * p.x()) + 0.02 * std::cos(15 * p.y());
    auto rest = cloth(sheet.points, sheet.triangles, {1, 0.3, 0});
    rest->layer_weights.emplace_back();
    for (const Vec3& p : sheet.points) rest->layer_weights[1].push_back(p.x() / 0.3);
    if (held) rest->fixed_vertices = sheet.columns.front();
    auto scene = std::make_shared<const Scene>(SceneDescription{.bodies = {rest}, .attachments = {}, .parts = {}});
    return {scene, [scene, damping](int step) {
                StepInputs in = still_inputs();
                ClothInputs values = cloth_material(500, 80, 0.05, 0.2);
                values.layers.push_back({300, 200, 0.2, 0.4, 0.8, 1.1});
                values.rest_scale_envelope = 0.2 * step;
                values.forces.assign(scene->vertex_count(0), Vec3(0.002, 0.001 * step, 0.01));
                in.stiffness_damping = damping;
                in.bodies = {values};
                return in;
            }};
}

} // namespace

std::vector<TermExample> cloth_examples() {
    std::vector<TermExample> out;
    for (const auto& [name, held, damping] : {std::tuple{"cloth that flies", false, 0.0},
                                              {"cloth that is braked", false, 0.01},
                                              {"held cloth", true, 0.01}}) {
        TermExample e;
        e.name = name, e.type = &cloth_type;
        e.make = [held = held, damping = damping](int fineness) { return wavy(held, damping, fineness); };
        e.forces_cancel = e.torques_cancel = !held;
        e.projects_exactly = false; // it leaves out how angles bend
        out.push_back(std::move(e));
    }
    return out;
}

} // namespace sinew::test

namespace {

constexpr Weave weaves[] = {Weave::diagonal, Weave::crossed, Weave::bricks};

/// A scene of one cloth on its way.
struct ClothScene {
    std::shared_ptr<ClothRest> rest;
    StepInputs in = still_inputs();
    std::vector<Part> parts = {};
    std::shared_ptr<const Scene> scene = {};
    std::unique_ptr<Workspace> workspace = {};
    State state = {};

    void start() {
        scene = std::make_shared<const Scene>(SceneDescription{{rest}, {}, parts});
        workspace = std::make_unique<Workspace>(scene);
        state = initial_state(*scene, in);
    }
    void settle(int steps, double step_size = 1) {
        in.step_size = step_size;
        for (int i = 0; i < steps; ++i) {
            state = advance(*workspace, state, {&in, 1});
            REQUIRE(state.record.converged);
        }
    }
    Vec3 at(int v) const { return position(state, v); }
};

/// Energy of a sheet whose vertices are where `place` takes them.
double energy_of(const std::shared_ptr<ClothRest>& rest, const ClothInputs& values,
                 const std::function<Vec3(const Vec3&)>& place) {
    const Scene scene({{rest}, {}, {}});
    StepInputs in = still_inputs();
    in.bodies = {values};
    const State state = initial_state(scene, in);
    Cloth term(scene);
    term.take(in, state);
    ImplicitForm form;
    standing_form(state, form);
    term.begin_stage({in, state, form, state.bones});
    Positions x;
    for (const Vec3& p : rest->surface) {
        const Vec3 q = place(p);
        x.insert(x.end(), q.data(), q.data() + 3);
    }
    return term.energy(x, false);
}

std::string code_of(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& e) {
        return e.code;
    }
    return "";
}

} // namespace

TEST_CASE("cloth: energies of even stretch, shear and their mixture are the closed ones on every mesh") {
    const double ks = 700, s = 90;
    for (const Weave weave : weaves)
        for (const int cells : {2, 5}) {
            const Sheet sheet = make_sheet(evenly(0, 0.4, 2 * cells), 0.3, cells, weave);
            const auto rest = cloth(sheet.points, sheet.triangles);
            for (const auto& [u, v] : {std::pair{Vec3(1.1, 0, 0), Vec3(0, 1, 0)},
                                       {Vec3(1, 0, 0), Vec3(0.3, 1, 0)},
                                       {Vec3(0.9, 0.1, 0.2), Vec3(-0.3, 1.2, 0.4)},
                                       {Vec3(0, 0, -1), Vec3(0, -1, 0)}}) {
                const auto place = [&](const Vec3& p) { return Vec3(p.x() * u + p.y() * v); };
                const double expected =
                    0.4 * 0.3 *
                    (ks / 2 * (std::pow(u.norm() - 1, 2) + std::pow(v.norm() - 1, 2)) + s / 2 * std::pow(u.dot(v), 2));
                CHECK(energy_of(rest, cloth_material(ks, s, 0.5, 1), place) ==
                      Approx(expected).epsilon(1e-9).margin(1e-12));
            }
        }
}

TEST_CASE("cloth: angles of packs are those of the C library") {
    for (int i = -4000; i <= 4000; i += lanes) {
        Pack x, y;
        for (int l = 0; l < lanes; ++l) {
            const double angle = M_PI * (i + l) / 4000, length = std::exp2((i + l) % 37);
            x.v[l] = length * std::cos(angle), y.v[l] = length * std::sin(angle);
        }
        const Pack got = atan2(y, x);
        for (int l = 0; l < lanes; ++l) {
            const double right = std::atan2(y[l], x[l]);
            INFO(y[l] << " " << x[l]);
            CHECK(std::abs(got[l] - right) <= 5e-16 * std::abs(right));
        }
    }
    const Pack edges = atan2(Pack(Pack::Vector{0, 0, 2, -2}), Pack(Pack::Vector{0, -3, 0, 0}));
    CHECK(edges[0] == 0);
    CHECK(edges[1] == M_PI);
    CHECK(edges[2] == M_PI / 2);
    CHECK(edges[3] == -M_PI / 2);
}

TEST_CASE("cloth: a picture frame's moment is that of the closed form") {
    const double s = 120, length = 0.25;
    for (const Weave weave : weaves) {
        const Sheet sheet = make_sheet(evenly(0, length, 4), length, 4, weave);
        const auto rest = cloth(sheet.points, sheet.triangles);
        const auto energy = [&](double angle) {
            return energy_of(rest, cloth_material(500, s, 0, 1), [&](const Vec3& p) {
                return Vec3(p.x() + std::sin(angle) * p.y(), std::cos(angle) * p.y(), 0);
            });
        };
        const double angle = M_PI / 6, step = 1e-4;
        const double moment = (energy(angle + step) - energy(angle - step)) / (2 * step);
        CHECK(moment == Approx(s * length * length * std::sin(angle) * std::cos(angle)).epsilon(1e-6));
    }
}

TEST_CASE("cloth: a sheet bent to a cylinder has the energy of its curvature") {
    const double d = 0.02, radius = 0.2;
    for (const Weave weave : {Weave::diagonal, Weave::crossed})
        for (const int cells : {16, 32}) {
            const Sheet sheet = make_sheet(evenly(0, 0.4, cells), 0.1, 3, weave);
            const auto rest = cloth(sheet.points, sheet.triangles);
            const double energy = energy_of(rest, cloth_material(500, 50, d, 1), [&](const Vec3& p) {
                // Vertices on the arc of their chords' lengths, so that nothing stretches.
                const double h = 0.4 / cells, half = std::asin(h / (2 * radius));
                const double angle = 2 * half * p.x() / h;
                return Vec3(radius * std::sin(angle), p.y(), radius * (1 - std::cos(angle)));
            });
            // Hinges stand for the arc but for half a cell at either end.
            const double expected = d / 2 / (radius * radius) * 0.1 * (0.4 - 0.4 / cells);
            CHECK(energy == Approx(expected).epsilon(0.01));
        }
}

TEST_CASE("cloth: a strip that is pulled stretches by force over stiffness and width, and grows no narrower") {
    for (const Weave weave : weaves) {
        Sheet sheet = make_sheet(evenly(0, 0.5, 10), 0.1, 2, weave);
        ClothScene s{cloth(sheet.points, sheet.triangles)};
        s.rest->fixed_vertices = sheet.columns[0];
        std::sort(s.rest->fixed_vertices.begin(), s.rest->fixed_vertices.end());
        ClothInputs values = cloth_material(400, 60, 1e-4, 0.1);
        values.forces.assign(sheet.points.size(), Vec3::Zero());
        const double force = 8; // over the end's edge, half as much at its corners
        for (std::size_t j = 0; j < 3; ++j)
            values.forces[std::size_t(sheet.columns.back()[j])] = Vec3(force / 2 * (j == 1 ? 1 : 0.5), 0, 0);
        s.in.bodies = {values};
        s.start();
        s.settle(30);
        CHECK(s.at(sheet.columns.back()[0]).x() == Approx(0.5 * (1 + force / (400 * 0.1))).epsilon(1e-6));
        CHECK(s.at(sheet.columns[5][2]).y() == Approx(0.1).epsilon(1e-6));
        CHECK(value_of(s.state.record.measured, "cloth", "max_stretch_percent") == Approx(20).epsilon(1e-5));
    }
}

TEST_CASE("cloth: a hanging strip sags as the elastic catenary, on two meshes and in all weaves") {
    // Values of the catalogue: length 1.2 m between ends 1 m apart, 0.3 kg/m^2, tensile stiffness 500 N/m.
    constexpr double sag = 0.29565809;
    for (const Weave weave : weaves) {
        double before = 1;
        for (const int cells : {12, 24}) {
            // Modelled as a polygon on a circle, each side as long as it is at rest.
            double low = 1e-6, high = 2 * M_PI / cells;
            const double side = 1.2 / cells;
            for (int i = 0; i < 100; ++i) {
                const double turn = 0.5 * (low + high);
                (side * std::sin(cells * turn / 2) / std::sin(turn / 2) > 1 ? low : high) = turn;
            }
            Sheet sheet = make_sheet(evenly(0, 1.2, cells), 0.1, 2, weave);
            const Points flat = sheet.points;
            for (Vec3& p : sheet.points) {
                const double k = p.x() / side, whole = std::min<double>(std::floor(k + 1e-9), cells - 1);
                const auto corner = [&](double i) {
                    const double r = side / (2 * std::sin(low / 2)), a = low * (i - cells / 2.0);
                    return Vec3(r * std::sin(a), 0, r * (std::cos(cells * low / 2) - std::cos(a)));
                };
                p = corner(whole) + (k - whole) * (corner(whole + 1) - corner(whole)) + Vec3(0.5, p.y(), 0);
            }
            ClothScene s{cloth(sheet.points, sheet.triangles)};
            s.rest->fixed_vertices = sheet.columns.front();
            s.rest->fixed_vertices.insert(s.rest->fixed_vertices.end(), sheet.columns.back().begin(),
                                          sheet.columns.back().end());
            std::sort(s.rest->fixed_vertices.begin(), s.rest->fixed_vertices.end());
            s.in.bodies = {cloth_material(500, 50, 0, 0.3)};
            s.in.gravity = Vec3(0, 0, -9.81);
            s.start();
            s.settle(40, 0.2);
            double deepest = 0;
            for (std::size_t v = 0; v < flat.size(); ++v) deepest = std::max(deepest, -s.at(int(v)).z());
            INFO("weave " << int(weave) << ", cells " << cells << ", sag " << deepest);
            const double off = std::abs(deepest / sag - 1);
            CHECK(off < 0.03);
            CHECK(off < before);
            before = off;
        }
    }
}

TEST_CASE("cloth: a clamped strip hangs as the elastica under its weight, on two meshes in two weaves") {
    // q L^3/D = 5: the tip at (0.846657, -0.495905) L.
    constexpr double x_tip = 0.846657, z_tip = -0.495905, density = 0.1, gravity = 9.8;
    for (const Weave weave : {Weave::diagonal, Weave::bricks}) {
        double before = 1;
        for (const int cells : {10, 20}) {
            // The first two columns are held, half a cell to either side of the clamp: the hinge at the second stands
            // for the first whole cell.
            const double h = 1 / (cells - 0.5);
            Sheet sheet = make_sheet(evenly(-0.5 * h, 1, cells), 0.2, 4, weave);
            ClothScene s{cloth(sheet.points, sheet.triangles)};
            for (const int c : {0, 1})
                s.rest->fixed_vertices.insert(s.rest->fixed_vertices.end(), sheet.columns[std::size_t(c)].begin(),
                                              sheet.columns[std::size_t(c)].end());
            std::sort(s.rest->fixed_vertices.begin(), s.rest->fixed_vertices.end());
            s.in.bodies = {cloth_material(5e3, 500, density * gravity / 5, density)};
            s.in.gravity = Vec3(0, 0, -gravity);
            s.start();
            s.settle(40, 0.2);
            const Vec3 tip = s.at(sheet.columns.back()[2]);
            INFO("weave " << int(weave) << ", cells " << cells << ", tip " << tip.transpose());
            const double off = std::hypot(tip.x() - x_tip, tip.z() - z_tip);
            CHECK(off < 0.03);
            CHECK(off < before);
            before = off;
        }
    }
}

TEST_CASE("cloth: a hinge folded beyond 120 degrees opens again, however thin and stiff the sheet is") {
    for (const double bend : {1e-5, 1e2}) {
        Sheet sheet = make_sheet(evenly(0, 0.2, 2), 0.1, 1, Weave::diagonal);
        ClothScene s{cloth(sheet.points, sheet.triangles)};
        s.in.bodies = {cloth_material(5e3, 500, bend, 0.1)};
        s.in.stiffness_damping = 0.01;
        s.start();
        const double angle = 170 * M_PI / 180;
        for (const int v : sheet.columns[2])
            set_position(s.state, v,
                         Vec3(0.1 + 0.1 * std::cos(angle), sheet.points[std::size_t(v)].y(), 0.1 * std::sin(angle)));
        double fold = angle;
        s.in.step_size = bend > 1 ? 1e-3 : 0.05;
        for (int i = 0; i < 400 && fold > 0.01; ++i) {
            s.state = advance(*s.workspace, s.state, {&s.in, 1});
            REQUIRE(s.state.record.converged);
            fold = value_of(s.state.record.measured, "cloth", "max_fold_rad");
        }
        CHECK(fold < 0.1);
    }
}

TEST_CASE("cloth: the energy of a fold goes on where it is folded through itself") {
    Sheet sheet = make_sheet(evenly(0, 0.2, 2), 0.1, 1, Weave::diagonal);
    const auto rest = cloth(sheet.points, sheet.triangles);
    const Scene scene({{rest}, {}, {}});
    const auto folded = [&](double degrees) {
        const double angle = degrees * M_PI / 180;
        Positions x;
        for (const Vec3& p : sheet.points) {
            const Vec3 q = p.x() > 0.15 ? Vec3(0.1 + 0.1 * std::cos(angle), p.y(), 0.1 * std::sin(angle)) : p;
            x.insert(x.end(), q.data(), q.data() + 3);
        }
        return x;
    };
    for (const double damping : {0.0, 0.01})
        for (const double from : {179.0, -179.0}) {
            StepInputs in = still_inputs();
            in.bodies = {cloth_material(500, 100, 0.01, 0.2)};
            in.stiffness_damping = damping;
            State state = initial_state(scene, in);
            state.x = folded(from);
            Cloth term(scene);
            term.take(in, state);
            ImplicitForm form;
            standing_form(state, form);
            form.velocity_factor = damping > 0 ? 10 : 0;
            form.strain = {.x = &state.x};
            term.begin_stage({in, state, form, state.bones});
            // By the square of the angle, of what brakes by that since the start.
            const double bends = term.energy(folded(from), false), share = 10 * damping;
            const double to = from > 0 ? 183 : -183;
            const double expected = bends * (to * to + share * 16) / (from * from);
            CHECK(term.energy(folded(to), false) == Approx(expected).epsilon(1e-9));
        }
}

TEST_CASE("cloth: a flap that is folded through the sheet that it hangs on converges at every step") {
    Sheet sheet = make_sheet(evenly(0, 0.2, 2), 0.1, 1, Weave::diagonal);
    ClothScene s{cloth(sheet.points, sheet.triangles)};
    for (const int c : {0, 1})
        s.rest->fixed_vertices.insert(s.rest->fixed_vertices.end(), sheet.columns[std::size_t(c)].begin(),
                                      sheet.columns[std::size_t(c)].end());
    std::sort(s.rest->fixed_vertices.begin(), s.rest->fixed_vertices.end());
    ClothInputs values = cloth_material(5e3, 500, 0.01, 0.1);
    values.forces.assign(sheet.points.size(), Vec3(0, 0, -1));
    s.in.bodies = {values};
    s.in.stiffness_damping = 0.01;
    s.start();
    const double angle = 170 * M_PI / 180;
    for (const int v : sheet.columns[2])
        set_position(s.state, v,
                     Vec3(0.1 + 0.1 * std::cos(angle), sheet.points[std::size_t(v)].y(), 0.1 * std::sin(angle)));
    s.settle(200, 0.01);
    // It hangs from the other side, by the force over its stiffness.
    CHECK(s.at(sheet.columns[2][0]).z() < -0.09);
    CHECK(value_of(s.state.record.measured, "cloth", "max_fold_rad") < 2);
}

TEST_CASE("cloth: a sheet ten thousand times as long as it is thick bends as beam theory says") {
    // D = k t^2/12 with t = 1e-4 lengths; the load sags it by a twentieth: q L^4/(8 D).
    const double k = 1e6, d = k * 1e-8 / 12, sag = 0.05, load = 8 * d * sag, density = 1e-4;
    const int cells = 20;
    const double h = 1 / (cells - 0.5);
    Sheet sheet = make_sheet(evenly(-0.5 * h, 1, cells), 0.2, 4, Weave::diagonal);
    ClothScene s{cloth(sheet.points, sheet.triangles)};
    for (const int c : {0, 1})
        s.rest->fixed_vertices.insert(s.rest->fixed_vertices.end(), sheet.columns[std::size_t(c)].begin(),
                                      sheet.columns[std::size_t(c)].end());
    std::sort(s.rest->fixed_vertices.begin(), s.rest->fixed_vertices.end());
    s.in.bodies = {cloth_material(k, 0.1 * k, d, density)};
    s.in.gravity = Vec3(0, 0, -load / density);
    s.in.max_newton_iterations = 200;
    s.start();
    s.settle(80, 0.05);
    CHECK(-s.at(sheet.columns.back()[2]).z() == Approx(sag).epsilon(0.03));
}

TEST_CASE("cloth: crumpled vertices come back to a flat sheet") {
    Sheet sheet = make_sheet(evenly(0, 0.4, 8), 0.3, 6, Weave::diagonal);
    ClothScene s{cloth(sheet.points, sheet.triangles)};
    s.rest->fixed_vertices = sheet.columns[0]; // two columns: one alone would leave it free to turn about it
    s.rest->fixed_vertices.insert(s.rest->fixed_vertices.end(), sheet.columns[1].begin(), sheet.columns[1].end());
    std::sort(s.rest->fixed_vertices.begin(), s.rest->fixed_vertices.end());
    s.in.bodies = {cloth_material(500, 100, 0.01, 0.2)};
    s.in.stiffness_damping = 0.02;
    s.start();
    unsigned seed = 7;
    const auto random = [&] { return (seed = seed * 1664525u + 1013904223u) / 4294967296.0 - 0.5; };
    for (std::size_t v = 0; v < sheet.points.size(); ++v)
        if (sheet.points[v].x() > 0.06)
            set_position(s.state, int(v), sheet.points[v] + 0.08 * Vec3(random(), random(), random()));
    for (int i = 0; i < 300; ++i) {
        s.in.step_size = i < 100 ? 0.01 : 0.1;
        s.state = advance(*s.workspace, s.state, {&s.in, 1});
    }
    REQUIRE(s.state.record.converged);
    for (std::size_t v = 0; v < sheet.points.size(); ++v) CHECK((s.at(int(v)) - sheet.points[v]).norm() < 1e-3);
}

TEST_CASE("cloth: a free sheet of another rest scale has its shape at that scale, and no stress") {
    const SurfaceMesh ball = make_sphere(0.1, 12, 10);
    ClothScene s{cloth(ball.points, ball.triangles)};
    ClothInputs values = cloth_material(500, 100, 1e-2, 0.1);
    values.layers[0].rest_scale = 0.8, values.rest_scale_envelope = -1;
    s.in.bodies = {values};
    s.start();
    s.settle(60, 0.2);
    for (std::size_t v = 0; v < ball.points.size(); ++v)
        CHECK((s.at(int(v)) - ball.points[v] / 0.8).norm() < 1e-4 * 0.1);
    CHECK(s.state.record.energy < 1e-8);
}

TEST_CASE("cloth: a ball of cloth under pressure has the tension of Laplace's law") {
    // Tension by width as it is now, k e/(1 + e) = p R/2 with R = R_0 (1 + e); surface tension g holds against 2 g/R.
    const double radius = 0.1, k = 500;
    const SurfaceMesh ball = make_sphere(radius, 40, 40);
    const auto part = [](const TermType& type, double value) {
        auto layers = std::make_shared<SurfaceLayers>();
        layers->layers.push_back({value, {}});
        return Part{&type, {0}, layers};
    };
    // By the volume inside, against that of the mesh.
    const double volume = enclosed_volume(ball.points, ball.triangles);
    const auto growth = [&](const ClothScene& s) {
        return std::cbrt(value_of(s.state.record.measured, "pressure", "volume_m3") / volume) - 1;
    };
    ClothScene blown{cloth(ball.points, ball.triangles)};
    blown.in.bodies = {cloth_material(k, 100, 1e-6, 0.1)};
    const double p = 400;
    blown.parts = {part(pressure_type, -p)};
    blown.in.parts = {{1}};
    blown.start();
    blown.settle(20, 0.1);
    const double a = p * radius / (2 * k), strain = (1 - std::sqrt(1 - 4 * a)) / (2 * a) - 1;
    CHECK(growth(blown) == Approx(strain).epsilon(0.01));

    ClothScene soap{cloth(ball.points, ball.triangles)};
    soap.in.bodies = {cloth_material(k, 100, 1e-6, 0.1)};
    soap.parts = {part(pressure_type, -p), part(surface_tension_type, p * radius / 2)};
    soap.in.parts = {{1}, {1}};
    soap.start();
    soap.settle(20, 0.1);
    CHECK(growth(soap) == Approx(0).margin(0.02 * strain));
}

TEST_CASE("cloth: it falls like anything else, and weighs its area times its density") {
    const Sheet sheet = make_sheet(evenly(0, 0.4, 4), 0.2, 2, Weave::crossed);
    ClothScene s{cloth(sheet.points, sheet.triangles)};
    s.in.bodies = {cloth_material(500, 100, 1e-3, 0.3)};
    s.in.gravity = Vec3(0, -9.8, 0);
    s.start();
    s.settle(10, 0.01);
    const double fallen = 9.8 * 1e-4 * 10 * 11 / 2; // backward Euler
    for (std::size_t v = 0; v < sheet.points.size(); ++v)
        CHECK((s.at(int(v)) - sheet.points[v] + Vec3(0, fallen, 0)).norm() < 1e-9);
}

TEST_CASE("cloth: what cannot be simulated is refused by name") {
    const Sheet sheet = make_sheet(evenly(0, 1, 2), 1, 2, Weave::diagonal);
    const auto code = [](const std::shared_ptr<ClothRest>& rest) {
        return code_of([&] { Scene scene({{rest}, {}, {}}); });
    };
    const auto changed = [&](const std::function<void(ClothRest&)>& change) {
        auto rest = cloth(sheet.points, sheet.triangles);
        change(*rest);
        return code(rest);
    };
    CHECK(changed([](ClothRest&) {}).empty());
    CHECK(changed([](ClothRest& c) { c.triangles.clear(); }) == "FE201");
    CHECK(changed([](ClothRest& c) { c.surface[0].x() = NAN; }) == "FE202");
    CHECK(changed([](ClothRest& c) { c.triangles[0][0] = 99; }) == "FE203");
    CHECK(changed([](ClothRest& c) { c.layer_weights[0].pop_back(); }) == "FE204");
    CHECK(changed([](ClothRest& c) { c.layer_weights.clear(); }) == "FE206");
    CHECK(changed([](ClothRest& c) {
              c.surface.emplace_back(0, 0, 1), c.layer_weights[0].push_back(1);
              c.triangles.push_back({0, 1, 9}), c.triangles.push_back({0, 1, 8});
              c.warp.resize(c.triangles.size(), Vec3(1, 0, 0));
          }) == "FE270");
    CHECK(changed([](ClothRest& c) { c.surface.emplace_back(0, 0, 1), c.layer_weights[0].push_back(1); }) == "FE271");
    CHECK(changed([](ClothRest& c) { c.surface[1] = c.surface[0]; }) == "FE272");

    const auto values = [](const std::function<void(ClothInputs&)>& change) {
        ClothInputs in = cloth_material(500, 50, 1e-3, 0.1);
        change(in);
        return code_of([&] { check_cloth_values(in, 0); });
    };
    CHECK(values([](ClothInputs&) {}).empty());
    CHECK(values([](ClothInputs& c) { c.layers[0].shear_stiffness = -1; }) == "FE273");
    CHECK(values([](ClothInputs& c) { c.layers[0].mass_density = 0; }) == "FE273");
    CHECK(values([](ClothInputs& c) { c.layers[0].bend_stiffness = NAN; }) == "FE304");
    CHECK(values([](ClothInputs& c) { c.layers[0].rest_scale = 0; }) == "FE247");
    CHECK(values([](ClothInputs& c) { c.layers[0].rest_scale = 1e-3 * (1 - 1e-9); }) == "FE247");
    CHECK(values([](ClothInputs& c) { c.layers[0].rest_scale = 11, c.rest_scale_envelope = 3; }) == "FE247");
}
