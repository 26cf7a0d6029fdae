// Direct solution for one unknown a vertex (maps, harmonic fields), by CHOLMOD's supernodal Cholesky: one analysis
// (METIS) and any number of factors and right-hand sides. For three unknowns a vertex see cholesky.h.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/SparseCore>

#include <memory>

namespace sinew::solver {

class ScalarCholesky {
  public:
    /// Analyses the pattern of a symmetric matrix, compressed; its upper triangle is not looked at. Throws Error FE305
    /// (memory).
    explicit ScalarCholesky(const Eigen::SparseMatrix<double>& pattern);
    ~ScalarCholesky();
    /// Numeric factorisation of a matrix with the analysed pattern; the same bits on every run. False if it is not
    /// positive definite (or not finite): then there is no factor. Throws std::bad_alloc.
    bool factorize(const Eigen::SparseMatrix<double>& a);
    /// Solves A x = b with the last factor. Not for several threads at once. Throws Error FE305 (memory).
    Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sinew::solver
