// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/collision_body.h"

#include "solver/sort_into.h"
#include "solver/surface/sampled_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace sinew::solver {

namespace {

/// What carries each vertex of the surface that collides.
std::vector<std::vector<RideTerm>> vertex_rides(const Scene& scene, int body, const ContactRest& rest,
                                                std::size_t vertices) {
    std::vector<std::vector<RideTerm>> out(vertices);
    const TissueRest* tissue = scene.tissue(body);
    for (std::size_t v = 0; v < vertices; ++v) {
        if (!tissue) {
            out[v] = {{static_cast<int>(v), 1.0}};
            continue;
        }
        PointWeights w;
        if (rest.shape) {
            w = rest.shape->carriers[v];
            for (int k = 0; k < w.count; ++k) w.vertex[k] += scene.first_vertex(body);
        } else {
            w = scene.embedded(body, tissue->embedding.tet[v], tissue->embedding.barycentric[v]);
        }
        for (int k = 0; k < w.count; ++k)
            if (w.weight[k] != 0) out[v].push_back({w.vertex[k], w.weight[k]});
    }
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
    triangles_ = rest.shape ? rest.shape->triangles : tissue ? tissue->triangles : scene.bone(body)->triangles;
    vertex_count_ = surface.size();
    carrier_range_ = {deforms_ ? at(scene.first_vertex(body)) : 0, deforms_ ? scene.vertex_count(body) : vertex_count_};
    const std::vector<std::vector<RideTerm>> rides = vertex_rides(scene, body, rest, vertex_count_);

    std::vector<int> all(triangles_.size());
    std::iota(all.begin(), all.end(), 0);
    SampledSurface cut = cut_surface(surface, triangles_, all, {.carriers = {}, .longest_edge = rest.spacing});
    modelled_ = std::move(cut.points);
    fine_ = std::move(cut.triangles);
    // Points between vertices, each from the first of the triangles at it.
    std::vector<std::pair<int, Vec3>> place(modelled_.size(), {-1, Vec3::Zero()});
    for (std::size_t t = 0; t < fine_.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c)
            if (auto& p = place[at(fine_[t][c])]; p.first < 0) p = {cut.source[t], cut.places[t][c]};
    first_term_.push_back(0);
    for (std::size_t p = 0; p < modelled_.size(); ++p) {
        const std::vector<RideTerm> ride =
            p < vertex_count_ ? rides[p] : mixed(rides, triangles_[at(place[p].first)], place[p].second);
        terms_.insert(terms_.end(), ride.begin(), ride.end());
        first_term_.push_back(static_cast<int>(terms_.size()));
    }

    sort_into(vertex_count_, fan_start_, fans_, [&](const auto& visit) {
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (const int v : triangles_[t]) visit(at(v), static_cast<int>(t));
    });
    sort_into(point_count(), fine_fan_start_, fine_fans_, [&](const auto& visit) {
        for (std::size_t t = 0; t < fine_.size(); ++t)
            for (const int v : fine_[t]) visit(at(v), static_cast<int>(t));
    });
    for (const auto& [a, b, c] : fine_)
        fine_areas_.push_back(0.5 *
                              (modelled_[at(b)] - modelled_[at(a)]).cross(modelled_[at(c)] - modelled_[at(a)]).norm());
    find_carriers(place);
    Points low(triangles_.size()), high(triangles_.size());
    double edges = 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const auto [a, b, c] = triangles_[t];
        low[t] = surface[at(a)].cwiseMin(surface[at(b)]).cwiseMin(surface[at(c)]);
        high[t] = surface[at(a)].cwiseMax(surface[at(b)]).cwiseMax(surface[at(c)]);
        for (std::size_t i = 0; i < 3; ++i)
            edges += (surface[at(triangles_[t][i])] - surface[at(triangles_[t][(i + 1) % 3])]).norm();
    }
    mean_edge_ = edges / std::max(1.0, 3 * static_cast<double>(triangles_.size()));
    bvh_ = build_bvh(low, high);
    if (deforms_) {
        rest_areas_.assign(point_count(), 0.0);
        add_areas(fine_, modelled_, rest_areas_);
    }
}

/// \param place of each point that is no vertex: triangle and barycentric coordinates.
void CollisionBody::find_carriers(const std::vector<std::pair<int, Vec3>>& place) {
    carriers_of_point_.resize(point_count()), carriers_at_.resize(triangles_.size());
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
    for (std::size_t v = 0; v < vertex_count_; ++v) {
        std::vector<int> vertices;
        for (const RideTerm& t : ride(static_cast<int>(v))) vertices.push_back(t.vertex);
        tidy(vertices);
        const auto [at_number, is_new] = numbers.try_emplace(vertices, static_cast<int>(carrier_vertices_.size()));
        if (is_new) carrier_vertices_.push_back(vertices);
        carriers_of_point_[v] = {at_number->second};
    }
    for (std::size_t p = vertex_count_; p < point_count(); ++p) {
        for (std::size_t c = 0; c < 3; ++c)
            if (place[p].second[static_cast<Eigen::Index>(c)] != 0)
                carriers_of_point_[p].push_back(carriers_of_point_[at(triangles_[at(place[p].first)][c])].front());
        tidy(carriers_of_point_[p]);
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        for (const int v : triangles_[t]) carriers_at_[t].push_back(carriers_of_point_[at(v)].front());
        tidy(carriers_at_[t]);
    }
}

void CollisionBody::areas(const double* carriers, std::vector<double>& out) const {
    if (deforms_) {
        out = rest_areas_;
        return;
    }
    Points now(point_count());
    for (std::size_t p = 0; p < now.size(); ++p) now[p] = place(static_cast<int>(p), carriers);
    out.assign(point_count(), 0.0);
    add_areas(fine_, now, out);
}

double CollisionBody::facing_area(int point, const Vec3& normal, double whole, const double* carriers) const {
    constexpr double least = 0.05;
    const double length = normal.norm();
    double all = 0, facing = 0;
    for (int i = fine_fan_start_[at(point)]; i < fine_fan_start_[at(point) + 1]; ++i) {
        const std::size_t t = at(fine_fans_[at(i)]);
        const auto [a, b, c] = fine_[t];
        const Vec3 origin = place(a, carriers), n = (place(b, carriers) - origin).cross(place(c, carriers) - origin);
        const double size = n.norm() * length;
        all += fine_areas_[t];
        if (size > 0) facing += fine_areas_[t] * std::max(0.0, -n.dot(normal) / size);
    }
    return all > 0 ? whole * std::max(least, facing / all) : 0;
}

void CollisionBoxes::fit(const CollisionBody& body, const double* carriers) {
    const Bvh& bvh = body.bvh();
    nodes_ = bvh.nodes;
    if (nodes_.empty()) return;
    Points places(body.vertex_count());
    for (std::size_t v = 0; v < places.size(); ++v) places[v] = body.place(static_cast<int>(v), carriers);
    // Children stand behind their parents.
    for (std::size_t n = nodes_.size(); n-- > 0;) {
        BvhNode& node = nodes_[n];
        if (node.count == 0) {
            const BvhNode &one = nodes_[n + 1], &other = nodes_[at(node.first)];
            node.min = one.min.cwiseMin(other.min), node.max = one.max.cwiseMax(other.max);
            continue;
        }
        node.min = Vec3::Constant(1e300), node.max = Vec3::Constant(-1e300);
        for (int i = node.first; i < node.first + node.count; ++i)
            for (const int v : body.triangles()[at(bvh.order[at(i)])])
                node.min = node.min.cwiseMin(places[at(v)]), node.max = node.max.cwiseMax(places[at(v)]);
    }
    low_ = nodes_.front().min, high_ = nodes_.front().max;
}

} // namespace sinew::solver
