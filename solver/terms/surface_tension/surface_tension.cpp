// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/surface_tension/surface_tension.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

constexpr FieldName values[] = {{"surfaceTensionEnvelope", "1"}};
constexpr Measure measures[] = {
    {"surfaceTension", "area_m2", "m^2", "area of surfaces under tension", Combine::last},
};

} // namespace

const TermType surface_tension_type{
    .name = "surfaceTension",
    .numerics = 3,
    .values = values,
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        return LayeredSurfaces::used(scene, surface_tension_type) ? std::make_unique<SurfaceTension>(scene) : nullptr;
    },
};

SurfaceTension::SurfaceTension(const Scene& scene)
    : surfaces_(scene, surface_tension_type)
    , triangles_(scene, surfaces_)
    , linear_(scene, surfaces_)
    , quadratic_(scene, surfaces_) {
    places_.assign(3 * surfaces_.vertex_count(), 0.0);
}

Changes SurfaceTension::take(const StepInputs& inputs, const State&) {
    const LayeredSurfaces::Taken taken = surfaces_.take(inputs);
    if (taken.values || taken.envelopes) for_each([](auto& tets) { tets.take(); });
    return {};
}

void SurfaceTension::add_couplings(Couplings& couplings) const {
    for_each([&](const auto& tets) { tets.stencils().add_couplings(couplings); });
}

void SurfaceTension::bind(const BlockPattern& pattern) {
    for_each([&](auto& tets) { tets.stencils().bind(pattern); });
}

double SurfaceTension::energy(const Positions& x, bool with_forces) {
    double energy = 0;
    if (acts())
        for_each([&](auto& tets) {
            tets.stencils().move(x);
            energy += tets.energy(with_forces);
            if (with_forces) tets.stencils().carry_gradient();
        });
    return energy;
}

double SurfaceTension::stored_energy(const Positions& x) { return energy(x, false); }

void SurfaceTension::add_gradient(std::span<double> gradient) const {
    if (acts()) for_each([&](const auto& tets) { tets.stencils().add_gradient(gradient); });
}

void SurfaceTension::add_held_gradient(std::span<double> gradient) const {
    if (acts()) for_each([&](const auto& tets) { tets.stencils().add_held_gradient(gradient); });
}

void SurfaceTension::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    if (!acts()) return;
    for_each([&](auto& tets) {
        tets.stencils().move(x);
        tets.add_hessian(project, a);
    });
}

void SurfaceTension::raise_forces_at_work(const Positions&, std::span<double> largest) const {
    if (!acts()) return;
    squares_.assign(largest.size(), 0.0);
    for_each([&](const auto& tets) { tets.stencils().carried().add_squared_gradient(squares_); });
    for (std::size_t d = 0; d < largest.size(); ++d) largest[d] = std::max(largest[d], std::sqrt(squares_[d]));
}

void SurfaceTension::add_squared_stiffnesses(std::span<double> squares) const {
    if (acts()) for_each([&](const auto& tets) { tets.add_squared_stiffnesses(squares); });
}

void SurfaceTension::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    double area = 0;
    for_each([&](auto& tets) {
        tets.stencils().move(x);
        area += tets.area();
    });
    out.push_back({&measures[0], area});
}

void SurfaceTension::marks(const Positions& x, Marks& out) const {
    surfaces_.move(x, places_);
    MarkGroup group{std::string(surface_tension_type.name), "tension", "N/m", {}};
    for (std::size_t t = 0; t < surfaces_.triangles().size(); t += surfaces_.shown_step()) {
        const LayeredSurfaces::Surface& surface = surfaces_.surface_of(t);
        Vec3 middle = Vec3::Zero();
        double tension = 0;
        for (const int c : surfaces_.triangles()[t]) {
            middle += Eigen::Map<const Vec3>(places_.data() + 3 * at(c)) / 3;
            tension += surface.envelope * surfaces_.values()[at(c)] / 3;
        }
        if (tension != 0) group.marks.push_back({static_cast<int>(surface.part), middle, middle, tension});
    }
    out.push_back(std::move(group));
}

} // namespace sinew::solver
