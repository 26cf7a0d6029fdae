// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/collision_body.h"

#include "solver/sort_into.h"
#include "solver/surface/sampled_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

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

void add_areas(const std::vector<Triangle>& triangles, const Points& points, std::vector<double>& out) {
    for (const Triangle& t : triangles) {
        const double area =
            0.5 * (points[at(t[1])] - points[at(t[0])]).cross(points[at(t[2])] - points[at(t[0])]).norm();
        for (const int v : t) out[at(v)] += area / 3;
    }
}

} // namespace

CollisionBody::CollisionBody(const Scene& scene, int body, const ContactRest& rest)
    : body_(body)
    , deforms_(scene.tissue(body) != nullptr) {
    const TissueRest* tissue = scene.tissue(body);
    const Points& surface = rest.shape ? rest.shape->surface : tissue ? tissue->surface : scene.bone(body)->surface;
    const std::vector<Triangle>& coarse = rest.shape ? rest.shape->triangles
                                          : tissue   ? tissue->triangles
                                                     : scene.bone(body)->triangles;
    carrier_range_ = {deforms_ ? at(scene.first_vertex(body)) : 0,
                      deforms_ ? scene.vertex_count(body) : surface.size()};
    // A tissue's own surface is made as fine as its tets: a coarse one would press on them like a bed of nails.
    std::optional<CarrierTets> tets;
    SurfaceDensity density{.carriers = {}, .longest_edge = rest.spacing};
    if (tissue && !rest.shape) {
        density.carriers.push_back({&tets.emplace(tissue->tets), tissue->element});
        // Quadratic tets bend between their corners; the border of linear ones is right as it is.
        density.widths = tissue->element == ElementKind::quadratic ? 0.75 : 1.01;
    }
    std::vector<int> all(coarse.size());
    std::iota(all.begin(), all.end(), 0);
    SampledSurface cut = cut_surface(surface, coarse, all, density);
    modelled_ = std::move(cut.points), triangles_ = std::move(cut.triangles);

    std::vector<std::vector<RideTerm>> rides;
    for (std::size_t v = 0; v < surface.size(); ++v) {
        if (rest.shape)
            rides.push_back(ride_of(rest.shape->carriers[v], scene.first_vertex(body)));
        else if (tissue)
            rides.push_back(
                ride_of(scene.embedded(body, tissue->embedding.tet[v], tissue->embedding.barycentric[v]), 0));
        else
            rides.push_back({{static_cast<int>(v), 1.0}});
    }
    // Points between vertices ride on the tets below; else as the first of the triangles at them is carried.
    std::vector<std::pair<int, Vec3>> place(modelled_.size(), {-1, Vec3::Zero()});
    for (std::size_t t = 0; t < triangles_.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c)
            if (auto& p = place[at(triangles_[t][c])]; p.first < 0) p = {cut.source[t], cut.places[t][c]};
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

    sort_into(point_count(), fan_start_, fans_, [&](const auto& visit) {
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (const int v : triangles_[t]) visit(at(v), static_cast<int>(t));
    });
    for (const auto& [a, b, c] : triangles_)
        modelled_areas_.push_back(
            0.5 * (modelled_[at(b)] - modelled_[at(a)]).cross(modelled_[at(c)] - modelled_[at(a)]).norm());
    find_carriers();
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
    if (deforms_) {
        rest_areas_.assign(point_count(), 0.0);
        add_areas(triangles_, modelled_, rest_areas_);
    }
}

void CollisionBody::find_carriers() {
    carriers_of_point_.assign(point_count(), -1), carriers_at_.resize(triangles_.size());
    for (std::size_t p = 0; p < point_count(); ++p) {
        double sum = 0;
        for (const RideTerm& t : ride(static_cast<int>(p))) sum += std::abs(t.weight);
        leverage_ = std::max(leverage_, sum);
    }
    if (!deforms_) return;
    const auto tidy = [](std::vector<int>& v) {
        std::sort(v.begin(), v.end());
        v.erase(std::unique(v.begin(), v.end()), v.end());
    };
    std::map<std::vector<int>, int> numbers;
    for (std::size_t p = 0; p < point_count(); ++p) {
        std::vector<int> vertices;
        for (const RideTerm& t : ride(static_cast<int>(p))) vertices.push_back(t.vertex);
        tidy(vertices);
        const auto [number, is_new] = numbers.try_emplace(vertices, static_cast<int>(carrier_vertices_.size()));
        if (is_new) carrier_vertices_.push_back(vertices);
        carriers_of_point_[p] = number->second;
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        for (const int v : triangles_[t]) carriers_at_[t].push_back(carriers_of_point_[at(v)]);
        tidy(carriers_at_[t]);
    }
}

void CollisionBody::areas(const Points& places, std::vector<double>& out) const {
    if (deforms_) {
        out = rest_areas_;
        return;
    }
    out.assign(point_count(), 0.0);
    add_areas(triangles_, places, out);
}

double CollisionBody::facing_area(int point, const Vec3& normal, double whole, const Points& places) const {
    constexpr double least = 0.05;
    const double length = normal.norm();
    double all = 0, facing = 0;
    for (const int i : fan(point)) {
        const std::size_t t = at(i);
        const auto [a, b, c] = triangles_[t];
        const Vec3 &origin = places[at(a)], n = (places[at(b)] - origin).cross(places[at(c)] - origin);
        const double size = n.norm() * length;
        all += modelled_areas_[t];
        if (size > 0) facing += modelled_areas_[t] * std::max(0.0, -n.dot(normal) / size);
    }
    return all > 0 ? whole * std::max(least, facing / all) : 0;
}

void CollisionBoxes::fit(const CollisionBody& body, const double* carriers) {
    places_.resize(body.point_count());
    for (std::size_t v = 0; v < places_.size(); ++v) places_[v] = body.place(static_cast<int>(v), carriers);
    refit(body.bvh(), nodes_, [&](int triangle, BvhNode& node) {
        for (const int v : body.triangles()[at(triangle)])
            node.min = node.min.cwiseMin(places_[at(v)]), node.max = node.max.cwiseMax(places_[at(v)]);
    });
    low_ = nodes_.front().min, high_ = nodes_.front().max;
}

} // namespace sinew::solver
