// Symmetric sparse matrices of 3x3 blocks: the upper triangle by block rows, plus what a row-parallel product needs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/overlay.h"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace sinew::solver {

/// Which blocks are there. Row i holds columns j >= i, sorted, the diagonal always and first.
struct BlockPattern {
    int rows = 0;
    std::vector<int> row_start, column;
    /// Lower triangle by rows: (block index in the upper triangle, its row = our column), sorted by column.
    std::vector<int> lower_start;
    std::vector<std::pair<int, int>> lower;
    std::size_t block_count() const { return column.size(); }
    /// Index of block (i, j), i <= j; -1 if it is not there.
    int find(int i, int j) const;
};

/// What each row is coupled with above the diagonal: columns j > i of row i, sorted, each once.
struct CoupledRows {
    std::vector<int> start, column;
};

/// From couplings (i, j) in any order, duplicates and i = j allowed.
CoupledRows coupled_rows(int rows, const std::vector<std::pair<int, int>>& couplings);

BlockPattern make_pattern(int rows, const std::vector<std::pair<int, int>>& couplings);
/// Of all of them together; each is of as many rows.
BlockPattern make_pattern(int rows, std::span<const CoupledRows> parts);

/// Component of every row, by its lowest row.
std::vector<int> components(const BlockPattern& pattern);

/// Values of a pattern's blocks, row-major, 9 a block, and what lies outside of the pattern.
struct BlockMatrix {
    const BlockPattern* pattern = nullptr;
    std::vector<double> values;
    Overlay overlay;
    explicit BlockMatrix(const BlockPattern& p)
        : pattern(&p)
        , values(9 * p.block_count(), 0.0) {}
    double* block(std::size_t index) { return values.data() + 9 * index; }
    const double* block(std::size_t index) const { return values.data() + 9 * index; }
};

/// y = A x, 3 numbers a row; the same bits for any number of threads.
void multiply(const BlockMatrix& a, const double* x, double* y);

} // namespace sinew::solver
