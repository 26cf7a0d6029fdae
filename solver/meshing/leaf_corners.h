// Corners of triangles in the order of a tree of them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/types.h"

#include <array>
#include <vector>

namespace sinew::solver {

/// Corners of triangles in the order of a tree, coordinate by coordinate, so that those of a leaf are seen at once.
class LeafCorners {
  public:
    using Four = Eigen::Array4d;

    LeafCorners(const Bvh& tree, const Points& points, const std::vector<Triangle>& triangles) {
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t d = 0; d < 3; ++d) {
                std::vector<double>& list = coordinates_[c][d];
                list.reserve(tree.order.size() + 4);
                for (const int t : tree.order) list.push_back(points[at(triangles[at(t)][c])][static_cast<int>(d)]);
                list.resize(list.size() + 4); // whole fours everywhere
            }
    }
    /// Coordinate d of corner c of four triangles.
    Four four(const BvhNode& leaf, std::size_t c, std::size_t d) const {
        return Eigen::Map<const Four>(coordinates_[c][d].data() + leaf.first);
    }

  private:
    std::array<std::array<std::vector<double>, 3>, 3> coordinates_;
};

} // namespace sinew::solver
