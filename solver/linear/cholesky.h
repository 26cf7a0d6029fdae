// Direct solution by CHOLMOD's supernodal Cholesky: one symbolic analysis per pattern (METIS on the vertex graph,
// expanded to three unknowns a vertex, which finds the same fill in half the time), one factor per matrix.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

#include <memory>

namespace sinew::solver {

class Cholesky {
  public:
    /// Analyses the pattern. Sets OpenBLAS to one thread: with two, its sums differ in the last bits.
    /// `own_threads`: CHOLMOD may open OpenMP regions, as it does if left alone; they cost more than they give.
    explicit Cholesky(const BlockPattern& pattern, bool own_threads = false);
    ~Cholesky();
    /// Numeric factorisation. False if the matrix is not positive definite (or not finite).
    bool factorize(const BlockMatrix& a);
    /// Floating-point operations of one factorisation, as the analysis counts them.
    double factor_operations() const;
    /// Solves A x = b with the last factor; 3 numbers a row.
    void solve(const double* b, double* x);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sinew::solver
