// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/edge_ways.h"

#include <algorithm>
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

bool EdgeWays::are_farther(std::span<const int> from, std::span<const int> to, double most) {
    reached_.resize(edges_.size(), unreached);
    Open open;
    const auto reach = [&](std::size_t vertex, double distance) {
        if (!(distance <= most && distance < reached_[vertex])) return;
        if (reached_[vertex] == unreached) touched_.push_back(vertex);
        open.emplace(reached_[vertex] = distance, vertex);
    };
    for (const int v : from) reach(static_cast<std::size_t>(v), 0);
    bool farther = true;
    while (farther && !open.empty()) {
        const auto [distance, vertex] = open.top();
        open.pop();
        if (distance > reached_[vertex]) continue;
        farther = std::find(to.begin(), to.end(), static_cast<int>(vertex)) == to.end();
        for (const Neighbour& n : edges_[vertex]) reach(n.vertex, distance + n.length);
    }
    for (const std::size_t v : touched_) reached_[v] = unreached;
    touched_.clear();
    return farther;
}

} // namespace sinew::solver
