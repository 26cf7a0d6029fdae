// A symmetric matrix of 3x3 blocks with both triangles by rows, in single precision: what iterations read. Half the
// bytes of double precision; what that leaves of the error is Newton's to remove, whose residual is evaluated in
// double.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

#include <cstring>
#include <vector>

namespace sinew::solver {

typedef float Float4 __attribute__((vector_size(16)));

/// One block, its nine numbers by columns without padding: iterations are as quick as these come from memory.
struct FloatBlock {
    float value[9];
    float& operator()(int r, int c) { return value[3 * c + r]; }
    float operator()(int r, int c) const { return value[3 * c + r]; }
    /// A column, and in the fourth lane a number of another one, so that a row of blocks is a chain of multiply-adds.
    Float4 col(int c) const {
        Float4 out;
        // Nothing beyond the block is read: the last column comes with the number before it.
        std::memcpy(&out, value + (c < 2 ? 3 * c : 5), sizeof out);
        return c < 2 ? out : __builtin_shufflevector(out, out, 1, 2, 3, 0);
    }
};
inline void add_scaled(const FloatBlock& from, float weight, FloatBlock& to) {
    for (int i = 0; i < 9; ++i) to.value[i] += weight * from.value[i];
}

/// Blocks with the columns that they are of.
struct BlockList {
    std::vector<int> column;
    std::vector<FloatBlock> blocks;
    /// `sum` and after it A_ij x_j of entries first…last of a row; x has 3 numbers a row and one number of padding.
    Float4 product(int first, int last, const float* x, Float4 sum = Float4{0, 0, 0, 0}) const {
        for (int e = first; e < last; ++e) {
            const FloatBlock& b = blocks[static_cast<std::size_t>(e)];
            const float* v = x + 3 * static_cast<std::size_t>(column[static_cast<std::size_t>(e)]);
            sum += b.col(0) * v[0] + b.col(1) * v[1] + b.col(2) * v[2];
        }
        return sum;
    }
};

/// By rows, in two parts one after the other, since sweeps need one of them at a time and what lies between would be
/// read along: what is below the diagonal, then diagonals and what is above. Columns of a row rise in each.
struct RowBlocks : BlockList {
    int rows = 0;
    std::vector<int> lower_start, upper_start; ///< per row and one past the end; upper_start[i]: its diagonal
    /// visit(entry) for a row's entries, by rising columns.
    template <class Visit>
    void for_each_entry(std::size_t row, const Visit& visit) const {
        for (int e = lower_start[row]; e < lower_start[row + 1]; ++e) visit(static_cast<std::size_t>(e));
        for (int e = upper_start[row]; e < upper_start[row + 1]; ++e) visit(static_cast<std::size_t>(e));
    }
};

/// The structure of a pattern, and for each entry where it comes from: a block of the upper triangle, or -1 - that
/// block, transposed.
RowBlocks make_row_blocks(const BlockPattern& pattern, std::vector<int>& source);
/// The values of a matrix into it, and the sum of each row's blocks, taken in double precision.
void copy_blocks(const BlockMatrix& a, const std::vector<int>& source, RowBlocks& out,
                 std::vector<FloatBlock>& row_sums);
/// Inverses of the blocks at diagonal[i], each with added[i] on the diagonal; false if one is not positive definite.
bool invert_diagonal(const BlockList& a, const std::vector<int>& diagonal, const std::vector<float>& added,
                     std::vector<FloatBlock>& inverse);

} // namespace sinew::solver
