// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/edge_splits.h"

#include "solver/index.h"
#include "solver/ties.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace sinew::solver {

EdgeSplits::EdgeSplits(std::vector<EdgeSplit> splits)
    : by_edge_(std::move(splits)) {
    std::sort(by_edge_.begin(), by_edge_.end(), [](const auto& a, const auto& b) { return a.edge < b.edge; });
    std::vector<int> order(by_edge_.size());
    std::iota(order.begin(), order.end(), 0);
    double longest = 0;
    for (const EdgeSplit& s : by_edge_) longest = std::max(longest, s.length);
    const auto length = [&](int i) { return rounded_off(by_edge_[at(i)].length, longest); };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return length(a) > length(b); });
    rank_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank_[at(order[i])] = static_cast<int>(i);
}

int EdgeSplits::find(int a, int b) const {
    const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
    const auto found = std::lower_bound(by_edge_.begin(), by_edge_.end(), edge,
                                        [](const EdgeSplit& s, const auto& e) { return s.edge < e; });
    return found != by_edge_.end() && found->edge == edge ? static_cast<int>(found - by_edge_.begin()) : -1;
}

void EdgeSplits::parts_of(const Tet& tet, std::vector<Tet>& out) const {
    int first = -1;
    std::size_t from = 0, to = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j)
            if (const int split = find(tet[i], tet[j]);
                split >= 0 && (first < 0 || rank_[at(split)] < rank_[at(first)]))
                first = split, from = i, to = j;
    if (first < 0) return out.push_back(tet);
    Tet one = tet, other = tet;
    one[from] = other[to] = by_edge_[at(first)].vertex;
    parts_of(one, out);
    parts_of(other, out);
}

} // namespace sinew::solver
