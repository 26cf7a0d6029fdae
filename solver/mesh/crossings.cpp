// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/crossings.h"

#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/parallel.h"

#include <algorithm>

namespace sinew::solver {

namespace {

double six_volumes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).cross(c - a).dot(d - a);
}

/// Whether the straight way from p to q goes through the inside of a triangle: its ends on different sides of the
/// plane, and the triangle's edges all on one side of the line.
bool goes_through(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    const double at_p = six_volumes(a, b, c, p), at_q = six_volumes(a, b, c, q);
    if (!(at_p * at_q < 0)) return false;
    const double ab = six_volumes(p, q, a, b), bc = six_volumes(p, q, b, c), ca = six_volumes(p, q, c, a);
    return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

std::vector<Crossing> find(const Points& edge_points, const std::vector<Triangle>& edges_of, const Points& points,
                           const std::vector<Triangle>& triangles, bool itself) {
    std::vector<std::array<int, 2>> edges;
    for (const Triangle& t : edges_of)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto [low, high] = std::minmax(t[c], t[(c + 1) % 3]);
            edges.push_back({low, high});
        }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    Points low, high;
    for (const auto& [a, b, c] : triangles) {
        low.push_back(points[at(a)].cwiseMin(points[at(b)]).cwiseMin(points[at(c)]));
        high.push_back(points[at(a)].cwiseMax(points[at(b)]).cwiseMax(points[at(c)]));
    }
    const Bvh tree = build_bvh(low, high);
    constexpr std::size_t piece = 256;
    std::vector<std::vector<Crossing>> found((edges.size() + piece - 1) / piece);
    parallel_for(found.size(), 1, [&](std::size_t k) {
        std::vector<int> hits;
        for (std::size_t e = k * piece; e < std::min(edges.size(), (k + 1) * piece); ++e) {
            const auto [from, to] = edges[e];
            const Vec3 &p = edge_points[at(from)], &q = edge_points[at(to)];
            const Vec3 least = p.cwiseMin(q), most = p.cwiseMax(q);
            hits.clear();
            int stack[128]; // the tree of 2^31 triangles is 30 levels deep
            int depth = 0;
            if (!tree.nodes.empty()) stack[depth++] = 0;
            while (depth > 0) {
                const int n = stack[--depth];
                const BvhNode& node = tree.nodes[at(n)];
                if ((node.min.array() > most.array()).any() || (node.max.array() < least.array()).any()) continue;
                if (node.count == 0) stack[depth++] = n + 1, stack[depth++] = node.first;
                for (int i = node.first; i < node.first + node.count; ++i) {
                    const int t = tree.order[at(i)];
                    const auto& [a, b, c] = triangles[at(t)];
                    const bool shared = from == a || from == b || from == c || to == a || to == b || to == c;
                    if (itself && shared) continue;
                    if (goes_through(p, q, points[at(a)], points[at(b)], points[at(c)])) hits.push_back(t);
                }
            }
            std::sort(hits.begin(), hits.end());
            for (const int t : hits) found[k].push_back({from, to, t});
        }
    });
    std::vector<Crossing> out;
    for (const auto& part : found) out.insert(out.end(), part.begin(), part.end());
    return out;
}

} // namespace

std::vector<Crossing> crossings(const Points& edge_points, const std::vector<Triangle>& edges_of, const Points& points,
                                const std::vector<Triangle>& triangles) {
    return find(edge_points, edges_of, points, triangles, false);
}

std::vector<Crossing> own_crossings(const Points& points, const std::vector<Triangle>& triangles) {
    return find(points, triangles, points, triangles, true);
}

} // namespace sinew::solver
