// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/closest_feature.h"

#include "solver/mesh/triangle_math.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::solver {

namespace {

NearestPlace nearest_of(const CarriedSurface& surface, const Points& places, int triangle, const Vec3& p) {
    const TrianglePoint q =
        closest_on_triangle(p, surface.corners(triangle, places), surface.triangles()[at(triangle)]);
    return {triangle, q.barycentric, q.point, (p - q.point).squaredNorm()};
}

/// The corners that carry a place.
struct Corners {
    int count = 0;
    int vertex[3] = {-1, -1, -1};
};

Corners corners_of(const Triangle& t, const Vec3& place) {
    Corners out;
    for (std::size_t c = 0; c < 3; ++c)
        if (place[static_cast<Eigen::Index>(c)] != 0) out.vertex[out.count++] = t[c];
    return out;
}

/// Mean normal of the faces about an edge or vertex, weighed by their angles there (Baerentzen and Aanaes 2005): its
/// sign against the way to a point says on which side of a closed surface that is.
Vec3 mean_normal(const CarriedSurface& surface, const Points& places, const Corners& on) {
    Vec3 sum = Vec3::Zero();
    for (const int t : surface.fan(on.vertex[0])) {
        const Triangle& corners = surface.triangles()[at(t)];
        if (on.count == 2 && !has_vertex(corners, on.vertex[1])) continue;
        const Vec3 n = face_normal(surface, places, t);
        if (on.count == 2) {
            sum += n;
            continue;
        }
        const std::array<Vec3, 3> c = surface.corners(t, places);
        std::size_t k = 0;
        while (corners[k] != on.vertex[0]) ++k;
        const Vec3 u = c[(k + 1) % 3] - c[k], v = c[(k + 2) % 3] - c[k];
        sum += std::atan2(u.cross(v).norm(), u.dot(v)) * n;
    }
    return sum;
}

/// Whether a place is so much nearer than its triangle's border that no triangle about it, even if it folds back below,
/// can be nearer. Where not, those at its corners must be asked, not just those that share the edge that it lies on:
/// a point that leaves by another face than it came in by would else feel its force until it is out, and lose it all
/// at once.
bool surely_nearest(const CarriedSurface& surface, const Points& places, const NearestPlace& place) {
    const std::array<Vec3, 3> c = surface.corners(place.triangle, places);
    const double twice_area = (c[1] - c[0]).cross(c[2] - c[0]).norm();
    double to_border = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k)
        to_border = std::min(to_border, place.place[static_cast<Eigen::Index>(k)] * twice_area /
                                            (c[(k + 1) % 3] - c[(k + 2) % 3]).norm());
    return std::sqrt(place.distance2) <= 0.5 * to_border;
}

/// Two edges of a triangle and its unit normal.
Mat3 edges_of(const std::array<Vec3, 3>& c) {
    Mat3 out;
    out << c[1] - c[0], c[2] - c[0], (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    return out;
}

/// A surface of a million triangles is crossed in far fewer steps.
constexpr int most_walk_steps = 10'000;

} // namespace

void NearestPlace::offer(const CarriedSurface& surface, const Points& places, int t, const Vec3& p) {
    const NearestPlace there = nearest_of(surface, places, t, p);
    if (there.distance2 < distance2 || (there.distance2 == distance2 && (triangle < 0 || t < triangle))) *this = there;
}

ClosestFeature feature_of(const CarriedSurface& surface, const Points& places, const NearestPlace& nearest,
                          const Vec3& p) {
    ClosestFeature out{nearest.triangle, nearest.place, p - nearest.point, Vec3::Zero()};
    const Corners on = corners_of(surface.triangles()[at(nearest.triangle)], nearest.place);
    out.normal = on.count == 3 ? face_normal(surface, places, nearest.triangle) : mean_normal(surface, places, on);
    return out;
}

Vec3 face_normal(const CarriedSurface& surface, const Points& places, int triangle) {
    const auto [a, b, c] = surface.corners(triangle, places);
    const Vec3 n = (b - a).cross(c - a);
    const double length = n.norm();
    return length > 0 ? Vec3(n / length) : Vec3(Vec3::Zero());
}

Vec3 place_in_plane(const std::array<Vec3, 3>& c, const Vec3& p) {
    const Vec3 u = c[1] - c[0], v = c[2] - c[0], w = p - c[0];
    const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v);
    const double det = uu * vv - uv * uv;
    constexpr double least_area = 1e-10; // squared, of an upright triangle: beyond, coordinates are mostly rounding
    if (!(det > least_area * (uu + vv) * (uu + vv))) return Vec3::UnitX();
    double s = 0, t = 0;
    for (int round = 0; round < 2; ++round) { // the second takes out what rounding left of a narrow triangle
        const Vec3 rest = w - s * u - t * v;
        const double ru = rest.dot(u), rv = rest.dot(v);
        s += (vv * ru - uv * rv) / det, t += (uu * rv - uv * ru) / det;
    }
    Vec3 out(1 - s - t, s, t);
    for (double& x : out)
        if (x == 0) x = 1e-300;
    return out;
}

ClosestFeature follow_feature(const CarriedSurface& surface, const Points& places, int from_triangle, const Vec3& p,
                              const Vec3& side, const std::vector<char>* allowed) {
    const bool any_side = side.isZero(0);
    const double least = least_facing * side.norm(), near = near_share * surface.mean_edge();
    const auto belongs = [&](const NearestPlace& there) {
        const double facing = face_normal(surface, places, there.triangle).dot(side);
        return facing > least || (facing > -least && there.distance2 < near * near);
    };
    NearestPlace best = nearest_of(surface, places, from_triangle, p);
    for (int step = 0; step < most_walk_steps; ++step) {
        const Corners on = corners_of(surface.triangles()[at(best.triangle)], best.place);
        const NearestPlace here = best;
        /// The triangles at a vertex: with another one given only those at both, without those at vertices asked
        /// already.
        const auto ask_about = [&](int vertex, int other, int asked, int asked_too) {
            for (const int t : surface.fan(vertex)) {
                const Triangle& corners = surface.triangles()[at(t)];
                if (t == here.triangle || (other >= 0 && !has_vertex(corners, other))) continue;
                if ((asked >= 0 && has_vertex(corners, asked)) || (asked_too >= 0 && has_vertex(corners, asked_too)))
                    continue;
                if (allowed && !(*allowed)[at(t)]) continue;
                const NearestPlace there = nearest_of(surface, places, t, p);
                if (there.distance2 < best.distance2 && (any_side || belongs(there))) best = there;
            }
        };
        if (on.count < 3) ask_about(on.vertex[0], on.count == 2 ? on.vertex[1] : -1, -1, -1);
        if (best.triangle != here.triangle) continue;
        const bool behind = face_normal(surface, places, here.triangle).dot(p - here.point) < 0;
        if (!behind || surely_nearest(surface, places, here)) break;
        const Triangle& corners = surface.triangles()[at(here.triangle)];
        ask_about(corners[0], -1, -1, -1), ask_about(corners[1], -1, corners[0], -1);
        ask_about(corners[2], -1, corners[0], corners[1]);
        if (best.triangle == here.triangle) break;
    }
    return feature_of(surface, places, best, p);
}

FeatureStart start_of(const ClosestFeature& feature, const std::array<Vec3, 3>& corners) {
    const Mat3 edges = edges_of(corners);
    if (!(std::abs(edges.determinant()) > 0)) return {feature};
    const Mat3 inverse = edges.inverse();
    return {feature, inverse * feature.away, inverse * feature.normal};
}

Vec3 turned_along(const CarriedSurface& surface, const Points& places, const FeatureStart& start,
                  const Vec3& in_triangle) {
    return edges_of(surface.corners(start.feature.triangle, places)) * in_triangle;
}

Vec3 moved_along(const CarriedSurface& surface, const Points& places, const FeatureStart& start) {
    const ClosestFeature& was = start.feature;
    const std::array<Vec3, 3> c = surface.corners(was.triangle, places);
    return was.place[0] * c[0] + was.place[1] * c[1] + was.place[2] * c[2] +
           turned_along(surface, places, start, start.away);
}

ClosestFeature follow_feature(const CarriedSurface& surface, const Points& places, const FeatureStart& start,
                              const Vec3& p, const std::vector<char>* allowed) {
    constexpr double most_steps = 64;
    const ClosestFeature& was = start.feature;
    const Vec3 from = moved_along(surface, places, start), way = p - from,
               side = turned_along(surface, places, start, start.normal);
    const double longest = std::max(was.away.norm(), 0.5 * surface.mean_edge());
    const int steps = static_cast<int>(std::clamp(std::ceil(way.norm() / std::max(longest, 1e-300)), 1.0, most_steps));
    const auto follow_in = [&](int count) {
        int triangle = was.triangle;
        for (int s = 1; s < count; ++s)
            triangle =
                follow_feature(surface, places, triangle, from + (s / static_cast<double>(count)) * way, side, allowed)
                    .triangle;
        return follow_feature(surface, places, triangle, p, side, allowed);
    };
    const ClosestFeature f = follow_in(steps);
    // Just inside it may have to slide around an edge, which is near for a small part of a long way alone.
    const double near = near_share * surface.mean_edge();
    if (!f.inside() || f.away.squaredNorm() < near * near) return f;
    const int finer = static_cast<int>(std::min(std::ceil(way.norm() / near), most_steps));
    return finer > steps ? follow_in(finer) : f;
}

ClosestFeature nearest_allowed(const CarriedSurface& surface, const Points& places, const ClosestFeature& nearest,
                               const ClosestFeature& known, const Vec3& p, const std::vector<char>& allowed) {
    constexpr std::size_t most = 256; // of a rim that is so far away the nearest place is of little use
    std::array<int, most> seen{};
    std::size_t count = 0;
    NearestPlace best{known.triangle, known.place, p - known.away, known.away.squaredNorm()};
    seen[count++] = nearest.triangle;
    for (std::size_t i = 0; i < count; ++i) {
        if (allowed[at(seen[i])]) best.offer(surface, places, seen[i], p);
        for (const int v : surface.triangles()[at(seen[i])])
            for (const int t : surface.fan(v)) {
                const auto end = seen.begin() + static_cast<std::ptrdiff_t>(count);
                if (count == most || std::find(seen.begin(), end, t) != end) continue;
                if (nearest_of(surface, places, t, p).distance2 <= best.distance2) seen[count++] = t;
            }
    }
    return feature_of(surface, places, best, p);
}

} // namespace sinew::solver
