// Material layers that closed meshes bound, 1:1000, against exact solutions and fitted meshes.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/elastic_point.h"
#include "solver/material/principal.h"
#include "solver/mesh/harmonic.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/layer_border.h"
#include "solver/meshing/layer_place.h"
#include "solver/newton/potential.h"
#include "tests/support/lattice_body.h"

#include <cmath>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

constexpr ElementKind kinds[] = {ElementKind::linear, ElementKind::quadratic};
constexpr double soft = 1e5, stiff = 1e8;

TissueInputs two_layers(double nu) {
    TissueInputs in = material(soft, nu);
    in.layers.push_back(in.layers[0]);
    in.layers[1].youngs_modulus = stiff;
    in.layers[1].mass_density = 3000;
    return in;
}

/// A block turned by 30 degrees about two axes against the lattice, with a second layer in a box given in its own
/// coordinates.
struct Composite : LatticeBody {
    RotatedBox box;
    Composite(const Vec3& size, int points, double tet_size, ElasticLaw law, ElementKind element, double nu)
        : LatticeBody(RotatedBox(size, 30, 30).surface(1), RotatedBox(size, 30, 30).surface(points), tet_size, law,
                      element, two_layers(nu))
        , box(size, 30, 30) {}
    void fill(const Vec3& low, const Vec3& high) {
        RotatedBox inner = box;
        inner.size = high - low;
        SurfaceMesh place = inner.surface(1);
        for (Vec3& p : place.points) p += box.at(low);
        const SurfaceMesh skin = box.surface(1);
        const Solid solid = make_layer_place(place.points, place.triangles);
        const FittedTets fitted = fit_to_borders(rest->tets, {&solid}, skin.points, skin.triangles);
        rest->tets = fitted.mesh;
        rest->embedding = embed(rest->tets, rest->surface);
        rest->layer_weights = {std::vector<double>(rest->tets.tets.size(), 1.0),
                               fitted_shares(fitted, 0, solid, skin.points, skin.triangles)};
    }
    /// 1 on the vertices inside, as painted, and carried into the volume.
    void paint(const Vec3& low, const Vec3& high) {
        std::vector<double> map;
        for (const Vec3& p : rest->surface) {
            const Vec3 l = box.local(p);
            map.push_back((l.array() > low.array()).all() && (l.array() < high.array()).all() ? 1 : 0);
        }
        const auto fields = harmonic_extensions(rest->tets, {rest->surface, triangles, rest->embedding}, {map},
                                                std::vector<char>(map.size(), 1));
        rest->layer_weights.push_back(tet_means(rest->tets, fields[0]));
    }
};

/// Energy of an affine motion, and its gradient, with nothing held.
struct Affine {
    double energy;
    std::vector<double> gradient;
    Affine(Composite& body, const Mat3& f) {
        body.start();
        Potential potential(*body.scene);
        ImplicitForm form;
        quasi_static_form(body.state, form);
        potential.take(body.state, body.in);
        potential.begin_step(body.state, body.in);
        potential.begin_stage(body.state, form, body.state.bones);
        std::vector<double> x = body.state.x;
        for (std::size_t i = 0; i < x.size(); i += 3) {
            const Vec3 p = f * Vec3(x[i], x[i + 1], x[i + 2]);
            std::copy_n(p.data(), 3, x.begin() + static_cast<std::ptrdiff_t>(i));
        }
        energy = potential.evaluate(x, &gradient, nullptr);
    }
};

/// Stretch along the bar's own x.
Mat3 stretch(const RotatedBox& box, double e) {
    Mat3 f = Mat3::Identity();
    f(0, 0) += e;
    return box.turn * f * box.turn.transpose();
}

/// Elongation over the exact one, less 1, of a bar whose middle is stiff.
double error_in_series(double tet_size, ElementKind element, bool painted) {
    const double length = 0.4, low = 0.13, high = 0.24, traction = 10;
    Composite bar({length, 0.1, 0.1}, 64, tet_size, ElasticLaw::corotational, element, 0);
    if (painted)
        bar.paint({low, -1, -1}, {high, 1, 1});
    else
        bar.fill({low, -1, -1}, {high, 1, 1});
    const auto at = [&](double x) {
        return [&bar, x](const Vec3& p) { return std::abs(bar.box.local(p).x() - x) < 1e-9; };
    };
    bar.hold(at(0), 1e9);
    bar.start();
    bar.pull(at(length), bar.box.turn * Vec3(traction, 0, 0));
    bar.solve();
    const Vec3 longer = bar.mean_displacement(at(length)) - bar.mean_displacement(at(0));
    const double exact = traction * ((length - (high - low)) / soft + (high - low) / stiff);
    return (bar.box.turn.transpose() * longer).x() / exact - 1;
}

/// Work of a pull at the top of a cube that stands fast, per square of the traction, times the soft modulus [m^3]; with
/// a stiff cube in its middle.
double compliance(double inner, double tet_size, ElementKind element) {
    const double traction = 10, low = (1 - inner) / 2, high = (1 + inner) / 2;
    Composite cube({1, 1, 1}, 24, tet_size, ElasticLaw::corotational, element, 0.3);
    cube.fill({low, low, low}, {high, high, high});
    cube.hold([&](const Vec3& p) { return cube.box.local(p).z() < 1e-9; }, 1e10);
    cube.start();
    cube.pull([&](const Vec3& p) { return cube.box.local(p).z() > 1 - 1e-9; }, cube.box.turn * Vec3(0, 0, traction));
    const State rest = cube.state;
    cube.solve();
    const Points& loads = cube.values().forces;
    double work = 0;
    for (std::size_t v = 0; v < loads.size(); ++v)
        work += loads[v].dot(position(cube.state, static_cast<int>(v)) - position(rest, static_cast<int>(v)));
    return work / (traction * traction) * soft;
}

} // namespace

TEST_CASE("layers side by side: an affine stretch has the energy of the volumes, and linear tets are at rest in it",
          "[layers]") {
    // A plate of 38 mm in a bar of 100 x 100 mm; St. Venant and Kirchhoff without Poisson's ratio: E/2 (e + e^2/2)^2.
    const double e = 0.01, strain = e + e * e / 2, mean = soft + 0.38 * (stiff - soft);
    for (const ElementKind element : kinds)
        for (const double size : {0.1, 0.05}) {
            CAPTURE(static_cast<int>(element), size);
            Composite bar({0.4, 0.1, 0.1}, 1, size, ElasticLaw::stvk, element, 0);
            bar.fill({-1, -1, 0.023}, {2, 2, 0.061});
            const Affine stretched(bar, stretch(bar.box, e));
            CHECK(stretched.energy == Approx(0.5 * strain * strain * mean * 0.004).epsilon(2e-4));
            if (element == ElementKind::quadratic) continue; // a tet's own gradients of strain meet its mean modulus
            // Far from the ends nothing pulls, whatever tets plate and skin cut.
            double worst = 0;
            for (std::size_t u = 0; u < stretched.gradient.size() / 3; ++u) {
                const Vec3 p = position(bar.state, bar.scene->numbering().vertex_of_unknown[u]);
                if (std::abs(bar.box.local(p).x() - 0.2) > 0.2 - 1.01 * size) continue;
                worst = std::max(
                    worst, Vec3(stretched.gradient[3 * u], stretched.gradient[3 * u + 1], stretched.gradient[3 * u + 2])
                               .norm());
            }
            CHECK(worst < 1e-3 * stiff * strain * size * size);
        }
}

TEST_CASE("layers weigh what their volumes do", "[layers]") {
    for (const ElementKind element : kinds) {
        Composite bar({0.4, 0.1, 0.1}, 1, 0.07, ElasticLaw::stvk, element, 0.3);
        bar.fill({0.1, -1, -1}, {0.3, 1, 1});
        bar.in.gravity = Vec3(0, 0, -10);
        const Affine still(bar, Mat3::Identity());
        double weight = 0;
        for (std::size_t u = 0; u < still.gradient.size() / 3; ++u) weight += still.gradient[3 * u + 2] / 10;
        CHECK(weight == Approx(0.01 * (0.2 * 1000 + 0.2 * 3000)).epsilon(2e-4));
    }
}

TEST_CASE("two layers, each with its own strain and one traction between them, are at rest: all laws", "[layers]") {
    // F2 = F1 + a n^T with P1 n = P2 n: what a laminate does, far from small strains.
    const SurfaceMesh cube = RotatedBox({1, 1, 1}, 0, 0).surface(1);
    const RotatedBox half({4, 4, 4}, 30, 30);
    SurfaceMesh place = half.surface(1);
    const Vec3 on(0.5, 0.52, 0.47), n = half.turn.col(0);
    for (Vec3& p : place.points) p += on - half.at({0, 2, 2});
    const Solid solid = make_layer_place(place.points, place.triangles);
    const FittedTets fitted = fit_to_borders(box_mesh({1, 1, 1}, 4, 4, 4), {&solid}, cube.points, cube.triangles);
    const double nu = 0.3, moduli[2] = {soft, 10 * soft};
    Mat3 f1;
    f1 << 1.1, 0.05, -0.1, 0.02, 0.95, 0.1, -0.04, 0.08, 1.2;
    for (const ElasticLaw law :
         {ElasticLaw::stvk, ElasticLaw::neo_hookean, ElasticLaw::log_neo_hookean, ElasticLaw::corotational})
        for (const ElementKind element : kinds) {
            CAPTURE(static_cast<int>(law), static_cast<int>(element));
            double energy[2];
            const auto traction = [&](const Mat3& f, int layer) -> Vec3 {
                const Lame l = lame(moduli[layer], nu);
                double rows[9], p[9];
                for (int i = 0; i < 9; ++i) rows[i] = f(i / 3, i % 3);
                elastic_stress(law, l.mu, l.lambda, 0, rows, p, &energy[layer]);
                return Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(p) * n;
            };
            Vec3 a = Vec3::Zero();
            const auto gap = [&](const Vec3& jump) -> Vec3 {
                return traction(f1 + jump * n.transpose(), 1) - traction(f1, 0);
            };
            for (int step = 0; step < 30; ++step) {
                Mat3 slope;
                for (int c = 0; c < 3; ++c)
                    slope.col(c) = (gap(a + 1e-6 * Vec3::Unit(c)) - gap(a - 1e-6 * Vec3::Unit(c))) / 2e-6;
                a -= slope.inverse() * gap(a);
            }
            REQUIRE(gap(a).norm() < 1e-8 * soft);
            REQUIRE(a.norm() > 0.05);

            const auto rest = tissue(fitted.mesh, law);
            rest->element = element;
            rest->layer_weights = {std::vector<double>(fitted.mesh.tets.size(), 1.0),
                                   fitted_shares(fitted, 0, solid, cube.points, cube.triangles)};
            StepInputs in = still_inputs();
            in.integrator = Integrator::quasi_static;
            TissueInputs values = two_layers(nu);
            values.layers[1].youngs_modulus = moduli[1];
            in.bodies = {values};
            SceneDescription description;
            description.bodies = {rest};
            const Scene scene(description);
            const State state = initial_state(scene, in);
            Potential potential(scene);
            ImplicitForm form;
            quasi_static_form(state, form);
            potential.take(state, in);
            potential.begin_step(state, in);
            potential.begin_stage(state, form, state.bones);
            std::vector<double> x = state.x, gradient;
            for (std::size_t i = 0; i < x.size(); i += 3) {
                const Vec3 p(x[i], x[i + 1], x[i + 2]);
                const Vec3 moved = f1 * p + std::max(0.0, n.dot(p - on)) * a;
                std::copy_n(moved.data(), 3, x.begin() + static_cast<std::ptrdiff_t>(i));
            }
            const double total = potential.evaluate(x, &gradient, nullptr);
            double volume[2] = {};
            for (std::size_t t = 0; t < fitted.mesh.tets.size(); ++t) {
                const auto v = [&](std::size_t k) {
                    return fitted.mesh.vertices[static_cast<std::size_t>(fitted.mesh.tets[t][k])];
                };
                volume[rest->layer_weights[1][t] > 0.5] += tet_volume(v(0), v(1), v(2), v(3));
            }
            CHECK(total == Approx(volume[0] * energy[0] + volume[1] * energy[1]).epsilon(1e-9));
            double worst = 0;
            int inner = 0;
            for (std::size_t u = 0; u < gradient.size() / 3; ++u) {
                const Vec3 p = position(state, scene.numbering().vertex_of_unknown[u]);
                if ((p.array() < 1e-9).any() || (p.array() > 1 - 1e-9).any()) continue; // held by what lies outside
                worst = std::max(worst, Vec3(gradient[3 * u], gradient[3 * u + 1], gradient[3 * u + 2]).norm());
                ++inner;
            }
            CHECK(inner > 30);
            CHECK(worst < 1e-8 * soft / 16);
        }
}

TEST_CASE("layers one after another: as long as the exact bar, where paint does not converge", "[layers]") {
    const auto mesh = [](double size, ElementKind element) { return std::abs(error_in_series(size, element, false)); };
    const auto paint = [](double size, ElementKind element) { return error_in_series(size, element, true); };
    CHECK(mesh(0.1, ElementKind::linear) < 0.006);
    CHECK(mesh(0.05, ElementKind::linear) < 0.002);
    CHECK(mesh(0.025, ElementKind::linear) < 0.0005);
    CHECK(mesh(0.1, ElementKind::quadratic) < 0.002);
    CHECK(mesh(0.05, ElementKind::quadratic) < 0.0005);
    CHECK(paint(0.1, ElementKind::linear) == Approx(-0.504).margin(0.01));
    CHECK(paint(0.05, ElementKind::linear) == Approx(-0.354).margin(0.01));
    CHECK(paint(0.025, ElementKind::linear) == Approx(-0.579).margin(0.01));
    CHECK(paint(0.1, ElementKind::quadratic) == Approx(-0.454).margin(0.01));
}

TEST_CASE("a stiff cube in a soft one, beside fitted meshes", "[layers]") {
    // Fitted cubes of 6 quadratic tets: inner side 0.5 with 4, 8, 12, 16 cubes along the edge 0.66803, 0.68701,
    // 0.69213, 0.69438, extrapolated 0.699; inner side 0.25 with 8, 16 0.92197, 0.92601, extrapolated 0.9285.
    CHECK(compliance(0.5, 0.2, ElementKind::quadratic) / 0.699 == Approx(1).margin(0.02));
    CHECK(compliance(0.5, 0.1, ElementKind::quadratic) / 0.699 == Approx(1).margin(0.005));
    CHECK(compliance(0.25, 0.2, ElementKind::quadratic) / 0.9285 == Approx(1).margin(0.01));
    // Linear tets are stiffer wherever strains vary, fitted or not. (The soft cube is what is held, and limits how
    // firmly: as firmly as the stiff one would bear, 0.888 and 0.950.)
    CHECK(compliance(0.5, 0.2, ElementKind::linear) / 0.699 == Approx(0.911).margin(0.01));
    CHECK(compliance(0.5, 0.1, ElementKind::linear) / 0.699 == Approx(0.961).margin(0.01));
    CHECK(compliance(0.25, 0.1, ElementKind::linear) / 0.9285 == Approx(0.985).margin(0.01));
}

namespace {

/// Radial displacement at the surface of a ball of radius 1 m with a core of other stiffness, pulled outwards by 1 % of
/// what makes sense, over the exact one, less 1.
double error_of_ball(double core, double inner, double outer, double tet_size, ElementKind element) {
    const double nu = 0.3, traction = 10, springs = 100;
    const SurfaceMesh skin = make_sphere(1, 64, 48);
    TissueInputs in = material(outer, nu);
    in.layers.push_back(in.layers[0]);
    in.layers[1].youngs_modulus = inner;
    LatticeBody ball(skin, skin, tet_size, ElasticLaw::corotational, element, in);
    const SurfaceMesh place = make_sphere(core, 64, 48);
    const Solid solid = make_layer_place(place.points, place.triangles);
    const FittedTets fitted = fit_to_borders(ball.rest->tets, {&solid}, skin.points, skin.triangles);
    ball.rest->tets = fitted.mesh;
    ball.rest->embedding = embed(ball.rest->tets, ball.rest->surface);
    ball.rest->layer_weights = {std::vector<double>(ball.rest->tets.tets.size(), 1.0),
                                fitted_shares(fitted, 0, solid, skin.points, skin.triangles)};
    ball.hold([](const Vec3&) { return true; }, springs);
    ball.start();
    Points& loads = ball.values().forces;
    loads.assign(ball.scene->vertex_count(0), Vec3::Zero());
    double area = 0, volume = 0;
    for (const Triangle& t : ball.triangles) {
        const auto p = [&](std::size_t c) { return skin.points[static_cast<std::size_t>(t[c])]; };
        const Vec3 normal = 0.5 * (p(1) - p(0)).cross(p(2) - p(0));
        area += normal.norm(), volume += normal.dot(p(0)) / 3;
        for (const int v : t) {
            const PointWeights at = ball.carrier(v);
            for (int k = 0; k < at.count; ++k)
                loads[static_cast<std::size_t>(at.vertex[k])] += traction / 3 * at.weight[k] * normal;
        }
    }
    ball.solve();
    double moved = 0;
    for (const Triangle& t : ball.triangles) {
        const auto p = [&](std::size_t c) { return skin.points[static_cast<std::size_t>(t[c])]; };
        const Vec3 normal = 0.5 * (p(1) - p(0)).cross(p(2) - p(0));
        for (const int v : t) moved += ball.displacement(v).dot(normal) / 3 / area;
    }
    // u = A r inside, B r + C / r^2 outside; radial stress 3 K A inside, 3 K B - 4 mu C / r^3 outside.
    const auto bulk = [&](double e) { return e / (3 * (1 - 2 * nu)); };
    const double mu = outer / (2 * (1 + nu)), a3 = core * core * core;
    // at r = a: A = B + C/a^3; 3 Ki A = 3 Ko B - 4 mu C/a^3, so C = g B
    const double g = 3 * (bulk(outer) - bulk(inner)) / (3 * bulk(inner) + 4 * mu) * a3;
    const double stress = 3 * bulk(outer) - 4 * mu * g, u = 1 + g; // of B = 1 at r = 1
    const double exact = u * traction / (stress + springs * u);
    return moved / exact - 1;
}

} // namespace

TEST_CASE("balls with a core, against the exact radial solution", "[layers]") {
    const auto error = [](double core, bool stiff_inside, double size, ElementKind element) {
        return error_of_ball(core, stiff_inside ? stiff : soft, stiff_inside ? soft : stiff, size, element);
    };
    for (const double core : {0.5, 0.7}) {
        CAPTURE(core);
        CHECK(std::abs(error_of_ball(core, soft, soft, 0.35, ElementKind::linear)) < 0.002); // the ball's facets
        CHECK(std::abs(error(core, true, 0.35, ElementKind::quadratic)) < 0.005);
        CHECK(std::abs(error(core, false, 0.35, ElementKind::quadratic)) < 0.005);
        // Where the strains vary, which they do in the shell, linear tets are too stiff.
        CHECK(error(core, true, 0.35, ElementKind::linear) == Approx(-0.02).margin(0.005));
        CHECK(error(core, false, 0.35, ElementKind::linear) == Approx(-0.042).margin(0.005));
        CHECK(error(core, true, 0.25, ElementKind::linear) == Approx(-0.011).margin(0.004));
    }
}
