// A bounding volume hierarchy over boxes.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/bvh.h"

#include <algorithm>

namespace sinew::solver {
namespace {

constexpr int leaf_size = 4;

struct Builder {
    const Points &box_min, &box_max;
    Bvh& tree;

    int build(int first, int last) {
        const int index = static_cast<int>(tree.nodes.size());
        tree.nodes.emplace_back();
        Vec3 low = box_min[item(first)], high = box_max[item(first)];
        Vec3 centre_low = centre(item(first)), centre_high = centre_low;
        for (int i = first + 1; i < last; ++i) {
            low = low.cwiseMin(box_min[item(i)]);
            high = high.cwiseMax(box_max[item(i)]);
            centre_low = centre_low.cwiseMin(centre(item(i)));
            centre_high = centre_high.cwiseMax(centre(item(i)));
        }
        BvhNode node;
        node.min = low, node.max = high;
        if (last - first <= leaf_size) {
            node.first = first, node.count = last - first;
            tree.nodes[static_cast<std::size_t>(index)] = node;
            return index;
        }
        Eigen::Index axis = 0;
        (centre_high - centre_low).maxCoeff(&axis);
        const int middle = first + (last - first) / 2;
        const auto begin = tree.order.begin();
        // The item's number breaks ties, so the tree depends on the input alone.
        std::nth_element(begin + first, begin + middle, begin + last, [&](int a, int b) {
            const double ca = centre(static_cast<std::size_t>(a))[axis], cb = centre(static_cast<std::size_t>(b))[axis];
            return ca != cb ? ca < cb : a < b;
        });
        build(first, middle);
        node.first = build(middle, last);
        tree.nodes[static_cast<std::size_t>(index)] = node;
        return index;
    }
    std::size_t item(int i) const { return static_cast<std::size_t>(tree.order[static_cast<std::size_t>(i)]); }
    Vec3 centre(std::size_t i) const { return box_min[i] + box_max[i]; }
};

} // namespace

Bvh build_bvh(const Points& box_min, const Points& box_max) {
    Bvh tree;
    tree.order.resize(box_min.size());
    for (std::size_t i = 0; i < tree.order.size(); ++i) tree.order[i] = static_cast<int>(i);
    if (tree.order.empty()) return tree;
    tree.nodes.reserve(tree.order.size());
    Builder{box_min, box_max, tree}.build(0, static_cast<int>(tree.order.size()));
    return tree;
}

} // namespace sinew::solver
