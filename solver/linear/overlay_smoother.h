// Gauss-Seidel on the rows that an overlay couples, before and after a preconditioner that knows the pattern alone: in
// what touches, both sides of a contact press on each other, and a factor or grids made of each side's own share see
// each pressed against something that does not give.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/row_strip.h"

#include <functional>
#include <vector>

namespace sinew::solver {

class OverlaySmoother {
  public:
    /// `fine`: the pattern's share of the matrix. It outlives this.
    explicit OverlaySmoother(const RowBlocks& fine);
    /// Takes the values that `fine` has now, and the overlay's. False: the matrix is not positive definite.
    bool set_values(const Overlay& overlay);
    /// z = M^-1 r, 3 numbers a row, of the sweeps down the rows, `inner` on what they leave, and the sweeps up:
    /// symmetric where inner is, positive definite where inner and the matrix are. The same bits for any number of
    /// threads.
    using Inner = std::function<void(const std::vector<double>& r, std::vector<double>& z)>;
    void apply(const Inner& inner, const std::vector<double>& r, std::vector<double>& z);

  private:
    void find_rows(const std::vector<int>& rows);
    void gather(const Overlay& overlay);
    void relax(std::size_t k);

    const RowBlocks& fine_;
    std::vector<int> rows_, local_;         ///< those coupled; per row of the whole: its place among them, or -1
    RowStrip beside_;                       ///< rows that are not coupled: their entries in columns that are
    RowStrip within_;                       ///< all coupled rows: their entries in columns that are not
    BlockList coupled_;                     ///< the coupled rows' block of the whole matrix, by their places
    std::vector<int> row_start_, diagonal_; ///< of it: per row and one past the end, and where its diagonal is
    std::vector<FloatBlock> inverse_;
    std::vector<float> right_, x_; ///< of the coupled rows, 3 a row and one of padding
    std::vector<double> swept_, rest_;
    std::vector<int> place_;       ///< scratch of gather: per coupled row, among those below, or -1
    std::vector<int> columns_;     ///< likewise: of one row
    std::vector<FloatBlock> sums_; ///< likewise
    std::vector<float> added_;     ///< to the coupled rows' diagonals: nothing
};

} // namespace sinew::solver
