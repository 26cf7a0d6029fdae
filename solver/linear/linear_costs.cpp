// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/linear_costs.h"

#include "solver/index.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sinew::solver {

namespace {

/// Flops of nested dissection a squared vertex of a component: 73 to 98 from 1,225 to 95,033 vertices of tets.
constexpr double flops = 90;
/// Entries of the factor a vertex of a component to the power of 4/3: 34 to 51 from 740 to 10,031 vertices.
constexpr double entries = 45;
/// Single-precision flops a second of two cores on supernodes of such sizes.
constexpr double flop_rate = 115e9;
/// Bytes a second of what caches hold, and of the rest: multigrid cycles on rigs and boxes of 5,000 to 500,000 tets
/// take within a fifth of the times that these give.
constexpr double cached = 60e9, streamed = 27e9, cache = 8e6;
/// Seconds to take an entry of the matrix into the factor.
constexpr double entry = 20 / 14e9;
/// Bytes of an entry of the factor: of the one that solves read, and of the one that it is made in.
constexpr double kept_bytes = 2, working_bytes = 4;
/// Bytes of a block in single precision; 4 more say which column it is of.
constexpr double single = 36;
/// Blocks of all grids for one of the matrix: 0.8 in a box, 0.9 to 1.3 in muscles, which are few tets thick.
constexpr double grid_blocks = 0.9;
/// What an iteration costs however small the matrix is.
constexpr double call = 2e-5;
/// A hierarchy costs about as much as so many cycles.
constexpr double cycles_a_hierarchy = 2;

double seconds(double bytes, double working_set) {
    const double share = std::min(1.0, cache / working_set);
    return bytes * (share / cached + (1 - share) / streamed);
}

} // namespace

LinearCosts linear_costs(const BlockPattern& pattern) {
    std::vector<double> size(at(pattern.rows), 0.0);
    for (const int c : components(pattern)) ++size[at(c)];
    const double n = pattern.rows, blocks = 2 * static_cast<double>(pattern.block_count()) - n;
    LinearCosts out;
    double nonzeros = 0;
    for (const double rows : size) {
        out.factor += flops * rows * rows / flop_rate;
        nonzeros += entries * std::pow(rows, 4.0 / 3);
    }
    out.factor_bytes = (kept_bytes + working_bytes) * nonzeros;
    out.factor += 9 * blocks * entry;
    const double product = seconds(single * blocks, single * blocks);
    out.factor_solve = call + seconds(2 * kept_bytes * nonzeros, kept_bytes * nonzeros) + product;
    // A cycle streams the single-precision blocks four and a half times and some forty vectors.
    const double streams = (1 + grid_blocks) * blocks;
    out.cycle = call + seconds(4.5 * (single + 4) * streams + 40 * 24 * n, single * streams);
    out.hierarchy = cycles_a_hierarchy * out.cycle;
    return out;
}

} // namespace sinew::solver
