// A bounding volume hierarchy over boxes, shared by the triangle and the tet queries. Double precision, deterministic.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <algorithm>
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

/// Boxes of `nodes`, which have the tree's structure, around items elsewhere: `fit(item, node)` makes a leaf's box,
/// which begins empty, large enough for an item.
template <class Fit>
void refit(const Bvh& tree, std::vector<BvhNode>& nodes, const Fit& fit) {
    nodes = tree.nodes;
    // Children stand behind their parents.
    for (std::size_t n = nodes.size(); n-- > 0;) {
        BvhNode& node = nodes[n];
        if (node.count == 0) {
            const BvhNode &one = nodes[n + 1], &other = nodes[static_cast<std::size_t>(node.first)];
            node.min = one.min.cwiseMin(other.min), node.max = one.max.cwiseMax(other.max);
            continue;
        }
        node.min = Vec3::Constant(1e300), node.max = Vec3::Constant(-1e300);
        for (int i = node.first; i < node.first + node.count; ++i) fit(tree.order[static_cast<std::size_t>(i)], node);
    }
}

/// Calls use(leaf) for the leaves whose boxes meet a box until it returns false.
template <class Use>
void visit_leaves_near(const Bvh& tree, const Vec3& low, const Vec3& high, const Use& use) {
    int open[64]; // the tree of 2^31 items is 30 levels deep
    int size = 0;
    if (!tree.nodes.empty()) open[size++] = 0;
    while (size > 0) {
        const int number = open[--size];
        const BvhNode& node = tree.nodes[static_cast<std::size_t>(number)];
        if ((node.min.array() > high.array()).any() || (node.max.array() < low.array()).any()) continue;
        if (node.count > 0 && !use(node)) return;
        if (node.count == 0) open[size++] = node.first, open[size++] = number + 1;
    }
}

/// Items whose leaves' boxes meet a box, in increasing order: all that meet it themselves, and some beside it.
inline std::vector<int> items_near(const Bvh& tree, const Vec3& low, const Vec3& high) {
    std::vector<int> out;
    visit_leaves_near(tree, low, high, [&](const BvhNode& leaf) {
        const auto first = tree.order.begin() + leaf.first;
        out.insert(out.end(), first, first + leaf.count);
        return true;
    });
    std::sort(out.begin(), out.end());
    return out;
}

/// Squared distance from p to the node's box; 0 inside.
inline double squared_distance(const BvhNode& node, const Vec3& p) {
    const Vec3 d = (node.min - p).cwiseMax(p - node.max).cwiseMax(0.0);
    return d.squaredNorm();
}

} // namespace sinew::solver
