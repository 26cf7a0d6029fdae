// A bounding volume hierarchy over boxes, shared by the triangle and the tet queries. Double precision, deterministic.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

struct BvhNode {
    Vec3 min, max;
    int first = 0; ///< leaf: first position in Bvh::order; inner: index of the second child (the first one follows)
    int count = 0; ///< leaf: number of items; 0 = inner node
};

struct Bvh {
    std::vector<BvhNode> nodes; ///< nodes[0] is the root; empty without items; children stand behind their parents
    std::vector<int> order;     ///< item indices, leaf after leaf
};

/// Median split along the widest axis of the box centres, up to four items a leaf; depth is at most log2(n)
/// + 1.
Bvh build_bvh(const Points& box_min, const Points& box_max);

/// Squared distance from p to the node's box; 0 inside.
inline double squared_distance(const BvhNode& node, const Vec3& p) {
    const Vec3 d = (node.min - p).cwiseMax(p - node.max).cwiseMax(0.0);
    return d.squaredNorm();
}

} // namespace sinew::solver
