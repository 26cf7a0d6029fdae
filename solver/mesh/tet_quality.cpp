// How good the shapes of tets are.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/tet_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sinew::solver {

double tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double half = 0.5 * u.dot(v.cross(w)); // 3 volumes
    if (!(half > 0)) return half < 0 ? -1 : 0;
    const double sum = u.squaredNorm() + v.squaredNorm() + w.squaredNorm() + (v - u).squaredNorm() +
                       (w - u).squaredNorm() + (w - v).squaredNorm();
    const double root = std::cbrt(half);
    return 12 * root * root / sum;
}

std::array<double, 2> dihedral_range(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const std::array<Vec3, 4> x{a, b, c, d};
    std::array<double, 2> range{180, 0};
    constexpr std::array<std::array<std::size_t, 4>, 6> edges{
        {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};
    for (const auto& [i, j, k, l] : edges) {
        // Between the two faces at edge ij: the angle between the parts of ik and il across it.
        const Vec3 along = (x[j] - x[i]).normalized();
        const Vec3 m = x[k] - x[i], n = x[l] - x[i];
        const Vec3 p = m - along * along.dot(m), q = n - along * along.dot(n);
        const double angle = std::atan2(p.cross(q).norm(), p.dot(q)) * 180 / std::numbers::pi;
        range = {std::min(range[0], angle), std::max(range[1], angle)};
    }
    return range;
}

std::array<double, 2> dihedral_range(const TetMesh& mesh) {
    std::array<double, 2> range{180, 0};
    const auto x = [&](int v) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(v)]; };
    for (const Tet& t : mesh.tets) {
        const auto r = dihedral_range(x(t[0]), x(t[1]), x(t[2]), x(t[3]));
        range = {std::min(range[0], r[0]), std::max(range[1], r[1])};
    }
    return range;
}

} // namespace sinew::solver
