// Which vertices of a tissue's tets carry a painted part of its surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"

#include <vector>

namespace sinew::solver {

/// A part of a surface: vertices and triangles of it, one flag each.
struct PaintedPart {
    std::vector<char> vertices, triangles;
};
/// The vertices with a weight above 0, and the triangles between them.
PaintedPart painted_vertices(const std::vector<Triangle>& triangles, const std::vector<double>& weights);
/// The triangles with a weight above 0, and their vertices.
PaintedPart painted_triangles(const std::vector<Triangle>& triangles, std::size_t vertex_count,
                              const std::vector<double>& weights);

/// The vertices that carry some point of the part with a weight of more than 1e-5, rising; of quadratic tets the
/// middles of edges count after the corners, in the order of edges_of. Exact: triangles are clipped by the tets that
/// they pass. So where the surface is that of the tets, these are the painted vertices and the middles of painted
/// edges; on a lattice, all corners (and edges) of tets that the part passes.
std::vector<int> carriers_of(const TissueRest& tissue, const PaintedPart& part);
/// Of a cloth: the part's own vertices. None for a bone.
std::vector<int> carriers_of(const BodyRest& body, const PaintedPart& part);

} // namespace sinew::solver
