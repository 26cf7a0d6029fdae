// Distances along the edges of a surface, by shortest ways (Dijkstra 1959): at least as long as those along the surface
// itself, and by at most two thirds longer on triangles that are near to equilateral.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace sinew::solver {

class EdgeWays {
  public:
    struct Neighbour {
        std::size_t vertex;
        double length;
    };
    static constexpr double unreached = std::numeric_limits<double>::infinity();

    /// Indices must be those of points.
    EdgeWays(const Points& points, const std::vector<Triangle>& triangles);

    std::size_t size() const { return edges_.size(); }
    /// An edge between two triangles is there twice.
    const std::vector<Neighbour>& of(std::size_t vertex) const { return edges_[vertex]; }
    /// From a vertex to each; infinite for those that no edges lead to.
    std::vector<double> from(std::size_t vertex) const;
    /// Whether no way of at most `most` leads from any of some vertices to any of others. Takes as long as there are
    /// vertices within it.
    bool are_farther(std::span<const int> from, std::span<const int> to, double most);

  private:
    std::vector<std::vector<Neighbour>> edges_;
    std::vector<double> reached_; ///< of are_farther: infinite but while it runs
    std::vector<std::size_t> touched_;
};

} // namespace sinew::solver
