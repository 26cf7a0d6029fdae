// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/surface_tension/surface_tension.h"

#include "solver/terms/surface_tension/tension_triangle.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

constexpr FieldName values[] = {{"surfaceTensionEnvelope", "1"}};
constexpr Measure measures[] = {
    {"surfaceTension", "area_m2", "m^2", "area of surfaces under tension", Combine::last},
};

double area_of(std::span<const double> places, const Triangle& t) {
    const auto point = [&](std::size_t c) { return Eigen::Map<const Vec3>(places.data() + 3 * at(t[c])); };
    return 0.5 * (point(1) - point(0)).cross(point(2) - point(0)).norm();
}

} // namespace

const TermType surface_tension_type{
    .name = "surfaceTension",
    .values = values,
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        return LayeredSurfaces::used(scene, surface_tension_type) ? std::make_unique<SurfaceTension>(scene) : nullptr;
    },
    .may_mix = [](std::span<const double> before,
                  std::span<const double> after) { return (before[0] == 0) == (after[0] == 0); },
};

SurfaceTension::SurfaceTension(const Scene& scene)
    : surfaces_(scene, surface_tension_type) {
    const Stencils<3>& triangles = surfaces_.triangles();
    const std::size_t slots = lanes * triangles.batch_count();
    tension_.assign(slots, 0.0);
    for (std::size_t slot = 0; slot < slots; ++slot)
        rest_area_.push_back(area_of(surfaces_.rest(), triangles.corners(slot)));
    const double mean = ordered_sum(triangles.count(), [&](std::size_t t) { return rest_area_[t]; }) /
                        static_cast<double>(std::max<std::size_t>(triangles.count(), 1));
    for (const double area : rest_area_) rounding_.push_back(1e-7 * std::max(area, 1e-6 * mean));
    places_.assign(3 * triangles.point_count(), 0.0);
}

Changes SurfaceTension::take(const StepInputs& inputs, const State&) {
    if (!surfaces_.take(inputs)) return {};
    const std::vector<double>& g = surfaces_.values();
    rest_energy_ = energy_scale_ = 0;
    for (std::size_t slot = 0; slot < tension_.size(); ++slot) {
        const Triangle& t = surfaces_.triangles().corners(slot);
        tension_[slot] = (g[at(t[0])] + g[at(t[1])] + g[at(t[2])]) / 3;
        if (slot >= surfaces_.triangles().count()) continue;
        rest_energy_ += tension_[slot] * rest_area_[slot];
        energy_scale_ += std::abs(tension_[slot]) * rest_area_[slot];
    }
    return {};
}

double SurfaceTension::energy(const Positions& x, bool with_forces) {
    if (!acts()) return 0;
    Stencils<3>& triangles = surfaces_.triangles();
    triangles.move(x);
    const double energy =
        triangles.evaluate(with_forces, [&](std::size_t b, const StencilVectors<3>& x, StencilVectors<3>& g) {
            const TensionTriangle triangle(x, Pack::load(rounding_.data() + b * lanes));
            const Pack tension = Pack::load(tension_.data() + b * lanes);
            triangle.gradient(tension, g);
            return tension * triangle.area;
        });
    if (with_forces) triangles.carry_gradient();
    return energy - rest_energy_;
}

void SurfaceTension::add_gradient(std::span<double> gradient) const {
    if (acts()) surfaces_.triangles().add_gradient(gradient);
}

void SurfaceTension::add_held_gradient(std::span<double> gradient) const {
    if (acts()) surfaces_.triangles().add_held_gradient(gradient);
}

void SurfaceTension::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    if (!acts()) return;
    surfaces_.triangles().move(x);
    surfaces_.triangles().add_hessian(
        [&](std::size_t b, const StencilVectors<3>& x, StencilBlocks<3>& h) {
            const TensionTriangle triangle(x, Pack::load(rounding_.data() + b * lanes));
            triangle.hessian(Pack::load(tension_.data() + b * lanes), project, h);
        },
        a);
}

void SurfaceTension::raise_forces_at_work(const Positions&, std::span<double> largest) const {
    if (!acts()) return;
    squares_.assign(largest.size(), 0.0);
    surfaces_.triangles().carried().add_squared_gradient(squares_);
    for (std::size_t d = 0; d < largest.size(); ++d) largest[d] = std::max(largest[d], std::sqrt(squares_[d]));
}

void SurfaceTension::add_squared_stiffnesses(std::span<double> squares) const {
    if (acts()) surfaces_.add_squares([&](std::size_t t) { return tension_[t]; }, squares);
}

void SurfaceTension::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    const Stencils<3>& triangles = surfaces_.triangles();
    triangles.carried().move(x, places_);
    double area = 0;
    for (std::size_t t = 0; t < triangles.count(); ++t) area += area_of(places_, triangles.corners(t));
    out.push_back({&measures[0], area});
}

void SurfaceTension::marks(const Positions& x, Marks& out) const {
    const Stencils<3>& triangles = surfaces_.triangles();
    triangles.carried().move(x, places_);
    MarkGroup group{surface_tension_type.name, "tension", "N/m", {}};
    for (std::size_t t = 0; t < triangles.count(); t += surfaces_.shown_step()) {
        Vec3 middle = Vec3::Zero();
        for (const int c : triangles.corners(t)) middle += Eigen::Map<const Vec3>(places_.data() + 3 * at(c)) / 3;
        if (tension_[t] != 0)
            group.marks.push_back({surfaces_.part(triangles.corners(t)[0]), middle, middle, tension_[t]});
    }
    out.push_back(std::move(group));
}

} // namespace sinew::solver
