// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/surface_pieces.h"

#include "solver/index.h"
#include "solver/joined_sets.h"
#include "solver/mesh/corner_welder.h"

#include <algorithm>
#include <array>

namespace sinew::solver {

SurfacePieces find_pieces(std::size_t points, const std::vector<Triangle>& triangles) {
    JoinedSets joined(points);
    std::vector<char> used(points, 0);
    for (const Triangle& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) used[at(t[i])] = 1, joined.join(t[0], t[i]);
    SurfacePieces out;
    out.of_point.assign(points, -1);
    for (std::size_t p = 0; p < points; ++p) {
        if (!used[p]) continue;
        const int first = joined.root(static_cast<int>(p)); // the lowest of the piece, so it comes first
        if (first == static_cast<int>(p)) {
            out.of_point[p] = static_cast<int>(out.count());
            out.first_point.push_back(first);
        }
        out.of_point[p] = out.of_point[at(first)];
    }
    out.is_closed.assign(out.count(), 1);
    std::vector<std::array<int, 3>> edges; // its ends, and which way a triangle passes it
    for (const Triangle& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax({t[i], t[(i + 1) % 3]});
            edges.push_back({low, high, t[i] < t[(i + 1) % 3] ? 1 : -1});
        }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0, next; i < edges.size(); i = next) {
        int sum = 0;
        for (next = i; next < edges.size() && edges[next][0] == edges[i][0] && edges[next][1] == edges[i][1]; ++next)
            sum += edges[next][2];
        if (sum != 0) out.is_closed[at(out.of_point[at(edges[i][0])])] = 0;
    }
    return out;
}

SurfacePieces find_pieces_by_place(const Points& points, std::vector<Triangle> triangles) {
    CornerWelder welder;
    std::vector<int> place, first; // of each point, of each place
    for (const Vec3& p : points) {
        place.push_back(welder.add(p));
        if (at(place.back()) == first.size()) first.push_back(static_cast<int>(place.size() - 1));
    }
    for (Triangle& t : triangles)
        for (int& v : t) v = place[at(v)];
    SurfacePieces out = find_pieces(welder.points.size(), triangles);
    for (int& p : out.first_point) p = first[at(p)];
    std::vector<int> of_point;
    for (const int p : place) of_point.push_back(out.of_point[at(p)]);
    out.of_point = std::move(of_point);
    return out;
}

} // namespace sinew::solver
