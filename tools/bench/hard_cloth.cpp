// The hard cases of cloth: crumpled starts, rest shapes and pressures that come in one frame, tensions that spread or
// fold it up, sheets ten thousand times as wide as thick that fall fast.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/terms/contact/contact.h"
#include "solver/terms/contact/contact_rest.h"
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"
#include "tools/bench/hard_cases.h"
#include "tools/bench/table.h"

#include <algorithm>
#include <random>

namespace sinew::bench {

using namespace solver;

namespace {

using enum HardTrial::Equilibria;

bool nowhere(const Vec3&) { return false; }
Vec3 in_place(const Vec3& p) { return p; }

constexpr double width = 0.4; // of the sheet, and the ball's diameter [m]
constexpr double tensile = 500, shear = 100;

bool at_edge(const Vec3& p) { return p.x() < -0.5 * width + 1e-9; }

ClothInputs fabric(double stretch = tensile) {
    ClothInputs out;
    out.layers.push_back({stretch, shear * stretch / tensile, 1e-3, 0.2, 1, 1});
    return out;
}

/// Over the plane y = 0.
void sheet(HardTrial& t, const Where& held) {
    const SurfaceMesh mesh = make_plane(width, width, 8, 8);
    t.make_cloth(mesh.points, mesh.triangles, fabric(), held);
}

void ball(HardTrial& t, double stretch) {
    const SurfaceMesh mesh = make_sphere(0.5 * width, 16, 12);
    t.make_cloth(mesh.points, mesh.triangles, fabric(stretch), nowhere);
}

void load(HardTrial& t, const TermType& type, double value) {
    auto layers = std::make_shared<SurfaceLayers>();
    layers->layers.push_back({value, {}});
    t.description.parts.push_back({&type, {0}, layers});
    t.in.parts.push_back({1});
}

double volume(const HardTrial& t) { return value_of(t.state.record.measured, "pressure", "volume_m3"); }

void crumpled(HardTrial& t) {
    sheet(t, at_edge);
    t.start();
    std::mt19937 random(7);
    const auto anywhere = [&] { return 0.1 * width * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
    t.place([](const Vec3& p) { return !at_edge(p); },
            [&](const Vec3&) {
                const double x = anywhere(), y = anywhere(), z = anywhere();
                return Vec3(x - 0.4 * width, y, z);
            });
    t.run(20, 6);
    t.come_to_rest();
    t.must(t.distance_from(in_place) < 1e-3, "off by " + number(t.distance_from(in_place), 3) + " m", several);
}

/// restScale and its envelopes, one after the other.
constexpr std::pair<double, std::array<double, 2>> scales[] = {
    {2, {1, 2}}, {0.5, {1, 2}}, {2, {-1, 2}}, {0.5, {-1, 2}}};

template <int which>
void rest_scale_changes(HardTrial& t) {
    sheet(t, nowhere);
    t.start();
    const auto& [scale, envelopes] = scales[which];
    t.cloth_values().layers[0].rest_scale = scale;
    for (const double envelope : envelopes) {
        t.cloth_values().rest_scale_envelope = envelope;
        t.run(3, 2);
        // What has buckled creeps for long before it is at rest.
        for (int i = 0; i < 5; ++i) t.come_to_rest();
    }
    const double along = std::pow(scale, envelopes[1]), off = t.distortion(along * Mat3::Identity());
    t.must(off < 1e-3 * along, "distorted by " + number(off, 3) + " m", several);
}

/// Outwards, in one frame. Grown by s, a ball stores k (s - 1)^2 of its area A at rest and encloses s^3 V, so that at
/// rest 2 k (s - 1) A = 3 p V s^2.
template <bool soft>
void blown_up(HardTrial& t) {
    const double k = soft ? tensile : 1e6, pressure = 1e5;
    ball(t, k);
    load(t, pressure_type, -pressure);
    t.start();
    const SurfaceMesh mesh = make_sphere(0.5 * width, 16, 12);
    const double rest = enclosed_volume(mesh.points, mesh.triangles);
    double area = 0;
    for (const Triangle& f : mesh.triangles) {
        const auto at = [&](std::size_t c) { return mesh.points[static_cast<std::size_t>(f[c])]; };
        area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
    }
    t.run(4, 2);
    t.come_to_rest();
    const double a = 3 * pressure * rest / (2 * k * area), s = (1 - std::sqrt(std::max(0.0, 1 - 4 * a))) / (2 * a);
    const double growth = std::cbrt(volume(t) / rest);
    // There is no rest for the soft one: it grows as long as it is looked at, or is called not converged.
    t.must(soft ? growth > 2 : std::abs(growth - s) < 0.05 * (s - 1),
           "grown by " + number(growth) + ", not by " + number(s));
}

void pressed_in(HardTrial& t) {
    ball(t, tensile);
    load(t, pressure_type, 1e5);
    t.start();
    t.run(4, 1);
    t.must(true, "");
}

/// Of a free sheet: 2 k (s - 1) + 2 T s = 0.
void spread_by_tension(HardTrial& t) {
    const double tension = -50, s = tensile / (tensile + tension);
    sheet(t, nowhere);
    load(t, surface_tension_type, tension);
    t.start();
    t.run(4, 2);
    t.come_to_rest();
    const double off = t.distortion(s * Mat3::Identity());
    t.must(off < 1e-3, "distorted by " + number(off, 3) + " m", several);
}

/// More than shear and stretch can bear: it folds up to nothing, or spreads for ever.
template <int tension>
void beyond_its_strength(HardTrial& t) {
    sheet(t, at_edge);
    load(t, surface_tension_type, tension);
    t.start();
    t.run(4, 1);
    t.must(true, "");
}

/// 40 micrometres thick, onto a block, at 10 m/s.
void thin_falls(HardTrial& t) {
    sheet(t, nowhere);
    auto block = std::make_shared<BoneRest>();
    const TetMesh solid = box_mesh({-width, -0.5, -width}, {width, -0.1, width}, 5, 3, 5);
    block->surface = solid.vertices, block->triangles = boundary_triangles(solid.tets);
    t.in.bodies.emplace_back(BoneInputs{block->surface});
    t.description.bodies.emplace_back(std::shared_ptr<const BoneRest>(std::move(block)));
    const double thickness = 1e-4 * width;
    for (const int body : {0, 1}) {
        auto rest = std::make_shared<ContactRest>();
        rest->thickness = body == 0 ? thickness : 0, rest->is_volume = body == 1;
        t.description.parts.push_back({&contact_type, {body}, rest});
        ContactValues values;
        values.collides_with_itself = body == 0 ? 1 : 0;
        put_fields(values, std::span(t.in.parts.emplace_back(contact_type.values.size())));
    }
    t.in.gravity = Vec3(0, -9.8, 0);
    t.start();
    if (!t.is_static())
        for (std::size_t v = 0; v < t.nodes.size(); ++v) t.state.v[3 * v + 1] = -10;
    t.run(3, 2);
    t.come_to_rest();
    double lowest = INFINITY, highest = -INFINITY;
    for (std::size_t v = 0; v < t.nodes.size(); ++v) {
        lowest = std::min(lowest, t.state.x[3 * v + 1]), highest = std::max(highest, t.state.x[3 * v + 1]);
    }
    // Its weight presses it 2 micrometres into the spring; beside the 20 of its half thickness that is little.
    t.must(lowest > -0.1 && highest < -0.1 + thickness,
           "it lies from " + number(lowest, 6) + " m to " + number(highest, 6) + " m on a block up to -0.1 m", several);
}

constexpr HardCase cases[] = {
    {"cloth: crumpled start", "held at an edge", "flat, in place", crumpled, true, true},
    {"cloth: rest scale in one frame", "lengths x 4", "exactly scaled", rest_scale_changes<0>, true, true},
    {"cloth: rest scale in one frame", "lengths / 4", "exactly scaled", rest_scale_changes<1>, false, true},
    {"cloth: rest scale in one frame", "lengths / 2, then x 4", "exactly scaled", rest_scale_changes<2>, false, true},
    {"cloth: rest scale in one frame", "lengths x 2, then / 4", "exactly scaled", rest_scale_changes<3>, false, true},
    {"cloth: pressure of 1e5 Pa in one frame", "outwards, of a ball that bears it", "closed form", blown_up<false>,
     true, true},
    {"cloth: pressure of 1e5 Pa in one frame", "outwards, of a soft ball", "no numbers that are none", blown_up<true>,
     false, true},
    {"cloth: pressure of 1e5 Pa in one frame", "inwards", "no numbers that are none", pressed_in, false, true},
    {"cloth: tension in one frame", "-50 N/m", "exactly spread", spread_by_tension, true, true},
    {"cloth: tension in one frame", "-1000 N/m, more than it bears", "no numbers that are none",
     beyond_its_strength<-1000>, false, true},
    {"cloth: tension in one frame", "1000 N/m, more than it bears", "no numbers that are none",
     beyond_its_strength<1000>, false, true},
    {"cloth: thickness 1e-4 of the width", "onto a block at 10 m/s", "lies on it", thin_falls, false, true},
};

} // namespace

std::span<const HardCase> hard_cloth_cases() { return cases; }

} // namespace sinew::bench
