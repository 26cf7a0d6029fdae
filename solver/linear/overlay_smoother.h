// Gauss-Seidel on the rows that an overlay couples, before and after a preconditioner that knows the pattern alone: in
// what touches, both sides of a contact press on each other, and a factor or grids made of each side's own share see
// each pressed against something that does not give.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/row_blocks.h"

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
    /// Of a row that the overlay couples.
    struct Gathered {
        std::vector<int> columns; ///< local
        std::vector<Mat3> blocks;
        std::vector<int> place; ///< per local column: among the above, or -1
    };
    void find_rows(const std::vector<int>& rows);
    void gather(const Overlay& overlay);
    Float4 coupled(std::size_t k, const float* x) const;
    Vec3 fine_product(std::size_t row, bool inside, const std::vector<double>& x) const;
    void relax(std::size_t k);

    const RowBlocks& fine_;
    std::vector<int> rows_, local_;   ///< those coupled; per row of the whole: its place among them, or -1
    std::vector<int> beside_;         ///< rows that are not coupled, but have entries in columns that are
    std::vector<int> seen_;           ///< scratch: per row of the whole, whether it is in beside_
    std::vector<int> start_, column_; ///< the coupled rows' block of the whole matrix, local numbers
    std::vector<FloatBlock> blocks_, inverse_;
    std::vector<float> right_, x_; ///< of the coupled rows, 3 a row and one of padding
    std::vector<double> rest_;
    Gathered gathered_;
};

} // namespace sinew::solver
