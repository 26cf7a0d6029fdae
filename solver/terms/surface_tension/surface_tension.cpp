// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/surface_tension/surface_tension.h"

#include "solver/surface/piece_shape.h"
#include "solver/surface/sampled_surface.h"
#include "solver/surface/triangle_rule.h"
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
    .numerics = 2,
    .values = values,
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        return LayeredSurfaces::used(scene, surface_tension_type) ? std::make_unique<SurfaceTension>(scene) : nullptr;
    },
};

namespace {

/// A triangle whose area counts, by its corners among the points that ride on tets.
template <int N>
void add_facets(const LayeredSurfaces& surfaces, const LayeredSurfaces::Surface& surface, const SurfacePiece& piece,
                int degree, std::vector<PointWeights>& points, std::vector<double>& shares, std::vector<Vec3>& places) {
    const auto nodes = surfaces.nodes(surface, piece.tet);
    for (const RulePoint& q : triangle_rule(degree)) {
        const PieceShape<N> s(piece, q.place);
        for (int corner = 0; corner < 3; ++corner) {
            PointWeights& p = points.emplace_back();
            p.count = N;
            for (std::size_t n = 0; n < N; ++n) {
                p.vertex[n] = nodes[n];
                p.weight[n] = s.value[n] + (corner == 1 ? s.u[n] : corner == 2 ? s.v[n] : 0);
            }
        }
        shares.push_back(q.share);
        places.emplace_back(q.place[0] * piece.place[0] + q.place[1] * piece.place[1] + q.place[2] * piece.place[2]);
    }
}

} // namespace

SurfaceTension::SurfaceTension(const Scene& scene)
    : surfaces_(scene, surface_tension_type) {
    std::vector<PointWeights> points;
    std::vector<int> carrier;
    int first_tet = 0;
    for (std::size_t k = 0; k < surfaces_.surfaces().size(); ++k) {
        const LayeredSurfaces::Surface& surface = surfaces_.surfaces()[k];
        const TissueRest& tissue = *scene.tissue(surface.body);
        const CarrierTets tets(tissue.tets);
        const SurfaceDensity density{{{&tets, tissue.element}}};
        for (const SurfacePiece& piece : surface.clipped.pieces) {
            const Triangle& t = tissue.triangles[at(piece.triangle)];
            const auto corner = [&](std::size_t c) {
                Vec3 p = Vec3::Zero();
                for (int i = 0; i < 3; ++i) p += piece.place[c][i] * tissue.surface[at(t[at(i)])];
                return p;
            };
            if (tissue.element == ElementKind::linear)
                add_facets<4>(surfaces_, surface, piece, 1, points, share_, place_);
            else
                add_facets<quadratic_nodes>(surfaces_, surface, piece, density.degree(corner(0), corner(1), corner(2)),
                                            points, share_, place_);
            surface_.resize(share_.size(), k);
            triangle_.resize(share_.size(), piece.triangle);
            carrier.resize(points.size(), first_tet + piece.tet);
        }
        first_tet += static_cast<int>(tissue.tets.tets.size());
    }
    std::vector<Triangle> facets;
    for (int f = 0; f < static_cast<int>(share_.size()); ++f) facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    facets_ = std::make_unique<Stencils<3>>(scene.numbering(), points, carrier, std::move(facets));
    places_.assign(3 * facets_->point_count(), 0.0);
    vertex_places_.assign(3 * surfaces_.vertex_count(), 0.0);
    facets_->carried().move(scene.numbering().rest, places_);
    const std::size_t slots = lanes * facets_->batch_count();
    tension_.assign(slots, 0.0);
    for (std::size_t slot = 0; slot < slots; ++slot) rest_area_.push_back(area_of(places_, facets_->corners(slot)));
    const double mean = ordered_sum(facets_->count(), [&](std::size_t t) { return rest_area_[t]; }) /
                        static_cast<double>(std::max<std::size_t>(facets_->count(), 1));
    for (const double area : rest_area_) rounding_.push_back(1e-7 * std::max(area, 1e-6 * mean));
}

Changes SurfaceTension::take(const StepInputs& inputs, const State&) {
    const LayeredSurfaces::Taken taken = surfaces_.take(inputs);
    if (!taken.values && !taken.envelopes) return {};
    rest_energy_ = energy_scale_ = 0;
    for (std::size_t f = 0; f < facets_->count(); ++f) {
        const LayeredSurfaces::Surface& surface = surfaces_.surfaces()[surface_[f]];
        tension_[f] = share_[f] * surface.envelope * surfaces_.value_at(surface, triangle_[f], place_[f]);
        rest_energy_ += tension_[f] * rest_area_[f];
        energy_scale_ += std::abs(tension_[f]) * rest_area_[f];
    }
    return {};
}

double SurfaceTension::energy(const Positions& x, bool with_forces) {
    if (!acts()) return 0;
    facets_->move(x);
    const double energy =
        facets_->evaluate(with_forces, [&](std::size_t b, const StencilVectors<3>& x, StencilVectors<3>& g) {
            const TensionTriangle triangle(x, Pack::load(rounding_.data() + b * lanes));
            const Pack tension = Pack::load(tension_.data() + b * lanes);
            triangle.gradient(tension, g);
            return tension * triangle.area;
        });
    if (with_forces) facets_->carry_gradient();
    return energy - rest_energy_;
}

void SurfaceTension::add_gradient(std::span<double> gradient) const {
    if (acts()) facets_->add_gradient(gradient);
}

void SurfaceTension::add_held_gradient(std::span<double> gradient) const {
    if (acts()) facets_->add_held_gradient(gradient);
}

void SurfaceTension::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    if (!acts()) return;
    facets_->move(x);
    facets_->add_hessian(
        [&](std::size_t b, const StencilVectors<3>& x, StencilBlocks<3>& h) {
            const TensionTriangle triangle(x, Pack::load(rounding_.data() + b * lanes));
            triangle.hessian(Pack::load(tension_.data() + b * lanes), project, h);
        },
        a);
}

void SurfaceTension::raise_forces_at_work(const Positions&, std::span<double> largest) const {
    if (!acts()) return;
    squares_.assign(largest.size(), 0.0);
    facets_->carried().add_squared_gradient(squares_);
    for (std::size_t d = 0; d < largest.size(); ++d) largest[d] = std::max(largest[d], std::sqrt(squares_[d]));
}

void SurfaceTension::add_squared_stiffnesses(std::span<double> squares) const {
    if (!acts()) return;
    for (std::size_t f = 0; f < facets_->count(); ++f)
        squares[surfaces_.surfaces()[surface_[f]].deformable] += tension_[f] * tension_[f];
}

void SurfaceTension::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    facets_->carried().move(x, places_);
    double area = 0;
    for (std::size_t f = 0; f < facets_->count(); ++f) area += share_[f] * area_of(places_, facets_->corners(f));
    out.push_back({&measures[0], area});
}

void SurfaceTension::marks(const Positions& x, Marks& out) const {
    surfaces_.move(x, vertex_places_);
    MarkGroup group{surface_tension_type.name, "tension", "N/m", {}};
    for (std::size_t t = 0; t < surfaces_.triangles().size(); t += surfaces_.shown_step()) {
        const LayeredSurfaces::Surface& surface = surfaces_.surface_of(t);
        Vec3 middle = Vec3::Zero();
        double tension = 0;
        for (const int c : surfaces_.triangles()[t]) {
            middle += Eigen::Map<const Vec3>(vertex_places_.data() + 3 * at(c)) / 3;
            tension += surface.envelope * surfaces_.values()[at(c)] / 3;
        }
        if (tension != 0) group.marks.push_back({static_cast<int>(surface.part), middle, middle, tension});
    }
    out.push_back(std::move(group));
}

} // namespace sinew::solver
