// A symmetric matrix of 3x3 blocks with both triangles by rows, in single precision: what iterations read. Half the
// bytes of double precision; what that leaves of the error is Newton's to remove, whose residual is evaluated in
// double.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

#include <vector>

namespace sinew::solver {

typedef float Float4 __attribute__((vector_size(16)));

/// One block as three columns of four floats (the fourth is 0), so that a row of blocks is a chain of multiply-adds.
struct alignas(16) FloatBlock {
    float column[3][4];
    Float4 col(int c) const { return *reinterpret_cast<const Float4*>(column[c]); }
};

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
