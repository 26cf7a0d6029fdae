// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/cloth/sheet.h"

#include "solver/index.h"

#include <algorithm>

namespace sinew::solver {

namespace {

/// Of a direction's square: what its projection must have to say something.
constexpr double least_projection = 1e-4;

} // namespace

std::vector<std::array<int, 3>> across_from(const std::vector<Triangle>& triangles) {
    struct Side {
        std::array<int, 2> edge;
        std::size_t triangle, corner; ///< across from the edge
    };
    std::vector<Side> sides;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            const int a = triangles[t][(i + 1) % 3], b = triangles[t][(i + 2) % 3];
            sides.push_back({{std::min(a, b), std::max(a, b)}, t, i});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.edge < b.edge; });
    std::vector<std::array<int, 3>> out(triangles.size(), {-1, -1, -1});
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
        const Side &a = sides[i], &b = sides[i + 1];
        if (a.edge != b.edge) continue;
        out[a.triangle][a.corner] = triangles[b.triangle][b.corner];
        out[b.triangle][b.corner] = triangles[a.triangle][a.corner];
    }
    return out;
}

Points warp_directions(const Points& points, const std::vector<Triangle>& triangles, const Vec3& direction) {
    Points out;
    for (const Triangle& t : triangles) {
        const Vec3 normal =
            (points[at(t[1])] - points[at(t[0])]).cross(points[at(t[2])] - points[at(t[0])]).normalized();
        Vec3 along = Vec3::Zero();
        for (int k = -1; k < 3; ++k) {
            const Vec3 wanted = k < 0 ? Vec3(direction.normalized()) : Vec3(Vec3::Unit(k));
            along = wanted - normal.dot(wanted) * normal;
            if (along.squaredNorm() > least_projection) break;
        }
        out.push_back(normal.allFinite() && along.squaredNorm() > 0 ? Vec3(along.normalized()) : Vec3(Vec3::Zero()));
    }
    return out;
}

} // namespace sinew::solver
