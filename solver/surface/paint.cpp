// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/surface/paint.h"

#include "solver/error.h"
#include "solver/index.h"

#include <algorithm>
#include <numeric>
#include <string>

namespace sinew::solver {
namespace {

/// Cosine of the angle between normals beyond which paint does not run on: 60 degrees.
constexpr double crease_cosine = 0.5;

bool is_painted(const std::array<double, 3>& corners) {
    return std::all_of(corners.begin(), corners.end(), [](double w) { return w > 0; });
}

/// Corners of the triangles by vertex, as 3 x triangle + corner.
struct CornersOfVertices {
    std::vector<std::size_t> start, corner;
    CornersOfVertices(std::size_t vertices, const std::vector<Triangle>& triangles)
        : start(vertices + 1, 0)
        , corner(3 * triangles.size()) {
        for (const Triangle& t : triangles)
            for (const int v : t) ++start[at(v) + 1];
        std::partial_sum(start.begin(), start.end(), start.begin());
        std::vector<std::size_t> next(start.begin(), start.end() - 1);
        for (std::size_t t = 0; t < triangles.size(); ++t)
            for (std::size_t i = 0; i < 3; ++i) corner[next[at(triangles[t][i])]++] = 3 * t + i;
    }
};

/// Whether two triangles at vertex v share an edge there across which the surface bends little.
bool run_on(const Triangle& a, const Triangle& b, int v, const Vec3& normal_a, const Vec3& normal_b) {
    const bool share =
        std::any_of(a.begin(), a.end(), [&](int u) { return u != v && std::find(b.begin(), b.end(), u) != b.end(); });
    return share && normal_a.dot(normal_b) >= crease_cosine * normal_a.norm() * normal_b.norm();
}

/// Takes the paint off faces that it would only reach around a crease.
void stop_at_creases(const Points& points, const std::vector<Triangle>& triangles, CornerWeights& weights) {
    const CornersOfVertices of(points.size(), triangles);
    Points normals(triangles.size());
    std::vector<char> full(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const Triangle& tri = triangles[t];
        normals[t] = (points[at(tri[1])] - points[at(tri[0])]).cross(points[at(tri[2])] - points[at(tri[0])]);
        full[t] = is_painted(weights[t]);
    }
    std::vector<std::size_t> fan; // of each corner at a vertex: the place of its fan's first corner
    for (std::size_t v = 0; v < points.size(); ++v) {
        const std::size_t first = of.start[v], count = of.start[v + 1] - first;
        bool some_full = false, some_not = false, painted = false;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t c = of.corner[first + i];
            (full[c / 3] ? some_full : some_not) = true;
            painted = painted || weights[c / 3][c % 3] > 0;
        }
        if (!painted || !some_full || !some_not) continue;
        fan.resize(count);
        std::iota(fan.begin(), fan.end(), std::size_t{0});
        const auto root = [&](std::size_t i) {
            while (fan[i] != i) i = fan[i];
            return i;
        };
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const std::size_t a = of.corner[first + i] / 3, b = of.corner[first + j] / 3;
                if (!run_on(triangles[a], triangles[b], static_cast<int>(v), normals[a], normals[b])) continue;
                const std::size_t p = root(i), q = root(j);
                fan[std::max(p, q)] = std::min(p, q);
            }
        for (std::size_t i = 0; i < count; ++i) {
            bool reached = false;
            for (std::size_t j = 0; j < count && !reached; ++j)
                reached = full[of.corner[first + j] / 3] && root(i) == root(j);
            if (!reached) weights[of.corner[first + i] / 3][of.corner[first + i] % 3] = 0;
        }
    }
}

} // namespace

CornerWeights corner_weights(const Points& points, const std::vector<Triangle>& triangles,
                             const std::vector<double>& map, PaintedOn on) {
    const std::size_t count = on == PaintedOn::vertices ? points.size() : triangles.size();
    if (map.size() > 1 && map.size() != count)
        throw Error("FE204",
                    std::to_string(map.size()) + " weights for a surface of " + std::to_string(count) +
                        (on == PaintedOn::vertices ? " vertices" : " triangles"),
                    "give one number for each, or one for all");
    CornerWeights out(triangles.size());
    if (map.size() <= 1) {
        const double w = map.empty() ? 1 : map.front();
        std::fill(out.begin(), out.end(), std::array{w, w, w});
        return out;
    }
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) out[t][i] = on == PaintedOn::faces ? map[t] : map[at(triangles[t][i])];
    if (on == PaintedOn::vertices) stop_at_creases(points, triangles, out);
    return out;
}

} // namespace sinew::solver
