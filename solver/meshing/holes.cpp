// Closes the cracks and small holes of a surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/holes.h"

#include "solver/index.h"
#include "solver/meshing/shells.h"

#include <algorithm>
#include <map>
#include <set>

namespace sinew::solver {
namespace {

/// Directed edges that are used more often than their reverse, once for each use too many, by their start.
std::multimap<int, int> border_edges(const std::vector<Triangle>& triangles) {
    std::multimap<int, int> border;
    for (const auto& [start, end] : border_edges_of(triangles)) border.emplace(start, end);
    return border;
}

/// Loops without repeated corners. At each vertex as many border edges begin as end, so a walk always comes
/// back.
std::vector<std::vector<int>> border_loops(std::multimap<int, int> border) {
    std::vector<std::vector<int>> loops;
    while (!border.empty()) {
        std::vector<int> path{border.begin()->first};
        std::map<int, std::size_t> place{{path[0], 0}};
        while (true) {
            const auto edge = border.find(path.back());
            if (edge == border.end()) break;
            const int next = edge->second;
            border.erase(edge);
            const auto seen = place.find(next);
            if (seen == place.end()) {
                place.emplace(next, path.size());
                path.push_back(next);
                continue;
            }
            // Cut the loop off and walk on from where it closed.
            const std::size_t first = seen->second;
            loops.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(first), path.end());
            for (std::size_t i = first + 1; i < path.size(); ++i) place.erase(path[i]);
            path.resize(first + 1);
        }
    }
    return loops;
}

void close_loop(const Points& points, const std::vector<int>& loop, std::vector<Triangle>& out) {
    const int n = static_cast<int>(loop.size());
    if (n < 3) return;
    std::vector<int> before(at(n)), after(at(n));
    std::set<std::pair<double, int>> bridges; // squared length over corner i, i
    const auto bridge = [&](int i) {
        return std::pair{(points[at(loop[at(before[at(i)])])] - points[at(loop[at(after[at(i)])])]).squaredNorm(), i};
    };
    for (int i = 0; i < n; ++i) before[at(i)] = (i + n - 1) % n, after[at(i)] = (i + 1) % n;
    for (int i = 0; i < n; ++i) bridges.insert(bridge(i));
    for (int left = n; left >= 3; --left) {
        const int i = bridges.begin()->second, a = before[at(i)], b = after[at(i)];
        out.push_back({loop[at(b)], loop[at(i)], loop[at(a)]});
        bridges.erase(bridge(i)), bridges.erase(bridge(a)), bridges.erase(bridge(b));
        after[at(a)] = b, before[at(b)] = a;
        bridges.insert(bridge(a)), bridges.insert(bridge(b));
    }
}

} // namespace

std::vector<Triangle> close_holes(const Points& points, const std::vector<Triangle>& triangles) {
    std::vector<Triangle> lids;
    for (const std::vector<int>& loop : border_loops(border_edges(triangles))) close_loop(points, loop, lids);
    return lids;
}

} // namespace sinew::solver
