// Supernodal Cholesky in single precision, for factors that precondition iterations: half the bytes and twice the flops
// a cycle of double precision. The analysis is CHOLMOD's (supernodes.h); the numbers are made here, left-looking, one
// supernode after those it depends on, by dense kernels (block_column.h) and, where blocks are large, by BLAS.
// Independent subtrees of supernodes are made, and solved with, side by side, and of large ones above them the rows are
// made so, each in a fixed order, so that bits do not depend on threads.
//
// The matrix is scaled to a unit diagonal first: what stiffens single unknowns (a spring, a light vertex) leaves no
// trace then in how well the factor is conditioned.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/sparse_factor.h"

#include <memory>

namespace sinew::solver {

class SingleCholesky final : public SparseFactor {
  public:
    explicit SingleCholesky(const BlockPattern& pattern);
    ~SingleCholesky() override;
    /// False also where a matrix is positive definite by less than single precision can tell.
    bool factorize(const BlockView& a) override;
    bool surely_indefinite() const override;
    double factor_operations() const override;
    void release() override;
    std::size_t bytes() const override;
    /// What it takes beside the factor while that is made.
    std::size_t working_bytes() const;
    /// From here on in the memory of another one. The two must not be made at once.
    void share_memory(const SingleCholesky& other);
    /// Right to three digits times the condition of the scaled matrix: what the factor is kept in for solves has 11
    /// bits.
    void solve(const double* b, double* x) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sinew::solver
