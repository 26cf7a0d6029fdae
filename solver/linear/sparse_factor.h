// What a factor of a symmetric positive definite matrix can do, however it is made.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

namespace sinew::solver {

class SparseFactor {
  public:
    virtual ~SparseFactor() = default;
    /// False if the matrix is not positive definite (or not finite).
    virtual bool factorize(const BlockMatrix& a) = 0;
    /// Solves A x = b with the last factor; 3 numbers a row.
    virtual void solve(const double* b, double* x) = 0;
    /// Floating-point operations of one factorisation, as the analysis counts them.
    virtual double factor_operations() const = 0;
};

} // namespace sinew::solver
