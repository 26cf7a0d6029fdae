// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/carried_surface.h"

#include "solver/sort_into.h"
#include "solver/surface/sampled_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sinew::solver {

namespace {

std::vector<RideTerm> ride_of(const PointWeights& w, int first_vertex) {
    std::vector<RideTerm> out;
    for (int k = 0; k < w.count; ++k)
        if (w.weight[k] != 0) out.push_back({w.vertex[k] + first_vertex, w.weight[k]});
    return out;
}

/// The sum of some rides, each vertex once, by rising number.
std::vector<RideTerm> mixed(const std::vector<std::vector<RideTerm>>& rides, const Triangle& corners,
                            const Vec3& place) {
    std::vector<RideTerm> all;
    for (int c = 0; c < 3; ++c)
        for (const RideTerm& t : rides[at(corners[at(c)])])
            if (place[c] != 0) all.push_back({t.vertex, place[c] * t.weight});
    std::stable_sort(all.begin(), all.end(), [](const RideTerm& a, const RideTerm& b) { return a.vertex < b.vertex; });
    std::vector<RideTerm> out;
    for (const RideTerm& t : all) {
        if (!out.empty() && out.back().vertex == t.vertex)
            out.back().weight += t.weight;
        else
            out.push_back(t);
    }
    return out;
}

} // namespace

CarriedSurface::CarriedSurface(const Scene& scene, int body, double longest_edge,
                               const std::optional<SurfaceInPlace>& instead)
    : body_(body)
    , deforms_(scene.deforms(body)) {
    make_triangles(scene, longest_edge, instead);
    make_search_tree();
}

void CarriedSurface::make_triangles(const Scene& scene, double longest_edge,
                                    const std::optional<SurfaceInPlace>& instead) {
    const int body = body_;
    const TissueRest* tissue = scene.tissue(body);
    const Points& surface = instead ? instead->points : scene.surface(body);
    const std::vector<Triangle>& coarse = instead ? instead->triangles : scene.triangles(body);
    carrier_range_ = {deforms_ ? at(scene.first_vertex(body)) : 0,
                      deforms_ ? scene.vertex_count(body) : surface.size()};
    // A tissue's own surface is made as fine as its tets: a coarse one would press on them like a bed of nails.
    std::optional<CarrierTets> tets;
    SurfaceDensity density{.carriers = {}, .longest_edge = longest_edge};
    if (tissue && !instead) {
        density.carriers.push_back({&tets.emplace(tissue->tets), tissue->element});
        // Quadratic tets bend between their corners; the border of linear ones is right as it is.
        density.widths = tissue->element == ElementKind::quadratic ? 0.75 : 1.01;
    }
    std::vector<int> all(coarse.size());
    std::iota(all.begin(), all.end(), 0);
    SampledSurface cut = cut_surface(surface, coarse, all, density);
    modelled_ = std::move(cut.points), triangles_ = std::move(cut.triangles), parts_of_ = std::move(cut.source);

    std::vector<std::vector<RideTerm>> rides;
    for (std::size_t v = 0; v < surface.size(); ++v) {
        if (instead)
            rides.push_back(ride_of(instead->carriers[v], scene.first_vertex(body)));
        else if (tissue)
            rides.push_back(
                ride_of(scene.embedded(body, tissue->embedding.tet[v], tissue->embedding.barycentric[v]), 0));
        else
            rides.push_back({{static_cast<int>(v) + (deforms_ ? scene.first_vertex(body) : 0), 1.0}});
    }
    // Points between vertices ride on the tets below; else as the first of the triangles at them is carried.
    std::vector<std::pair<int, Vec3>> place(modelled_.size(), {-1, Vec3::Zero()});
    for (std::size_t t = 0; t < triangles_.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c)
            if (auto& p = place[at(triangles_[t][c])]; p.first < 0) p = {parts_of_[t], cut.places[t][c]};
    for (std::size_t p = surface.size(); p < modelled_.size(); ++p) {
        if (tets) {
            std::array<double, 4> inside;
            const int tet = tets->locate(modelled_[p], inside);
            rides.push_back(ride_of(scene.embedded(body, tet, inside), 0));
        } else {
            rides.push_back(mixed(rides, coarse[at(place[p].first)], place[p].second));
        }
    }
    first_term_.push_back(0);
    for (const std::vector<RideTerm>& ride : rides) {
        terms_.insert(terms_.end(), ride.begin(), ride.end());
        first_term_.push_back(static_cast<int>(terms_.size()));
    }
    for (std::size_t p = 0; p < point_count(); ++p) {
        double sum = 0;
        for (const RideTerm& t : ride(static_cast<int>(p))) sum += std::abs(t.weight);
        leverage_ = std::max(leverage_, sum);
    }
}

void CarriedSurface::make_search_tree() {
    sort_into(point_count(), fan_start_, fans_, [&](const auto& visit) {
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (const int v : triangles_[t]) visit(at(v), static_cast<int>(t));
    });
    Points low(triangles_.size()), high(triangles_.size());
    double edges = 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const auto [a, b, c] = triangles_[t];
        low[t] = modelled_[at(a)].cwiseMin(modelled_[at(b)]).cwiseMin(modelled_[at(c)]);
        high[t] = modelled_[at(a)].cwiseMax(modelled_[at(b)]).cwiseMax(modelled_[at(c)]);
        for (std::size_t i = 0; i < 3; ++i)
            edges += (modelled_[at(triangles_[t][i])] - modelled_[at(triangles_[t][(i + 1) % 3])]).norm();
    }
    mean_edge_ = edges / std::max(1.0, 3 * static_cast<double>(triangles_.size()));
    bvh_ = build_bvh(low, high);
}

void SurfaceBoxes::fit(const CarriedSurface& surface, const double* carriers) {
    places_.resize(surface.point_count());
    for (std::size_t v = 0; v < places_.size(); ++v) places_[v] = surface.place(static_cast<int>(v), carriers);
    refit(surface.bvh(), nodes_, [&](int triangle, BvhNode& node) {
        for (const int v : surface.triangles()[at(triangle)])
            node.min = node.min.cwiseMin(places_[at(v)]), node.max = node.max.cwiseMax(places_[at(v)]);
    });
    low_ = nodes_.front().min, high_ = nodes_.front().max;
}

} // namespace sinew::solver
