// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/pieces.h"

#include "solver/index.h"
#include "solver/mesh/corner_welder.h"

#include <numeric>

namespace sinew::rig {

using solver::at;

Pieces pieces_of(const solver::Points& points, const std::vector<solver::Triangle>& triangles) {
    solver::CornerWelder welder;
    std::vector<int> place;
    for (const solver::Vec3& p : points) place.push_back(welder.add(p));
    std::vector<int> parent(welder.points.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int v) {
        while (parent[at(v)] != v) v = parent[at(v)] = parent[at(parent[at(v)])];
        return v;
    };
    for (const solver::Triangle& t : triangles)
        for (const int v : t) parent[at(root(place[at(v)]))] = root(place[at(t[0])]);
    Pieces out;
    out.of_vertex.assign(points.size(), -1);
    std::vector<int> number(parent.size(), -1); // of each root
    for (const solver::Triangle& t : triangles)
        for (const int v : t) {
            int& piece = number[at(root(place[at(v)]))];
            if (piece < 0) piece = static_cast<int>(out.count++);
            out.of_vertex[at(v)] = piece;
        }
    return out;
}

} // namespace sinew::rig
