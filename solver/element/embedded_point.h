// Points that ride on a tissue's tets: which vertices carry them, and how much of each.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <array>

namespace sinew::solver {

/// The vertices that carry a point, and their weights, which sum to 1.
struct PointWeights {
    int count = 0;
    int vertex[10];
    double weight[10];
};

/// A point given by its barycentric coordinates in a tet. `edges`: the vertices at the middles of the edges of a
/// quadratic tet, in the order of tet_edge_corners; nullptr for a linear one. Exact for affine motion.
PointWeights embedded_point(const Tet& corners, const std::array<int, 6>* edges,
                            const std::array<double, 4>& barycentric);

} // namespace sinew::solver
