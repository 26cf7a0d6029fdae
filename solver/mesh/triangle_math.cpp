// Closest point on one triangle and solid angle of one triangle.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/triangle_math.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sinew::solver {
namespace {

/// Closest point of one edge, walked from the corner with the lower number.
TrianglePoint closest_on_edge(const Vec3& p, const std::array<Vec3, 3>& c, const Triangle& id, std::size_t i,
                              std::size_t j) {
    if (id[i] > id[j]) std::swap(i, j);
    const Vec3 edge = c[j] - c[i];
    const double length2 = edge.squaredNorm();
    const double t = length2 > 0 ? std::clamp((p - c[i]).dot(edge) / length2, 0.0, 1.0) : 0.0;
    TrianglePoint result;
    result.barycentric.setZero();
    result.barycentric[static_cast<Eigen::Index>(i)] = 1 - t;
    result.barycentric[static_cast<Eigen::Index>(j)] = t;
    if (t == 0)
        result.point = c[i];
    else if (t == 1)
        result.point = c[j];
    else
        result.point = c[i] + t * edge;
    return result;
}

} // namespace

TrianglePoint closest_on_triangle(const Vec3& p, const std::array<Vec3, 3>& c, const Triangle& id) {
    const Vec3 u = c[1] - c[0], v = c[2] - c[0], w = p - c[0];
    const Vec3 n = u.cross(v);
    const double n2 = n.squaredNorm();
    if (n2 > 0) {
        // Barycentric coordinates of the foot point in the plane.
        const double b2 = u.cross(w).dot(n) / n2, b1 = w.cross(v).dot(n) / n2, b0 = 1 - b1 - b2;
        if (b0 > 0 && b1 > 0 && b2 > 0) return {c[0] + b1 * u + b2 * v, Vec3(b0, b1, b2)};
    }
    TrianglePoint best;
    double best_distance2 = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const TrianglePoint candidate = closest_on_edge(p, c, id, k, (k + 1) % 3);
        const double distance2 = (candidate.point - p).squaredNorm();
        if (k == 0 || distance2 < best_distance2) best = candidate, best_distance2 = distance2;
    }
    return best;
}

double solid_angle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 u = a - p, v = b - p, w = c - p;
    const double nu = u.norm(), nv = v.norm(), nw = w.norm();
    const double det = u.dot(v.cross(w));
    const double divisor = nu * nv * nw + u.dot(v) * nw + v.dot(w) * nu + w.dot(u) * nv;
    if (det == 0) return 0;
    return 2 * std::atan2(det, divisor);
}

} // namespace sinew::solver
