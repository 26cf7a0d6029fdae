// Which blocks a Cholesky factor of a pattern has, and in what order they are made: the symbolic half of a
// factorisation, counted in rows of 3x3 blocks, of which there are nine times as few as of numbers.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

#include <cstddef>
#include <vector>

namespace sinew::solver {

/// A dense block column: columns first…first+width-1 of the factor, and the rows where they are not zero, the first
/// `width` of which are the columns themselves. All are rows of blocks.
struct Supernode {
    int first = 0, width = 0, rows = 0;
    std::size_t row_start = 0;   ///< in Supernodes::rows
    std::size_t value_start = 0; ///< its numbers, 9 · rows · width of them
};

struct Supernodes {
    std::vector<int> order;       ///< the matrix's row at each place of the factor
    std::vector<Supernode> nodes; ///< children before their parents, a subtree's one after another
    std::vector<int> rows;        ///< of each supernode, ascending
    std::size_t value_count = 0;  ///< numbers that all supernodes hold
    double operations = 0;        ///< floating-point operations of one factorisation
    int most_rows = 0;            ///< of a supernode
};

/// By CHOLMOD, in the order of vertex_order.h. Throws Error FE305 (memory).
Supernodes find_supernodes(const BlockPattern& pattern);

} // namespace sinew::solver
