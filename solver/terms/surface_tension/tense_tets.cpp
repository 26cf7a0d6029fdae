// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/surface_tension/tense_tets.h"

#include "solver/surface/piece_shape.h"
#include "solver/surface/sampled_surface.h"
#include "solver/surface/triangle_rule.h"
#include "solver/terms/surface_tension/tension_triangle.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sinew::solver {

template <int N>
TenseTets<N>::TenseTets(const Scene& scene, const LayeredSurfaces& surfaces)
    : TenseTets(scene, surfaces, SurfaceTets<N>(surfaces)) {}

template <int N>
TenseTets<N>::TenseTets(const Scene& scene, const LayeredSurfaces& surfaces, SurfaceTets<N> tets)
    : surfaces_(surfaces)
    , surface_(std::move(tets.surface))
    , stencils_(tets.take_stencils(scene.numbering())) {
    struct Found {
        std::size_t slot;
        PieceShape<N> shape;
        double share;
        int triangle;
        Vec3 place;
    };
    std::vector<Found> found;
    std::vector<std::size_t> count(stencils_.count(), 0); // of a tet's facets
    for (std::size_t s = 0; s < tets.stencil_of_piece.size(); ++s) {
        if (tets.stencil_of_piece[s].empty()) continue;
        const LayeredSurfaces::Surface& surface = surfaces.surfaces()[s];
        const TissueRest* tissue = scene.tissue(surface.body);
        std::optional<CarrierTets> carriers;
        SurfaceDensity density;
        if (tissue) density.carriers.push_back({&carriers.emplace(tissue->tets), tissue->element});
        const Points& points = scene.surface(surface.body);
        const std::vector<Triangle>& triangles = scene.triangles(surface.body);
        for (std::size_t k = 0; k < surface.clipped.pieces.size(); ++k) {
            const SurfacePiece& piece = surface.clipped.pieces[k];
            Vec3 corner[3];
            for (std::size_t c = 0; c < 3; ++c) {
                corner[c].setZero();
                for (int i = 0; i < 3; ++i)
                    corner[c] += piece.place[c][i] * points[at(triangles[at(piece.triangle)][at(i)])];
            }
            const int degree = N <= 4 ? 1 : density.degree(corner[0], corner[1], corner[2]);
            const auto slot = at(tets.stencil_of_piece[s][k]);
            for (const RulePoint& q : triangle_rule(degree)) {
                const Vec3 place =
                    q.place[0] * piece.place[0] + q.place[1] * piece.place[1] + q.place[2] * piece.place[2];
                found.push_back({slot, PieceShape<N>(piece, q.place), q.share, piece.triangle, place});
                ++count[slot];
            }
        }
    }
    first_.push_back(0);
    for (std::size_t b = 0; b < stencils_.batch_count(); ++b) {
        std::size_t most = 0;
        for (std::size_t slot = lanes * b; slot < std::min(lanes * (b + 1), count.size()); ++slot)
            most = std::max(most, count[slot]);
        first_.push_back(first_.back() + most);
    }
    facets_.resize(first_.back());
    std::fill(count.begin(), count.end(), 0);
    for (const Found& f : found) {
        const std::size_t lane = f.slot % lanes;
        Facets& facets = facets_[first_[f.slot / lanes] + count[f.slot]++];
        for (std::size_t a = 0; a < N; ++a) facets.u[a][lane] = f.shape.u[a], facets.v[a][lane] = f.shape.v[a];
        facets.share[lane] = f.share, facets.triangle[lane] = f.triangle, facets.place[lane] = f.place;
    }
    squares_.assign(stencils_.count(), 0.0);
    find_rest_areas(scene.numbering().rest);
}

template <int N>
void TenseTets<N>::find_rest_areas(const std::vector<double>& rest) {
    stencils_.move(rest);
    stencils_.evaluate(false, [&](std::size_t b, const StencilVectors<N>& x, StencilVectors<N>& g) {
        for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
        for (std::size_t f = first_[b]; f < first_[b + 1]; ++f) {
            const StencilVectors<3> y = spanned(facets_[f], x);
            const PackVector n = Pack(0.5) * cross(y[1], y[2]);
            sqrt(dot(n, n)).store(facets_[f].rest_area);
        }
        return Pack(0.0);
    });
    double sum = 0, count = 0;
    const auto for_each = [&](const auto& what) {
        for (std::size_t b = 0; b + 1 < first_.size(); ++b)
            for (std::size_t f = first_[b]; f < first_[b + 1]; ++f)
                for (std::size_t lane = 0; lane < lanes; ++lane)
                    if (facets_[f].share[lane] > 0) what(facets_[f], lane);
    };
    for_each([&](const Facets& f, std::size_t lane) { sum += f.rest_area[lane], ++count; });
    for_each([&](Facets& f, std::size_t lane) {
        f.rounding[lane] = 1e-7 * std::max(f.rest_area[lane], 1e-6 * sum / count);
    });
}

template <int N>
void TenseTets<N>::take() {
    rest_energy_ = energy_scale_ = 0;
    for (std::size_t slot = 0; slot < stencils_.count(); ++slot) {
        const LayeredSurfaces::Surface& surface = surfaces_.surfaces()[surface_[slot]];
        const std::size_t b = slot / lanes, lane = slot % lanes;
        squares_[slot] = 0;
        for (std::size_t k = first_[b]; k < first_[b + 1]; ++k) {
            Facets& f = facets_[k];
            if (f.share[lane] == 0) continue;
            f.tension[lane] =
                f.share[lane] * surface.envelope * surfaces_.value_at(surface, f.triangle[lane], f.place[lane]);
            rest_energy_ += f.tension[lane] * f.rest_area[lane];
            energy_scale_ += std::abs(f.tension[lane]) * f.rest_area[lane];
            squares_[slot] += f.tension[lane] * f.tension[lane];
        }
    }
}

template <int N>
double TenseTets<N>::energy(bool with_forces) {
    const double energy =
        stencils_.evaluate(with_forces, [&](std::size_t b, const StencilVectors<N>& x, StencilVectors<N>& g) {
            Pack sum(0.0);
            for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
            for (std::size_t k = first_[b]; k < first_[b + 1]; ++k) {
                const Facets& f = facets_[k];
                const TensionTriangle facet(spanned(f, x), Pack::load(f.rounding));
                const Pack tension = Pack::load(f.tension);
                sum += tension * facet.area;
                if (!with_forces) continue;
                StencilVectors<3> by_corners;
                facet.gradient(tension, by_corners);
                for (std::size_t a = 0; a < N; ++a)
                    g[a] = g[a] + Pack::load(f.u[a]) * by_corners[1] + Pack::load(f.v[a]) * by_corners[2];
            }
            return sum;
        });
    return energy - rest_energy_;
}

template <int N>
void TenseTets<N>::add_hessian(bool project, BlockMatrix& a) {
    stencils_.add_hessian(
        [&](std::size_t batch, const StencilVectors<N>& x, StencilBlocks<N>& h) {
            for (PackMatrix& block : h) block.fill(Pack(0.0));
            for (std::size_t k = first_[batch]; k < first_[batch + 1]; ++k) {
                const Facets& f = facets_[k];
                const TensionTriangle facet(spanned(f, x), Pack::load(f.rounding));
                StencilBlocks<3> by_corners;
                facet.hessian(Pack::load(f.tension), project, by_corners);
                const PackMatrix &uu = by_corners[3], &uv = by_corners[4], &vv = by_corners[5];
                std::size_t pair = 0;
                for (std::size_t i = 0; i < N; ++i) {
                    // By node i and along u and v.
                    const Pack u = Pack::load(f.u[i]), v = Pack::load(f.v[i]);
                    PackMatrix along_u, along_v;
                    for (std::size_t r = 0; r < 3; ++r)
                        for (std::size_t c = 0; c < 3; ++c) {
                            along_u[3 * r + c] = u * uu[3 * r + c] + v * uv[3 * c + r];
                            along_v[3 * r + c] = u * uv[3 * r + c] + v * vv[3 * r + c];
                        }
                    for (std::size_t j = i; j < N; ++j, ++pair)
                        for (std::size_t d = 0; d < 9; ++d)
                            h[pair][d] += Pack::load(f.u[j]) * along_u[d] + Pack::load(f.v[j]) * along_v[d];
                }
            }
        },
        a);
}

template <int N>
void TenseTets<N>::add_squared_stiffnesses(std::span<double> squares) const {
    for (std::size_t slot = 0; slot < stencils_.count(); ++slot)
        squares[surfaces_.surfaces()[surface_[slot]].deformable] += squares_[slot];
}

template <int N>
double TenseTets<N>::area() {
    return stencils_.evaluate(false, [&](std::size_t b, const StencilVectors<N>& x, StencilVectors<N>& g) {
        Pack sum(0.0);
        for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
        for (std::size_t k = first_[b]; k < first_[b + 1]; ++k) {
            const StencilVectors<3> y = spanned(facets_[k], x);
            const PackVector n = Pack(0.5) * cross(y[1], y[2]);
            sum += Pack::load(facets_[k].share) * sqrt(dot(n, n));
        }
        return sum;
    });
}

template class TenseTets<3>;
template class TenseTets<4>;
template class TenseTets<quadratic_nodes>;

} // namespace sinew::solver
