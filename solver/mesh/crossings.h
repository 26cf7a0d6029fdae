// Edges that go through triangles: what surfaces that do not pass through each other have none of.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

/// An edge, by its vertices, and a triangle that it goes through.
struct Crossing {
    int from = -1, to = -1, triangle = -1;
    friend bool operator==(const Crossing&, const Crossing&) = default;
};

/// The edges of one surface that go through triangles of another, each edge once, in the order of `edges_of` and by
/// triangle. An edge that lies in a triangle's plane, or that only touches it, does not.
/// Vertices are places in the points of the edges' surface.
std::vector<Crossing> crossings(const Points& edge_points, const std::vector<Triangle>& edges_of, const Points& points,
                                const std::vector<Triangle>& triangles);
/// Those of a surface with itself; an edge and a triangle that share a vertex do not count.
std::vector<Crossing> own_crossings(const Points& points, const std::vector<Triangle>& triangles);

} // namespace sinew::solver
