// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/pressure/pressure.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

constexpr FieldName values[] = {{"pressureEnvelope", "1"}};
constexpr Measure measures[] = {
    {"pressure", "volume_m3", "m^3", "volume inside surfaces under pressure", Combine::last},
    {"pressure", "net_force_n", "N", "largest net force of pressure on a body", Combine::most},
};

Eigen::Map<const Vec3> point(std::span<const double> places, int p) {
    return Eigen::Map<const Vec3>(places.data() + 3 * at(p));
}

/// Six times the volume between a triangle and a point.
double six_volumes(std::span<const double> places, const Triangle& t, int origin) {
    const Vec3 o = point(places, origin);
    return (point(places, t[0]) - o).dot((point(places, t[1]) - o).cross(point(places, t[2]) - o));
}

std::vector<Triangle> triangles_of(const Stencils<3>& stencils) {
    std::vector<Triangle> out;
    for (std::size_t t = 0; t < stencils.count(); ++t) out.push_back(stencils.corners(t));
    return out;
}

} // namespace

const TermType pressure_type{
    .name = "pressure",
    .values = values,
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        return LayeredSurfaces::used(scene, pressure_type) ? std::make_unique<Pressure>(scene) : nullptr;
    },
    .may_mix = [](std::span<const double> before,
                  std::span<const double> after) { return (before[0] == 0) == (after[0] == 0); },
};

Pressure::Pressure(const Scene& scene)
    : surfaces_(scene, pressure_type)
    , pieces_(find_pieces(surfaces_.triangles().point_count(), triangles_of(surfaces_.triangles()))) {
    const Stencils<3>& triangles = surfaces_.triangles();
    weights_.resize(triangles.batch_count());
    pressure_.assign(lanes * triangles.batch_count(), 0.0);
    for (std::size_t slot = 0; slot < pressure_.size(); ++slot)
        origin_.push_back(pieces_.first_point[at(pieces_.of_point[at(triangles.corners(slot)[0])])]);
    is_frozen_.assign(triangles.point_count(), 0);
    frozen_places_.assign(3 * triangles.point_count(), 0.0);
    frozen_gradient_.assign(3 * triangles.point_count(), 0.0);
    places_.assign(3 * triangles.point_count(), 0.0);
}

Changes Pressure::take(const StepInputs& inputs, const State&) {
    if (!surfaces_.take(inputs)) return {};
    const Stencils<3>& triangles = surfaces_.triangles();
    const std::vector<double>& p = surfaces_.values();
    piece_is_frozen_.assign(pieces_.count(), 0);
    for (std::size_t i = 0; i < p.size(); ++i) {
        const int piece = pieces_.of_point[i];
        if (piece < 0) continue;
        const bool varies = p[i] != p[at(pieces_.first_point[at(piece)])];
        piece_is_frozen_[at(piece)] = piece_is_frozen_[at(piece)] || varies || !pieces_.is_closed[at(piece)];
    }
    some_frozen_ = false;
    for (std::size_t i = 0; i < p.size(); ++i) {
        is_frozen_[i] = pieces_.of_point[i] >= 0 && piece_is_frozen_[at(pieces_.of_point[i])];
        some_frozen_ = some_frozen_ || is_frozen_[i];
    }
    rest_energy_ = energy_scale_ = 0;
    for (std::size_t slot = 0; slot < pressure_.size(); ++slot) {
        const Triangle& t = triangles.corners(slot);
        const double sum = p[at(t[0])] + p[at(t[1])] + p[at(t[2])];
        for (std::size_t a = 0; a < 3; ++a)
            weights_[slot / lanes].of_corner[a][slot % lanes] = (p[at(t[a])] + sum) / 12;
        pressure_[slot] = is_frozen_[at(t[0])] ? 0 : p[at(t[0])];
        if (slot >= triangles.count()) continue;
        const double share = pressure_[slot] / 6 * six_volumes(surfaces_.rest(), t, origin_[slot]);
        rest_energy_ += share;
        energy_scale_ += std::abs(share);
    }
    return {};
}

void Pressure::begin_stage(const Stage& stage) {
    if (acts()) begin_iteration(stage.before.x);
}

double Pressure::frozen_work() const {
    const std::span<const double> places = surfaces_.triangles().places();
    return ordered_sum(is_frozen_.size(), [&](std::size_t p) {
        double work = 0;
        for (std::size_t c = 3 * p; is_frozen_[p] && c < 3 * p + 3; ++c)
            work += frozen_gradient_[c] * (places[c] - frozen_places_[c]);
        return work;
    });
}

double Pressure::begin_iteration(const Positions& x) {
    if (!acts() || !some_frozen_) return 0;
    Stencils<3>& triangles = surfaces_.triangles();
    triangles.move(x);
    const double before = frozen_work();
    potential_energy(true);
    std::copy(triangles.places().begin(), triangles.places().end(), frozen_places_.begin());
    std::copy(triangles.by_points().begin(), triangles.by_points().end(), frozen_gradient_.begin());
    return -before;
}

double Pressure::potential_energy(bool with_forces) {
    Stencils<3>& triangles = surfaces_.triangles();
    const std::span<const double> places = std::as_const(triangles).places();
    const double energy =
        triangles.evaluate(with_forces, [&](std::size_t b, const StencilVectors<3>& x, StencilVectors<3>& g) {
            pressure_gradient(weights_[b], x, g);
            PackVector origin;
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const double* o = places.data() + 3 * at(origin_[b * lanes + lane]);
                origin.x.v[lane] = o[0], origin.y.v[lane] = o[1], origin.z.v[lane] = o[2];
            }
            return Pack::load(pressure_.data() + b * lanes) * volume_seen_from(origin, x);
        });
    return energy - rest_energy_;
}

double Pressure::energy(const Positions& x, bool with_forces) {
    if (!acts()) return 0;
    surfaces_.triangles().move(x);
    const double energy = potential_energy(with_forces) + (some_frozen_ ? frozen_work() : 0);
    if (with_forces) surfaces_.triangles().carry_gradient();
    return energy;
}

double Pressure::stored_energy(const Positions& x) {
    if (!acts()) return 0;
    surfaces_.triangles().move(x);
    return potential_energy(false);
}

void Pressure::add_gradient(std::span<double> gradient) const {
    if (acts()) surfaces_.triangles().add_gradient(gradient);
}

void Pressure::add_held_gradient(std::span<double> gradient) const {
    if (acts()) surfaces_.triangles().add_held_gradient(gradient);
}

void Pressure::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    if (!acts()) return;
    surfaces_.triangles().move(x);
    surfaces_.triangles().add_hessian(
        [&](std::size_t b, const StencilVectors<3>& at, StencilBlocks<3>& h) {
            if (project)
                projected_pressure_hessian(weights_[b], at, h);
            else
                pressure_hessian(weights_[b], at, h);
        },
        a);
}

void Pressure::raise_forces_at_work(const Positions&, std::span<double> largest) const {
    if (!acts()) return;
    squares_.assign(largest.size(), 0.0);
    surfaces_.triangles().carried().add_squared_gradient(squares_);
    for (std::size_t d = 0; d < largest.size(); ++d) largest[d] = std::max(largest[d], std::sqrt(squares_[d]));
}

void Pressure::add_squared_stiffnesses(std::span<double> squares) const {
    if (!acts()) return;
    // Corner forces change by about pressure x edge x how far a corner moves.
    surfaces_.add_squares(
        [&](std::size_t t) {
            const Triangle& corners = surfaces_.triangles().corners(t);
            double weight = 0, edge = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                weight = std::max(weight, std::abs(weights_[t / lanes].of_corner[a][t % lanes]));
                edge = std::max(
                    edge, (point(surfaces_.rest(), corners[a]) - point(surfaces_.rest(), corners[(a + 1) % 3])).norm());
            }
            return weight * edge;
        },
        squares);
}

void Pressure::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    const Stencils<3>& triangles = surfaces_.triangles();
    triangles.carried().move(x, places_);
    double volume = 0, most = 0;
    std::size_t body = 0;
    Vec3 force = Vec3::Zero();
    const auto judge = [&] {
        most = std::max(most, force.norm());
        force.setZero();
    };
    for (std::size_t t = 0; t < triangles.count(); ++t) {
        const Triangle& c = triangles.corners(t);
        if (pieces_.is_closed[at(pieces_.of_point[at(c[0])])]) volume += six_volumes(places_, c, origin_[t]) / 6;
        if (const std::size_t d = surfaces_.deformable()[at(c[0])]; d != body) judge(), body = d;
        const Vec3 area =
            (point(places_, c[1]) - point(places_, c[0])).cross(point(places_, c[2]) - point(places_, c[0]));
        const std::vector<double>& p = surfaces_.values();
        force -= (p[at(c[0])] + p[at(c[1])] + p[at(c[2])]) / 6 * area;
    }
    judge();
    out.push_back({&measures[0], volume});
    out.push_back({&measures[1], most});
}

void Pressure::marks(const Positions& x, Marks& out) const {
    const Stencils<3>& triangles = surfaces_.triangles();
    triangles.carried().move(x, places_);
    MarkGroup group{pressure_type.name, "pressure", "Pa", {}};
    double largest = 0, area = 0;
    for (const double p : surfaces_.values()) largest = std::max(largest, std::abs(p));
    for (std::size_t t = 0; t < triangles.count(); t += surfaces_.shown_step()) {
        const Triangle& c = triangles.corners(t);
        const auto corner = [&](std::size_t i) { return point(places_, c[i]); };
        const double p =
            (surfaces_.values()[at(c[0])] + surfaces_.values()[at(c[1])] + surfaces_.values()[at(c[2])]) / 3;
        const Vec3 across = (corner(1) - corner(0)).cross(corner(2) - corner(0)),
                   middle = (corner(0) + corner(1) + corner(2)) / 3;
        if (p == 0 || !(across.norm() > 0)) continue;
        area += 0.5 * across.norm();
        group.marks.push_back({surfaces_.part(c[0]), middle, across.normalized(), p});
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
