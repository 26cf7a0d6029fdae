// Numbers in sets that are joined two by two.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/index.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace sinew::solver {

class JoinedSets {
  public:
    /// 0 to count - 1, each alone.
    explicit JoinedSets(std::size_t count = 0) { reset(count); }
    /// Begins anew, with 0 to count - 1.
    void reset(std::size_t count) {
        above_.resize(count);
        std::iota(above_.begin(), above_.end(), 0);
    }
    /// The lowest number of the set that i is in.
    int root(int i) {
        while (above_[at(i)] != i) i = above_[at(i)] = above_[at(above_[at(i)])];
        return i;
    }
    void join(int i, int j) {
        const auto [low, high] = std::minmax({root(i), root(j)});
        above_[at(high)] = low;
    }

  private:
    std::vector<int> above_;
};

} // namespace sinew::solver
