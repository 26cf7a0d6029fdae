// Counting sort, for gather lists whose order depends on nothing but the scene.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

namespace sinew::solver {

/// for_each_entry(visit) calls visit(bucket, value) in the order that the buckets keep; it is called twice.
template <class ForEach>
void sort_into(std::size_t buckets, std::vector<int>& start, std::vector<int>& values, const ForEach& for_each_entry) {
    start.assign(buckets + 1, 0);
    for_each_entry([&](std::size_t bucket, int) { ++start[bucket + 1]; });
    for (std::size_t i = 0; i < buckets; ++i) start[i + 1] += start[i];
    values.resize(static_cast<std::size_t>(start.back()));
    std::vector<int> next(start.begin(), start.end() - 1);
    for_each_entry([&](std::size_t bucket, int value) { values[static_cast<std::size_t>(next[bucket]++)] = value; });
}

} // namespace sinew::solver
