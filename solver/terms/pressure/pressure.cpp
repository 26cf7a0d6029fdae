// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/pressure/pressure.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

constexpr FieldName values[] = {{"pressureEnvelope", "1"}};
constexpr Measure measures[] = {
    {"pressure", "volume_m3", "m^3", "volume inside surfaces under pressure", Combine::last},
    {"pressure", "net_force_N", "N", "largest net force of pressure on a body", Combine::most},
};

Eigen::Map<const Vec3> point(std::span<const double> places, int p) {
    return Eigen::Map<const Vec3>(places.data() + 3 * at(p));
}

} // namespace

const TermType pressure_type{
    .name = "pressure",
    .numerics = 2,
    .values = values,
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        return LayeredSurfaces::used(scene, pressure_type) ? std::make_unique<Pressure>(scene) : nullptr;
    },
};

Pressure::Pressure(const Scene& scene)
    : surfaces_(scene, pressure_type)
    , pieces_(find_pieces(surfaces_.vertex_count(), surfaces_.triangles()))
    , triangles_(scene, surfaces_)
    , linear_(scene, surfaces_)
    , quadratic_(scene, surfaces_) {
    has_potential_.assign(surfaces_.surfaces().size(), 0);
    places_.assign(3 * surfaces_.vertex_count(), 0.0);
}

void Pressure::find_potentials() {
    const std::vector<double>& p = surfaces_.values();
    for (std::size_t s = 0; s < has_potential_.size(); ++s) {
        const LayeredSurfaces::Surface& surface = surfaces_.surfaces()[s];
        bool has = std::none_of(surface.clipped.is_outside.begin(), surface.clipped.is_outside.end(),
                                [](char outside) { return outside; });
        for (std::size_t v = surface.first_vertex; has && v < surface.first_vertex + surface.vertex_count; ++v) {
            const int piece = pieces_.of_point[v];
            has = piece < 0 || (pieces_.is_closed[at(piece)] && p[v] == p[at(pieces_.first_point[at(piece)])]);
        }
        has_potential_[s] = has;
    }
}

Changes Pressure::take(const StepInputs& inputs, const State&) {
    const LayeredSurfaces::Taken taken = surfaces_.take(inputs);
    if (taken.values) {
        find_potentials();
        for_each([&](auto& tets) { tets.take_values(has_potential_); });
    }
    if (taken.values || taken.envelopes) for_each([](auto& tets) { tets.take_envelopes(); });
    return {};
}

void Pressure::add_couplings(Couplings& couplings) const {
    for_each([&](const auto& tets) { tets.stencils().add_couplings(couplings); });
}

void Pressure::bind(const BlockPattern& pattern) {
    for_each([&](auto& tets) { tets.stencils().bind(pattern); });
}

void Pressure::begin_stage(const Stage& stage) { begin_iteration(stage.before.x); }

double Pressure::begin_iteration(const Positions& x) {
    double change = 0;
    if (acts())
        for_each([&](auto& tets) {
            tets.stencils().move(x);
            change += tets.freeze();
        });
    return change;
}

double Pressure::energy(const Positions& x, bool with_forces) {
    double energy = 0;
    if (acts())
        for_each([&](auto& tets) {
            tets.stencils().move(x);
            energy += tets.energy(with_forces);
            if (with_forces) tets.stencils().carry_gradient();
        });
    return energy;
}

double Pressure::stored_energy(const Positions& x) {
    double energy = 0;
    if (acts())
        for_each([&](auto& tets) {
            tets.stencils().move(x);
            energy += tets.potential_energy(true);
        });
    return energy;
}

void Pressure::add_gradient(std::span<double> gradient) const {
    if (acts()) for_each([&](const auto& tets) { tets.stencils().add_gradient(gradient); });
}

void Pressure::add_held_gradient(std::span<double> gradient) const {
    if (acts()) for_each([&](const auto& tets) { tets.stencils().add_held_gradient(gradient); });
}

void Pressure::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    if (!acts() || project) return;
    for_each([&](auto& tets) {
        tets.stencils().move(x);
        tets.add_hessian(a);
    });
}

void Pressure::raise_forces_at_work(const Positions&, std::span<double> largest) const {
    if (!acts()) return;
    squares_.assign(largest.size(), 0.0);
    for_each([&](const auto& tets) { tets.stencils().carried().add_squared_gradient(squares_); });
    for (std::size_t d = 0; d < largest.size(); ++d) largest[d] = std::max(largest[d], std::sqrt(squares_[d]));
}

void Pressure::add_squared_stiffnesses(std::span<double> squares) const {
    if (acts()) for_each([&](const auto& tets) { tets.add_squared_stiffnesses(squares); });
}

void Pressure::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    surfaces_.move(x, places_);
    double volume = 0;
    for (const Triangle& t : surfaces_.triangles()) {
        const int piece = pieces_.of_point[at(t[0])];
        if (!pieces_.is_closed[at(piece)]) continue;
        const Vec3 o = point(places_, pieces_.first_point[at(piece)]);
        volume += (point(places_, t[0]) - o).dot((point(places_, t[1]) - o).cross(point(places_, t[2]) - o)) / 6;
    }
    double most = 0;
    if (acts()) {
        net_forces_.assign(surfaces_.surfaces().size(), Vec3::Zero());
        for_each([&](const auto& tets) { tets.add_net_forces(net_forces_); });
        for (const Vec3& f : net_forces_) most = std::max(most, f.norm());
    }
    out.push_back({&measures[0], volume});
    out.push_back({&measures[1], most});
}

void Pressure::marks(const Positions& x, Marks& out) const {
    surfaces_.move(x, places_);
    MarkGroup group{std::string(pressure_type.name), "pressure", "Pa", {}};
    double largest = 0, area = 0;
    for (std::size_t t = 0; t < surfaces_.triangles().size(); t += surfaces_.shown_step()) {
        const Triangle& c = surfaces_.triangles()[t];
        const LayeredSurfaces::Surface& surface = surfaces_.surface_of(t);
        const auto corner = [&](std::size_t i) { return point(places_, c[i]); };
        const double p = surface.envelope / 3 *
                         (surfaces_.values()[at(c[0])] + surfaces_.values()[at(c[1])] + surfaces_.values()[at(c[2])]);
        const Vec3 across = (corner(1) - corner(0)).cross(corner(2) - corner(0)),
                   middle = (corner(0) + corner(1) + corner(2)) / 3;
        if (p == 0 || !(across.norm() > 0)) continue;
        area += 0.5 * across.norm();
        largest = std::max(largest, std::abs(p));
        group.marks.push_back({static_cast<int>(surface.part), middle, across.normalized(), p});
    }
    // The longest is as long as the triangles that it stands for are wide.
    const double length = std::sqrt(static_cast<double>(surfaces_.shown_step()) * area /
                                    static_cast<double>(std::max<std::size_t>(group.marks.size(), 1)));
    for (Mark& m : group.marks) {
        const Vec3 outside = m.from + length * std::abs(m.value) / largest * m.to;
        m.to = m.value > 0 ? m.from : outside;
        m.from = m.value > 0 ? outside : m.from;
    }
    out.push_back(std::move(group));
}

} // namespace sinew::solver
