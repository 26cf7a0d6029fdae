// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/collision_body.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sinew::solver {

namespace {

void add_areas(const std::vector<Triangle>& triangles, const Points& points, std::vector<double>& out) {
    for (const Triangle& t : triangles) {
        const double area =
            0.5 * (points[at(t[1])] - points[at(t[0])]).cross(points[at(t[2])] - points[at(t[0])]).norm();
        for (const int v : t) out[at(v)] += area / 3;
    }
}

std::optional<SurfaceInPlace> shape_of(const ContactRest& rest) {
    if (!rest.shape) return {};
    return SurfaceInPlace{rest.shape->surface, rest.shape->triangles, rest.shape->carriers};
}

} // namespace

CollisionBody::CollisionBody(const Scene& scene, int body, const ContactRest& rest)
    : CarriedSurface(scene, body, rest.spacing, shape_of(rest)) {
    for (const auto& [a, b, c] : triangles())
        modelled_areas_.push_back(0.5 * (modelled(b) - modelled(a)).cross(modelled(c) - modelled(a)).norm());
    find_carriers();
    if (!deforms()) return;
    rest_areas_.assign(point_count(), 0.0);
    add_areas(triangles(), modelled(), rest_areas_);
}

void CollisionBody::find_carriers() {
    carriers_of_point_.assign(point_count(), -1), carriers_at_.resize(triangles().size());
    if (!deforms()) return;
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
    for (std::size_t t = 0; t < triangles().size(); ++t) {
        for (const int v : triangles()[t]) carriers_at_[t].push_back(carriers_of_point_[at(v)]);
        tidy(carriers_at_[t]);
    }
}

void CollisionBody::areas(const Points& places, std::vector<double>& out) const {
    if (deforms()) {
        out = rest_areas_;
        return;
    }
    out.assign(point_count(), 0.0);
    add_areas(triangles(), places, out);
}

double CollisionBody::facing_area(int point, const Vec3& normal, double whole, const Points& places) const {
    constexpr double least = 0.05;
    const double length = normal.norm();
    double all = 0, facing = 0;
    for (const int i : fan(point)) {
        const std::size_t t = at(i);
        const auto [a, b, c] = triangles()[t];
        const Vec3 &origin = places[at(a)], n = (places[at(b)] - origin).cross(places[at(c)] - origin);
        const double size = n.norm() * length;
        all += modelled_areas_[t];
        if (size > 0) facing += modelled_areas_[t] * std::max(0.0, -n.dot(normal) / size);
    }
    return all > 0 ? whole * std::max(least, facing / all) : 0;
}

} // namespace sinew::solver
