// Accuracy of cloth: stretch, shear, hanging and clamped strips, balls under pressure (catalogue 10).
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/terms/cloth/sheet.h"
#include "solver/terms/pressure/pressure.h"
#include "tools/bench/accuracy.h"

#include <algorithm>
#include <cmath>

namespace sinew::bench {

using namespace solver;

namespace {

/// Diagonals all alike, or rows of triangles with two equal sides.
enum class Weave { diagonal, bricks };
constexpr std::pair<Weave, const char*> weaves[] = {{Weave::diagonal, "diagonals alike"}, {Weave::bricks, "bricks"}};

/// A rectangle over [low, high] x [0, width].
struct Sheet {
    Points points;
    std::vector<Triangle> triangles;
    int along, across;
    int at(int i, int j) const { return j * (along + 1) + i; }

    Sheet(double low, double high, double width, int along, int across, Weave weave)
        : along(along)
        , across(across) {
        const double h = (high - low) / along;
        for (int j = 0; j <= across; ++j)
            for (int i = 0; i <= along; ++i) {
                const bool moved = weave == Weave::bricks && j % 2 == 1 && i > 1 && i < along;
                points.emplace_back(low + (moved ? i - 0.5 : i) * h, width * j / across, 0);
            }
        for (int j = 0; j < across; ++j)
            for (int i = 0; i < along; ++i) {
                const int a = at(i, j), b = at(i + 1, j), c = at(i, j + 1), d = at(i + 1, j + 1);
                if (weave == Weave::bricks && j % 2 == 0) {
                    triangles.push_back({a, b, d});
                    triangles.push_back({a, d, c});
                } else {
                    triangles.push_back({a, b, c});
                    triangles.push_back({b, d, c});
                }
            }
    }
};

std::shared_ptr<ClothRest> make_cloth(const Points& points, const std::vector<Triangle>& triangles) {
    auto out = std::make_shared<ClothRest>();
    out->surface = points, out->triangles = triangles;
    out->warp = warp_directions(points, triangles, Vec3::UnitX());
    out->layer_weights = {std::vector<double>(points.size(), 1.0)};
    return out;
}

ClothInputs cloth_material(double tensile, double shear, double bend, double density) {
    ClothInputs out;
    out.layers.push_back({tensile, shear, bend, density, 1, 1});
    return out;
}

/// Comes to rest under large steps of backward Euler, which brake.
State rest_of(const std::shared_ptr<ClothRest>& cloth, StepInputs in, std::vector<Part> parts, int steps,
              const std::stop_token& stop, Work& work) {
    Simulation sim({{cloth}, {}, std::move(parts)}, in, stop);
    for (int i = 0; i < steps; ++i) sim.step();
    work += sim.work;
    return sim.state;
}

void pulled_strip(Book& book, const RunOptions& options) {
    book.open("10", "cloth: pulled strip");
    const double k = 400, width = 0.1, length = 0.5, force = 8;
    for (const auto& [weave, name] : weaves) {
        const Sheet sheet(0, length, width, 10, 2, weave);
        auto cloth = make_cloth(sheet.points, sheet.triangles);
        ClothInputs values = cloth_material(k, 60, 1e-4, 0.1);
        values.forces.assign(sheet.points.size(), Vec3::Zero());
        for (int j = 0; j <= 2; ++j) {
            cloth->fixed_vertices.push_back(sheet.at(0, j));
            values.forces[std::size_t(sheet.at(10, j))].x() = force / 2 * (j == 1 ? 1 : 0.5);
        }
        StepInputs in = tight_inputs();
        in.step_size = 1;
        in.bodies = {values};
        Work work;
        const State end = rest_of(cloth, in, {}, 30, options.stop, work);
        book.compare(CaseKind::exact, name, "stretch", position(end.x, sheet.at(10, 1)).x() / length - 1,
                     force / (k * width), 1e-6, work);
        book.compare(CaseKind::exact, name, "width", position(end.x, sheet.at(5, 2)).y(), width, 1e-6, work);
    }
}

void picture_frame(Book& book, const RunOptions& options) {
    book.open("10", "cloth: picture frame");
    const double s = 120, length = 0.25, angle = M_PI / 6;
    for (const auto& [weave, name] : weaves) {
        // All vertices are held in the sheared shape; the energy is that of the closed form.
        const Sheet sheet(0, length, length, 4, 4, weave);
        auto cloth = make_cloth(sheet.points, sheet.triangles);
        StepInputs in = tight_inputs();
        in.bodies = {cloth_material(500, s, 0, 1)};
        for (std::size_t v = 0; v < sheet.points.size(); ++v) cloth->fixed_vertices.push_back(static_cast<int>(v));
        Simulation sim({{cloth}, {}, {}}, in, options.stop);
        for (std::size_t v = 0; v < sheet.points.size(); ++v) {
            const Vec3& p = sheet.points[v];
            set_position(sim.state.x, static_cast<int>(v),
                         Vec3(p.x() + std::sin(angle) * p.y(), std::cos(angle) * p.y(), 0));
        }
        sim.step();
        book.compare(CaseKind::exact, name, "energy J", sim.state.record.energy,
                     0.5 * s * length * length * std::pow(std::sin(angle), 2), 1e-9, sim.work);
    }
}

/// A strip between ends 1 m apart, modelled as a polygon on a circle whose sides are as long as they are at rest.
double sag_of(double length, int cells, Weave weave, const std::stop_token& stop, Work& work) {
    const double side = length / cells;
    double low = 1e-9, high = 2 * M_PI / cells;
    for (int i = 0; i < 200; ++i) {
        const double turn = 0.5 * (low + high);
        (side * std::sin(cells * turn / 2) / std::sin(turn / 2) > 1 ? low : high) = turn;
    }
    Sheet sheet(0, length, 0.1, cells, 2, weave);
    const auto corner = [&](double i) {
        const double r = side / (2 * std::sin(low / 2)), a = low * (i - cells / 2.0);
        return Vec3(r * std::sin(a) + 0.5, 0, r * (std::cos(cells * low / 2) - std::cos(a)));
    };
    for (Vec3& p : sheet.points) {
        const double k = p.x() / side, whole = std::min<double>(std::floor(k + 1e-9), cells - 1);
        p = corner(whole) + (k - whole) * (corner(whole + 1) - corner(whole)) + Vec3(0, p.y(), 0);
    }
    auto cloth = make_cloth(sheet.points, sheet.triangles);
    for (int j = 0; j <= 2; ++j)
        for (const int i : {0, cells}) cloth->fixed_vertices.push_back(sheet.at(i, j));
    StepInputs in = tight_inputs();
    in.step_size = 0.2;
    in.gravity = Vec3(0, 0, -9.81);
    in.bodies = {cloth_material(500, 50, 0, 0.3)};
    const State end = rest_of(cloth, in, {}, 60, stop, work);
    double deepest = 0;
    for (std::size_t v = 0; v < sheet.points.size(); ++v)
        deepest = std::max(deepest, -position(end.x, static_cast<int>(v)).z());
    return deepest;
}

void hanging_strip(Book& book, const RunOptions& options) {
    if (options.quick) return; // its meshes are too coarse for an order
    book.open("10", "cloth: hanging strip (elastic catenary)");
    for (const auto& [length, sag] : {std::pair{1.2, 0.29565809}, {1.05, 0.14728073}})
        for (const auto& [weave, name] : weaves) {
            std::vector<double> h, values;
            Work work;
            for (const int cells : {12, 24, 48}) {
                h.push_back(1.0 / cells), values.push_back(sag_of(length, cells, weave, options.stop, work));
            }
            book.converge(std::string(name) + ", L " + number(length, 3), "sag m", h, values, sag, 1.5, work);
        }
}

void clamped_strip(Book& book, const RunOptions& options) {
    if (options.quick) return; // its meshes are too coarse for an order
    book.open("10", "cloth: clamped strip (elastica)");
    constexpr double x_tip = 0.846657, z_tip = -0.495905, density = 0.1, gravity = 9.8;
    for (const auto& [weave, name] : weaves) {
        std::vector<double> h, x, z;
        Work work;
        for (const int cells : {10, 20, 40}) {
            // Two columns are held, half a cell to either side of the clamp: hinges stand for whole cells.
            const double side = 1 / (cells - 0.5);
            const Sheet sheet(-0.5 * side, 1, 0.2, cells, 4, weave);
            auto cloth = make_cloth(sheet.points, sheet.triangles);
            for (int j = 0; j <= 4; ++j)
                for (const int i : {0, 1}) cloth->fixed_vertices.push_back(sheet.at(i, j));
            StepInputs in = tight_inputs();
            in.step_size = 0.2;
            in.gravity = Vec3(0, 0, -gravity);
            in.bodies = {cloth_material(5e3, 500, density * gravity / 5, density)};
            const State end = rest_of(cloth, in, {}, 60, options.stop, work);
            const Vec3 tip = position(end.x, sheet.at(cells, 2));
            h.push_back(side), x.push_back(tip.x()), z.push_back(tip.z());
        }
        // Distances from the converged tip, in lengths.
        for (std::size_t l = 0; l < h.size(); ++l)
            book.judge(CaseKind::continuum, std::string(name) + ", " + number(1 / h[l], 3) + " cells", "tip, off L",
                       z[l], z_tip, std::hypot(x[l] - x_tip, z[l] - z_tip), 0.03, work);
    }
}

void blown_ball(Book& book, const RunOptions& options) {
    if (options.quick) return; // its meshes are too coarse for an order
    book.open("10", "cloth: ball under pressure (Laplace)");
    const double radius = 0.1, k = 500;
    for (const double p : {40.0, 400.0}) {
        const SurfaceMesh ball = make_sphere(radius, 40, 40);
        auto layers = std::make_shared<SurfaceLayers>();
        layers->layers.push_back({-p, {}});
        StepInputs in = tight_inputs();
        in.step_size = 0.1;
        in.bodies = {cloth_material(k, 100, 1e-6, 0.1)};
        in.parts = {{1}};
        Work work;
        const State end = rest_of(make_cloth(ball.points, ball.triangles), in, {{&pressure_type, {0}, layers}}, 20,
                                  options.stop, work);
        const double growth = std::cbrt(value_of(end.record.measured, "pressure", "volume_m3") /
                                        enclosed_volume(ball.points, ball.triangles));
        const double a = p * radius / (2 * k);
        book.compare(CaseKind::continuum, "p " + number(p, 3) + " Pa", "radius / rest - 1", growth - 1,
                     (1 - std::sqrt(1 - 4 * a)) / (2 * a) - 1, 0.02, work);
    }
}

} // namespace

std::vector<AccuracyCase> cloth_cases() {
    return {{"cloth: pulled strip", pulled_strip},
            {"cloth: picture frame", picture_frame},
            {"cloth: hanging strip", hanging_strip},
            {"cloth: clamped strip", clamped_strip},
            {"cloth: ball under pressure", blown_ball}};
}

} // namespace sinew::bench
