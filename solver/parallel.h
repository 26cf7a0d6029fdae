// Loops over independent pieces of work. Reproducible by construction: pieces write to places of their own, and sums
// over pieces are taken afterwards, in order, by one thread.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#if defined(__SANITIZE_THREAD__)
#include "solver/watched_loop.h"
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace sinew::solver {

/// body(i) for i in [0, count); at least `grain` pieces go to one thread.
template <class Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
    if (count <= grain) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
#if defined(__SANITIZE_THREAD__)
    watched_loop(count, grain, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i != end; ++i) body(i);
    });
#else
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const tbb::blocked_range<std::size_t>& r) {
        for (std::size_t i = r.begin(); i != r.end(); ++i) body(i);
    });
#endif
}

/// Sorts by <.
template <class Iterator>
void parallel_sort(Iterator first, Iterator end) {
#if defined(__SANITIZE_THREAD__)
    std::sort(first, end);
#else
    tbb::parallel_sort(first, end);
#endif
}

/// Sums over [0, count), add(i, sums) adds the terms of i: chunks whose size depends on the count alone, then the
/// chunks in order, so the bits do not depend on the number of threads.
template <std::size_t n, class Add>
std::array<double, n> ordered_sums(std::size_t count, const Add& add) {
    std::array<std::array<double, n>, 1024> parts;
    const std::size_t chunk = std::max<std::size_t>(2048, (count + parts.size() - 1) / parts.size());
    const auto sum_chunk = [&](std::size_t first) {
        std::array<double, n> sums{};
        for (std::size_t i = first; i < std::min(first + chunk, count); ++i) add(i, sums);
        return sums;
    };
    if (count <= chunk) return sum_chunk(0);
    const std::size_t chunks = (count + chunk - 1) / chunk;
    parallel_for(chunks, 4, [&](std::size_t c) { parts[c] = sum_chunk(c * chunk); });
    std::array<double, n> sums{};
    for (std::size_t c = 0; c < chunks; ++c)
        for (std::size_t k = 0; k < n; ++k) sums[k] += parts[c][k];
    return sums;
}
/// Sum of term(i) over [0, count), likewise.
template <class Term>
double ordered_sum(std::size_t count, const Term& term) {
    return ordered_sums<1>(count, [&](std::size_t i, std::array<double, 1>& sum) { sum[0] += term(i); })[0];
}

} // namespace sinew::solver
