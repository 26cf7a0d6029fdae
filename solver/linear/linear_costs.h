// What the ways to solve a linear system cost, counted from the matrix's pattern. Constants, not measurements of a run:
// the choice between them must repeat.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

namespace sinew::solver {

/// In seconds of a machine with two cores and AVX2; only their ratios matter.
struct LinearCosts {
    double factor = 0;       ///< in single precision, component by component
    double factor_solve = 0; ///< with it, and one product with the matrix
    double cycle = 0;        ///< an iteration with a multigrid cycle
    double hierarchy = 0;    ///< the coarse matrices of a new matrix
    double factor_bytes = 0; ///< that its numbers take
};

LinearCosts linear_costs(const BlockPattern& pattern);

} // namespace sinew::solver
