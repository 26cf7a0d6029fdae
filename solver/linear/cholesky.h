// Direct solution by CHOLMOD's supernodal Cholesky, in double precision: one symbolic analysis per pattern, one factor
// per matrix.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/sparse_factor.h"

#include <memory>

namespace sinew::solver {

class Cholesky final : public SparseFactor {
  public:
    /// Analyses the pattern. Sets OpenBLAS to one thread: with two, its sums differ in the last bits.
    /// `own_threads`: CHOLMOD may open OpenMP regions, as it does if left alone; they cost more than they give.
    explicit Cholesky(const BlockPattern& pattern, bool own_threads = false);
    ~Cholesky() override;
    bool factorize(const BlockView& a) override;
    /// Always: where double precision makes no factor, nothing makes one.
    bool surely_indefinite() const override { return true; }
    double factor_operations() const override;
    void release() override;
    std::size_t bytes() const override;
    void solve(const double* b, double* x) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sinew::solver
