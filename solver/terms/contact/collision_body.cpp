// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/collision_body.h"

#include "solver/parallel.h"

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
    : CarriedSurface(scene, body, rest.spacing, shape_of(rest))
    , has_two_sides_(scene.cloth(body) != nullptr) {
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

std::vector<std::vector<int>> CollisionBody::elsewhere(double apart) const {
    std::vector<std::vector<int>> out(point_count());
    parallel_for(out.size(), 64, [&](std::size_t p) {
        const Vec3& from = modelled(static_cast<int>(p));
        const auto is_near = [&](int triangle) {
            return std::ranges::any_of(triangles()[at(triangle)],
                                       [&](int v) { return (modelled(v) - from).squaredNorm() < apart * apart; });
        };
        std::vector<int> near; // triangles, then of them those that the point's own are connected to
        int stack[128];        // the tree of 2^31 triangles is 30 levels deep
        int depth = 0;
        if (!bvh().nodes.empty()) stack[depth++] = 0;
        while (depth > 0) {
            const int n = stack[--depth];
            const BvhNode& node = bvh().nodes[at(n)];
            if (squared_distance(node, from) >= apart * apart) continue;
            if (node.count == 0) {
                stack[depth++] = n + 1, stack[depth++] = node.first;
                continue;
            }
            for (int i = node.first; i < node.first + node.count; ++i)
                if (const int t = bvh().order[at(i)]; is_near(t)) near.push_back(t);
        }
        std::sort(near.begin(), near.end());
        std::vector<int> own(fan(static_cast<int>(p)).begin(), fan(static_cast<int>(p)).end());
        std::vector<char> reached(near.size(), 0);
        while (!own.empty()) {
            const int t = own.back();
            own.pop_back();
            const auto found = std::lower_bound(near.begin(), near.end(), t);
            if (found == near.end() || *found != t || reached[at(found - near.begin())]) continue;
            reached[at(found - near.begin())] = 1;
            for (const int v : triangles()[at(t)])
                if ((modelled(v) - from).squaredNorm() < apart * apart)
                    own.insert(own.end(), fan(v).begin(), fan(v).end());
        }
        for (std::size_t i = 0; i < near.size(); ++i)
            if (!reached[i]) out[p].push_back(near[i]);
    });
    return out;
}

bool CollisionBody::is_at_rim(int triangle, const Vec3& place) const {
    int on[3], count = 0;
    for (int c = 0; c < 3; ++c)
        if (place[c] != 0) on[count++] = triangles()[at(triangle)][at(c)];
    if (count == 3) return false;
    const auto faces = [&](int v, int w) {
        return std::ranges::count_if(fan(v), [&](int t) { return has_vertex(triangles()[at(t)], w); });
    };
    if (count == 2) return faces(on[0], on[1]) < 2;
    for (const int t : fan(on[0]))
        for (const int v : triangles()[at(t)])
            if (v != on[0] && faces(on[0], v) < 2) return true;
    return false;
}

void CollisionBody::areas(const Points& places, std::vector<double>& out) const {
    if (deforms()) {
        out = rest_areas_;
        return;
    }
    out.assign(point_count(), 0.0);
    add_areas(triangles(), places, out);
}

double CollisionBody::facing_area(int point, const Vec3& normal, double past, double whole,
                                  const Points& places) const {
    constexpr double least = 0.05;
    const auto unit = [](const Vec3& v) {
        const double length = v.norm();
        return length > 0 ? Vec3(v / length) : Vec3(Vec3::Zero());
    };
    const auto normal_of = [&](int t) {
        const auto [a, b, c] = triangles()[at(t)];
        return unit((places[at(b)] - places[at(a)]).cross(places[at(c)] - places[at(a)]));
    };
    const Vec3 towards = -unit(normal);
    double all = 0, facing = 0, best = -1, widest = 0;
    for (const int t : fan(point)) {
        const Vec3 n = normal_of(t);
        const double area = modelled_areas_[at(t)], along = n.dot(towards),
                     cosine = has_two_sides_ ? std::abs(along) : along;
        all += area, facing += area * std::max(0.0, cosine), best = std::max(best, cosine);
        double alike = 0; // what looks the same way
        for (const int other : fan(point)) alike += modelled_areas_[at(other)] * std::max(0.0, n.dot(normal_of(other)));
        widest = std::max(widest, alike);
    }
    if (all <= 0) return 0;
    return whole * std::clamp((facing + past * (1 - std::abs(best)) * widest) / all, least, 1.0);
}

} // namespace sinew::solver
