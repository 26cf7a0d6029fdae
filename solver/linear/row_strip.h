// Some entries of some rows of a matrix: what a solve of a few rows has to do with the others.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/row_blocks.h"

#include <vector>

namespace sinew::solver {

struct RowStrip {
    std::vector<int> rows, start{0}, entries; ///< entries: of the matrix, those of rows[k] from start[k] on
    void clear();
    /// After the entries of a row have been put into `entries`.
    void end_row(int row);
    /// Sum of A_ij x_j over the entries of rows[place]; x has 3 numbers a row.
    Vec3 product(const BlockList& a, std::size_t place, const std::vector<double>& x) const;
};

} // namespace sinew::solver
