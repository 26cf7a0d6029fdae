// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/edge_ways.h"

#include <functional>
#include <queue>
#include <utility>

namespace sinew::solver {

namespace {

using Entry = std::pair<double, std::size_t>; ///< distance, vertex
using Open = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

} // namespace

EdgeWays::EdgeWays(const Points& points, const std::vector<Triangle>& triangles)
    : edges_(points.size()) {
    for (const Triangle& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto a = static_cast<std::size_t>(t[i]), b = static_cast<std::size_t>(t[(i + 1) % 3]);
            const double length = (points[a] - points[b]).norm();
            edges_[a].push_back({b, length});
            edges_[b].push_back({a, length});
        }
}

std::vector<double> EdgeWays::from(std::size_t start) const {
    std::vector<double> out(edges_.size(), unreached);
    Open open;
    open.emplace(out[start] = 0, start);
    while (!open.empty()) {
        const auto [distance, vertex] = open.top();
        open.pop();
        if (distance > out[vertex]) continue;
        for (const Neighbour& n : edges_[vertex]) {
            const double further = distance + n.length;
            if (further < out[n.vertex]) open.emplace(out[n.vertex] = further, n.vertex);
        }
    }
    return out;
}

bool EdgeWays::are_farther(std::size_t a, std::size_t b, double most) const {
    std::unordered_map<std::size_t, double> reached{{a, 0}};
    Open open;
    open.emplace(0, a);
    while (!open.empty()) {
        const auto [distance, vertex] = open.top();
        open.pop();
        if (vertex == b) return false;
        if (distance > reached.at(vertex)) continue;
        for (const Neighbour& n : edges_[vertex]) {
            const double further = distance + n.length;
            if (!(further <= most)) continue;
            const auto [place, is_new] = reached.emplace(n.vertex, further);
            if (!is_new && !(further < place->second)) continue;
            place->second = further;
            open.emplace(further, n.vertex);
        }
    }
    return true;
}

} // namespace sinew::solver
