// Loops over independent pieces of work. Reproducible by construction: pieces write to places of their own, and sums
// over pieces are taken afterwards, in order, by one thread.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace sinew::solver {

/// body(i) for i in [0, count); at least `grain` pieces go to one thread.
template <class Body> void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
    if (count <= grain) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& r) {
                          for (std::size_t i = r.begin(); i != r.end(); ++i) body(i);
                      });
}

/// Sum of term(i) over [0, count): chunks whose size depends on the count alone, then the chunks in order, so the bits do not
/// depend on the number of threads.
template <class Term> double ordered_sum(std::size_t count, const Term& term) {
    std::array<double, 1024> sums;
    const std::size_t chunk = std::max<std::size_t>(2048, (count + sums.size() - 1) / sums.size());
    const auto sum_chunk = [&](std::size_t first) {
        double sum = 0;
        for (std::size_t i = first; i < std::min(first + chunk, count); ++i) sum += term(i);
        return sum;
    };
    if (count <= chunk) return sum_chunk(0);
    const std::size_t chunks = (count + chunk - 1) / chunk;
    parallel_for(chunks, 4, [&](std::size_t c) { sums[c] = sum_chunk(c * chunk); });
    double sum = 0;
    for (std::size_t c = 0; c < chunks; ++c) sum += sums[c];
    return sum;
}

} // namespace sinew::solver
