// Tets split at points on their edges, without hanging vertices.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <array>
#include <vector>

namespace sinew::solver {

/// A point on an edge between two vertices, the lower number first.
struct EdgeSplit {
    std::array<int, 2> edge;
    int vertex;    ///< the new vertex
    double length; ///< of the edge
};

/// Splits of edges in the order in which every tet takes them: the longest edge first, then by number. All tets about
/// an edge halve it, one edge after another, so the parts of two tets meet in the same triangles whatever else
/// is split.
class EdgeSplits {
  public:
    explicit EdgeSplits(std::vector<EdgeSplit> splits);
    /// Appends the parts of a tet, oriented like it; the tet itself where none of its edges is split.
    void parts_of(const Tet& tet, std::vector<Tet>& out) const;

  private:
    int find(int a, int b) const;
    std::vector<EdgeSplit> by_edge_;
    std::vector<int> rank_; ///< of by_edge_
};

} // namespace sinew::solver
