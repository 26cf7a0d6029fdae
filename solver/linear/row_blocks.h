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
typedef int Int4 __attribute__((vector_size(16)));

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
        return c < 2 ? out : __builtin_shuffle(out, (Int4){1, 2, 3, 0});
    }
};
inline void add_scaled(const FloatBlock& from, float weight, FloatBlock& to) {
    for (int i = 0; i < 9; ++i) to.value[i] += weight * from.value[i];
}

/// Columns of a row are sorted; diagonal[i] is where the diagonal block of row i stands.
struct RowBlocks {
    int rows = 0;
    std::vector<int> row_start, column, diagonal;
    std::vector<FloatBlock> blocks;
    /// sum of A_ij x_j over entries first…last of a row; x has 3 numbers a row and one number of padding.
    Float4 product(int first, int last, const float* x) const {
        Float4 sum = {0, 0, 0, 0};
        for (int e = first; e < last; ++e) {
            const FloatBlock& b = blocks[static_cast<std::size_t>(e)];
            const float* v = x + 3 * static_cast<std::size_t>(column[static_cast<std::size_t>(e)]);
            sum += b.col(0) * v[0] + b.col(1) * v[1] + b.col(2) * v[2];
        }
        return sum;
    }
};

/// The structure of a pattern, and for each entry where it comes from: a block of the upper triangle, or -1 - that
/// block, transposed.
RowBlocks make_row_blocks(const BlockPattern& pattern, std::vector<int>& source);
/// The values of a matrix into it, and the sum of each row's blocks, taken in double precision.
void copy_blocks(const BlockMatrix& a, const std::vector<int>& source, RowBlocks& out,
                 std::vector<FloatBlock>& row_sums);
/// Inverses of the diagonal blocks, each with its row's `added` on the diagonal; false if one is not positive definite.
bool invert_diagonal(const RowBlocks& a, const std::vector<float>& added, std::vector<FloatBlock>& inverse);

} // namespace sinew::solver
