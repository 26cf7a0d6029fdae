// Gauss-Seidel on rows of a matrix that have nothing to do with other such rows, so that patches go side by side.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/overlay.h"
#include "solver/linear/row_blocks.h"

#include <vector>

namespace sinew::solver {

/// The block of a matrix in some of its rows, of its pattern and an overlay, and a right side and a solution there.
class CoupledPatch {
  public:
    std::vector<int> rows; ///< of the matrix
    /// Takes the block's values; `local`: per row of the matrix its place among `rows`, or below zero where it is in no
    /// patch. No row here is coupled with one of another patch. False: a row's own block is not positive definite.
    bool set_values(const RowBlocks& fine, const Overlay& overlay, const std::vector<int>& local);

    std::vector<float> right, x; ///< 3 a row and one of padding
    void start_from_zero();
    /// Makes the residuals of rows zero, one after another: down the rows, or up. The first after start_from_zero reads
    /// only what is not zero by then.
    void sweep_down(bool first);
    void sweep_up(bool first);
    /// Of the block times x, the k-th row.
    Float4 product(std::size_t k) const { return block_.product(start_[k], start_[k + 1], x.data()); }

  private:
    void relax(std::size_t k, int begin, int end);

    BlockList block_;                   ///< by `rows`, columns by their places
    std::vector<int> start_, diagonal_; ///< of it: per row and one past the end, and where its diagonal is
    std::vector<FloatBlock> inverse_;
    std::vector<int> place_;       ///< scratch of set_values: per row, among columns_, or -1
    std::vector<int> columns_;     ///< likewise: of one row
    std::vector<FloatBlock> sums_; ///< likewise
    std::vector<float> added_;     ///< to the diagonals: nothing
};

} // namespace sinew::solver
