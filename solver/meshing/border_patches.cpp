// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/border_patches.h"
#include "solver/joined_sets.h"

#include <Eigen/LU>
#include <cmath>
#include <map>

namespace sinew::solver {

namespace {

const double least_cosine = std::cos(50 * EIGEN_PI / 180);
constexpr std::size_t most_patches = 24;

Vec3 area_vector(const Solid& solid, int triangle) {
    const Triangle& t = solid.triangles[at(triangle)];
    const Vec3& a = solid.points[at(t[0])];
    return 0.5 * (solid.points[at(t[1])] - a).cross(solid.points[at(t[2])] - a);
}

Vec3 unit_normal(const Solid& solid, int triangle) { return area_vector(solid, triangle).normalized(); }

std::vector<Triangle> some_triangles(const Solid& solid, const std::vector<int>& numbers) {
    std::vector<Triangle> out;
    for (const int t : numbers) out.push_back(solid.triangles[at(t)]);
    return out;
}

} // namespace

BorderPatch::BorderPatch(const Solid& solid, std::vector<int> triangles)
    : solid_(&solid)
    , triangles_(std::move(triangles))
    , tree_(solid.points, some_triangles(solid, triangles_))
    , finder_(solid, triangles_) {}

double BorderPatch::height(const Vec3& p) const {
    double sum = 0;
    const std::vector<int> nearest = nearest_to(p);
    // From a corner of the triangle, so that a plane has the same heights wherever its closest points lie.
    for (const int t : nearest)
        sum += (p - solid_->points[at(solid_->triangles[at(t)][0])]).dot(unit_normal(*solid_, t));
    return nearest.empty() ? 0 : sum / static_cast<double>(nearest.size());
}

Vec3 BorderPatch::normal(const Vec3& p) const {
    Vec3 sum = Vec3::Zero();
    for (const int t : nearest_to(p)) sum += unit_normal(*solid_, t);
    return sum.normalized();
}

/// Above an edge or a vertex rounding would choose one of several.
std::vector<int> BorderPatch::nearest_to(const Vec3& p) const {
    std::vector<int> nearest = tree_.all_closest(p, 1e-10 * solid_->box.size().maxCoeff());
    for (int& t : nearest) t = triangles_[at(t)];
    return nearest;
}

double BorderPatch::crossing(const Vec3& a, const Vec3& b) const {
    double low = 0, high = 1, at_low = height(a), at_high = height(b);
    const double near = 1e-13 * (std::abs(at_low) + std::abs(at_high));
    double t = 0.5;
    for (int step = 0; step < 60; ++step) {
        // False position, by halves every third time: heights jump where the closest triangle does.
        t = step % 3 == 2 ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high);
        const double here = height(a + t * (b - a));
        if (std::abs(here) <= near || high - low < 1e-13) break;
        if (std::signbit(here) == std::signbit(at_low))
            low = t, at_low = here;
        else
            high = t, at_high = here;
    }
    return t;
}

std::vector<BorderPatch> border_patches(const Solid& solid) {
    const std::size_t count = solid.triangles.size();
    const auto counts = [&](std::size_t t) {
        const Solid::Sides s = solid.sides[t];
        return (!s.are_known() || s.below == 0 || s.above == 0) && area_vector(solid, static_cast<int>(t)).norm() > 0;
    };
    std::map<std::array<int, 2>, std::vector<int>> at_edge;
    for (std::size_t t = 0; t < count; ++t)
        for (std::size_t k = 0; k < 3 && counts(t); ++k) {
            const int a = solid.triangles[t][k], b = solid.triangles[t][(k + 1) % 3];
            at_edge[{std::min(a, b), std::max(a, b)}].push_back(static_cast<int>(t));
        }
    JoinedSets sets(count);
    const auto join = [&](double cosine) {
        for (const auto& [edge, sharing] : at_edge) {
            if (sharing.size() != 2) continue;
            const Vec3 a = area_vector(solid, sharing[0]), b = area_vector(solid, sharing[1]);
            if (a.dot(b) >= cosine * a.norm() * b.norm()) sets.join(sharing[0], sharing[1]);
        }
    };
    std::map<int, std::vector<int>> parts;
    const auto collect = [&] {
        parts.clear();
        for (std::size_t t = 0; t < count; ++t)
            if (counts(t)) parts[sets.root(static_cast<int>(t))].push_back(static_cast<int>(t));
    };
    join(least_cosine);
    collect();
    if (parts.size() > most_patches) join(-1), collect();
    std::vector<BorderPatch> out;
    for (auto& [first, triangles] : parts) out.emplace_back(solid, std::move(triangles));
    return out;
}

BarycentricPolygon BorderPatch::part_in_tet(const std::array<Vec3, 4>& corners, int triangle) const {
    Mat3 edges;
    edges << corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0];
    const Mat3 inverse = edges.inverse();
    BarycentricPolygon polygon, next;
    for (const int v : solid_->triangles[at(triangle)]) {
        const Vec3 l = inverse * (solid_->points[at(v)] - corners[0]);
        polygon.push_back({1 - l.sum(), l[0], l[1], l[2]});
    }
    for (std::size_t side = 0; side < 4 && !polygon.empty(); ++side) {
        next.clear();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Barycentric &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            if (p[side] >= 0) next.push_back(p);
            if ((p[side] >= 0) == (q[side] >= 0)) continue;
            const double t = p[side] / (p[side] - q[side]);
            Barycentric cut;
            for (std::size_t k = 0; k < 4; ++k) cut[k] = p[k] + t * (q[k] - p[k]);
            next.push_back(cut);
        }
        polygon.swap(next);
    }
    return polygon;
}

} // namespace sinew::solver
