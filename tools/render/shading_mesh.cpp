// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/shading_mesh.h"
#include "solver/joined_sets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace sinew::render {

using solver::Points;
using solver::Triangle;
using solver::Vec3;

namespace {

/// One side of an edge: its lower and upper vertex, and the corners of the triangle that lie on them.
struct EdgeSide {
    int low, high, triangle, low_corner, high_corner;
};

std::vector<EdgeSide> sorted_edges(const std::vector<Triangle>& triangles) {
    std::vector<EdgeSide> sides;
    sides.reserve(3 * triangles.size());
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            const int next = (k + 1) % 3;
            const Triangle& tri = triangles[static_cast<std::size_t>(t)];
            const int a = tri[static_cast<std::size_t>(k)], b = tri[static_cast<std::size_t>(next)];
            if (a < b)
                sides.push_back({a, b, t, 3 * t + k, 3 * t + next});
            else
                sides.push_back({b, a, t, 3 * t + next, 3 * t + k});
        }
    std::sort(sides.begin(), sides.end(), [](const EdgeSide& l, const EdgeSide& r) {
        return std::tie(l.low, l.high, l.triangle) < std::tie(r.low, r.high, r.triangle);
    });
    return sides;
}

} // namespace

Points ShadingMesh::gather(const Points& points) const {
    Points out;
    out.reserve(source.size());
    for (int v : source) out.push_back(points[static_cast<std::size_t>(v)]);
    return out;
}

ShadingMesh split_creases(const Points& points, const std::vector<Triangle>& triangles, double crease_degrees) {
    Points normals;
    normals.reserve(triangles.size());
    for (const Triangle& t : triangles) {
        const Vec3 &a = points[static_cast<std::size_t>(t[0])], &b = points[static_cast<std::size_t>(t[1])],
                   &c = points[static_cast<std::size_t>(t[2])];
        normals.push_back((b - a).cross(c - a).stableNormalized());
    }

    const double least_cosine = std::cos(crease_degrees * std::numbers::pi / 180);
    solver::JoinedSets corners(3 * triangles.size());
    const std::vector<EdgeSide> sides = sorted_edges(triangles);
    for (std::size_t i = 1; i < sides.size(); ++i) {
        const EdgeSide &l = sides[i - 1], &r = sides[i];
        if (l.low != r.low || l.high != r.high) continue;
        const Vec3 &m = normals[static_cast<std::size_t>(l.triangle)],
                   &n = normals[static_cast<std::size_t>(r.triangle)];
        // A triangle without area has no say about creases.
        if (!m.isZero() && !n.isZero() && m.dot(n) < least_cosine) continue;
        corners.join(l.low_corner, r.low_corner);
        corners.join(l.high_corner, r.high_corner);
    }

    // Shading vertices in the order of the original vertices, so that an unsplit mesh keeps its numbering.
    std::map<std::pair<int, int>, int> numbers; // (vertex, root corner) -> shading vertex
    for (int corner = 0; corner < static_cast<int>(3 * triangles.size()); ++corner)
        numbers.emplace(std::pair(triangles[static_cast<std::size_t>(corner / 3)][static_cast<std::size_t>(corner % 3)],
                                  corners.root(corner)),
                        0);
    ShadingMesh out;
    for (auto& [key, number] : numbers) {
        number = static_cast<int>(out.source.size());
        out.source.push_back(key.first);
    }
    out.triangles.reserve(triangles.size());
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
        Triangle split;
        for (int k = 0; k < 3; ++k)
            split[static_cast<std::size_t>(k)] = numbers.at(
                {triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)], corners.root(3 * t + k)});
        out.triangles.push_back(split);
    }
    return out;
}

} // namespace sinew::render
