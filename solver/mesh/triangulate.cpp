// Triangulation of one polygon.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/triangulate.h"

#include <cmath>

namespace sinew::solver {
namespace {

using Vec2 = Eigen::Vector2d;

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Twice the vector area. Taken about the first corner, so that a polygon far from the origin keeps its
/// digits.
Vec3 newell_normal(const Points& points, std::span<const int> corners) {
    const Vec3& origin = points[static_cast<std::size_t>(corners[0])];
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        normal += (points[static_cast<std::size_t>(corners[i])] - origin)
                      .cross(points[static_cast<std::size_t>(corners[i + 1])] - origin);
    return normal;
}

/// The polygon in the plane of its normal, counter-clockwise.
std::vector<Vec2> flatten(const Points& points, std::span<const int> corners, const Vec3& normal) {
    Eigen::Index smallest = 0;
    normal.cwiseAbs().minCoeff(&smallest);
    const Vec3 n = normal.normalized();
    const Vec3 u = Vec3::Unit(smallest).cross(n).normalized();
    const Vec3 v = n.cross(u);
    std::vector<Vec2> flat;
    flat.reserve(corners.size());
    const Vec3& origin = points[static_cast<std::size_t>(corners[0])];
    for (int corner : corners) {
        const Vec3 d = points[static_cast<std::size_t>(corner)] - origin;
        flat.emplace_back(d.dot(u), d.dot(v));
    }
    return flat;
}

bool is_convex(const std::vector<Vec2>& flat) {
    const std::size_t n = flat.size();
    // Every fan triangle must also turn left: a star that winds twice passes the corner test alone.
    for (std::size_t i = 0; i < n; ++i) {
        if (turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) < 0) return false;
        if (i >= 1 && i + 1 < n && turn(flat[0], flat[i], flat[i + 1]) < 0) return false;
    }
    return true;
}

bool is_ear(const std::vector<Vec2>& flat, const std::vector<std::size_t>& ring, std::size_t at) {
    const std::size_t n = ring.size(), before = ring[(at + n - 1) % n], here = ring[at], after = ring[(at + 1) % n];
    const Vec2 &a = flat[before], &b = flat[here], &c = flat[after];
    if (turn(a, b, c) <= 0) return false;
    for (std::size_t other : ring) {
        const Vec2& p = flat[other];
        // Corners at the same place as the ear's own (bridges to holes) do not block it.
        if (p == a || p == b || p == c) continue;
        if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
}

/// Smallest angle sine of the ear, so that good triangles are cut first.
double ear_quality(const std::vector<Vec2>& flat, std::size_t a, std::size_t b, std::size_t c) {
    const double ab = (flat[b] - flat[a]).squaredNorm(), bc = (flat[c] - flat[b]).squaredNorm(),
                 ca = (flat[a] - flat[c]).squaredNorm();
    const double sum = ab + bc + ca;
    return sum > 0 ? turn(flat[a], flat[b], flat[c]) / sum : 0;
}

} // namespace

void triangulate_polygon(const Points& points, std::span<const int> corners, std::vector<Triangle>& out) {
    const std::size_t n = corners.size();
    const auto fan = [&] {
        for (std::size_t i = 1; i + 1 < n; ++i) out.push_back({corners[0], corners[i], corners[i + 1]});
    };
    if (n < 3) return;
    if (n == 3) return fan();
    const Vec3 normal = newell_normal(points, corners);
    if (!(normal.squaredNorm() > 0) || !std::isfinite(normal.squaredNorm())) return fan();
    const std::vector<Vec2> flat = flatten(points, corners, normal);
    if (is_convex(flat)) return fan();

    std::vector<std::size_t> ring(n);
    for (std::size_t i = 0; i < n; ++i) ring[i] = i;
    while (ring.size() > 3) {
        const std::size_t m = ring.size();
        std::size_t best = m;
        double best_quality = -1;
        for (std::size_t i = 0; i < m; ++i) {
            if (!is_ear(flat, ring, i)) continue;
            const double quality = ear_quality(flat, ring[(i + m - 1) % m], ring[i], ring[(i + 1) % m]);
            if (quality > best_quality) best_quality = quality, best = i;
        }
        // A simple polygon always has an ear; one that crosses itself or is folded onto a line may not.
        if (best == m) best = 1;
        out.push_back({corners[ring[(best + m - 1) % m]], corners[ring[best]], corners[ring[(best + 1) % m]]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(best));
    }
    out.push_back({corners[ring[0]], corners[ring[1]], corners[ring[2]]});
}

} // namespace sinew::solver
