// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/pressure/pressed_tets.h"

#include <algorithm>

namespace sinew::solver {

template <int N>
PressedTets<N>::PressedTets(const Scene& scene, const LayeredSurfaces& surfaces)
    : PressedTets(scene, surfaces, SurfaceTets<N>(surfaces)) {}

template <int N>
PressedTets<N>::PressedTets(const Scene& scene, const LayeredSurfaces& surfaces, SurfaceTets<N> tets)
    : surfaces_(surfaces)
    , rest_(scene.numbering().rest)
    , slot_(std::move(tets.stencil_of_piece))
    , surface_(std::move(tets.surface))
    , point_surface_(std::move(tets.point_surface))
    , stencils_(tets.take_stencils(scene.numbering()))
    , moments_(stencils_.batch_count()) {
    const std::size_t slots = lanes * stencils_.batch_count();
    surface_.resize(slots, surface_.empty() ? 0 : surface_.back());
    for (std::size_t slot = 0; slot < slots; ++slot)
        origin_.push_back(static_cast<int>(
            std::lower_bound(point_surface_.begin(), point_surface_.end(), surface_[slot]) - point_surface_.begin()));
    for (auto* values : {&envelope_, &has_potential_, &size_, &squares_}) values->assign(slots, 0.0);
    is_frozen_.assign(stencils_.point_count(), 0);
    frozen_places_.assign(3 * stencils_.point_count(), 0.0);
    frozen_gradient_.assign(3 * stencils_.point_count(), 0.0);
}

template <int N>
void PressedTets<N>::take_values(const std::vector<char>& has_potential) {
    for (PressureMoments<N>& m : moments_) std::fill_n(&m.m[0][0][0], N * PressureMoments<N>::pairs * lanes, 0.0);
    for (std::size_t s = 0; s < slot_.size(); ++s) {
        const LayeredSurfaces::Surface& surface = surfaces_.surfaces()[s];
        for (std::size_t k = 0; k < slot_[s].size(); ++k) {
            const SurfacePiece& piece = surface.clipped.pieces[k];
            const std::size_t slot = at(slot_[s][k]);
            std::array<double, 3> at_corners;
            for (std::size_t c = 0; c < 3; ++c)
                at_corners[c] = surfaces_.value_at(surface, piece.triangle, piece.place[c]);
            add_moments<N>(piece, at_corners, slot % lanes, moments_[slot / lanes]);
        }
    }
    for (std::size_t slot = 0; slot < has_potential_.size(); ++slot)
        has_potential_[slot] = has_potential[surface_[slot]];
    some_frozen_ = false;
    for (std::size_t p = 0; p < is_frozen_.size(); ++p) {
        is_frozen_[p] = !has_potential[point_surface_[p]];
        some_frozen_ = some_frozen_ || is_frozen_[p];
    }
}

template <int N>
void PressedTets<N>::take_envelopes() {
    for (std::size_t slot = 0; slot < envelope_.size(); ++slot)
        envelope_[slot] = surfaces_.surfaces()[surface_[slot]].envelope;
    rest_energy_ = 0;
    stencils_.move(rest_);
    rest_energy_ = potential_energy(false);
    energy_scale_ = 0;
    for (std::size_t slot = 0; slot < stencils_.count(); ++slot) energy_scale_ += size_[slot];
    stencils_.evaluate(false, [&](std::size_t b, const StencilVectors<N>& x, StencilVectors<N>& g) {
        StencilBlocks<N> h;
        pressure_hessian<N>(moments_[b], from_first(x), h);
        Pack sum(0.0);
        for (const PackMatrix& block : h)
            for (const Pack& entry : block) sum += entry * entry;
        const Pack envelope = Pack::load(envelope_.data() + b * lanes);
        (envelope * envelope * sum).store(squares_.data() + b * lanes);
        for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
        return Pack(0.0);
    });
}

template <int N>
double PressedTets<N>::frozen_work() const {
    const std::span<const double> places = stencils_.places();
    return ordered_sum(is_frozen_.size(), [&](std::size_t p) {
        double work = 0;
        for (std::size_t c = 3 * p; is_frozen_[p] && c < 3 * p + 3; ++c)
            work += frozen_gradient_[c] * (places[c] - frozen_places_[c]);
        return work;
    });
}

template <int N>
double PressedTets<N>::freeze() {
    if (!some_frozen_) return 0;
    const double before = frozen_work();
    potential_energy(true);
    std::copy(stencils_.places().begin(), stencils_.places().end(), frozen_places_.begin());
    std::copy(stencils_.by_points().begin(), stencils_.by_points().end(), frozen_gradient_.begin());
    return -before;
}

template <int N>
double PressedTets<N>::potential_energy(bool with_forces) {
    const std::span<const double> places = std::as_const(stencils_).places();
    const double energy =
        stencils_.evaluate(with_forces, [&](std::size_t b, const StencilVectors<N>& x, StencilVectors<N>& g) {
            PackVector origin;
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const double* o = places.data() + 3 * at(origin_[b * lanes + lane]);
                origin.x.v[lane] = o[0], origin.y.v[lane] = o[1], origin.z.v[lane] = o[2];
            }
            pressure_gradient<N>(moments_[b], from_first(x), g);
            const Pack envelope = Pack::load(envelope_.data() + b * lanes);
            Pack work(0.0);
            for (std::size_t a = 0; a < N; ++a) {
                g[a] = envelope * g[a];
                work += dot(x[a] - origin, g[a]);
            }
            // The volume is a third of the integral of x along the normal.
            const Pack share = Pack(1.0 / 3) * Pack::load(has_potential_.data() + b * lanes) * work;
            abs(share).store(size_.data() + b * lanes);
            return share;
        });
    return energy - rest_energy_;
}

template <int N>
double PressedTets<N>::energy(bool with_forces) {
    return potential_energy(with_forces) + (some_frozen_ ? frozen_work() : 0);
}

template <int N>
void PressedTets<N>::add_hessian(BlockMatrix& a) {
    stencils_.add_hessian(
        [&](std::size_t b, const StencilVectors<N>& x, StencilBlocks<N>& h) {
            const Pack envelope = Pack::load(envelope_.data() + b * lanes);
            StencilVectors<N> y = from_first(x);
            for (PackVector& v : y) v = envelope * v; // blocks are linear in places
            pressure_hessian<N>(moments_[b], y, h);
        },
        a);
}

template <int N>
void PressedTets<N>::add_net_forces(std::vector<Vec3>& forces) const {
    const std::span<const double> g = stencils_.by_points();
    for (std::size_t p = 0; p < stencils_.point_count(); ++p)
        forces[point_surface_[p]] -= Vec3(g[3 * p], g[3 * p + 1], g[3 * p + 2]);
}

template <int N>
void PressedTets<N>::add_squared_stiffnesses(std::span<double> squares) const {
    for (std::size_t slot = 0; slot < stencils_.count(); ++slot)
        squares[surfaces_.surfaces()[surface_[slot]].deformable] += squares_[slot];
}

template class PressedTets<3>;
template class PressedTets<4>;
template class PressedTets<quadratic_nodes>;

} // namespace sinew::solver
