// Conjugate gradients on 3x3-block matrices, preconditioned by a multigrid cycle or by the factor of a matrix that
// is near. Blocks are single precision (row_blocks.h), vectors and sums double.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/row_blocks.h"

#include <functional>
#include <vector>

namespace sinew::solver {

class ConjugateGradients {
  public:
    explicit ConjugateGradients(const BlockPattern& pattern);
    /// Takes the matrix's values. Its overlay is read where it stands, until the next call.
    void set(const BlockMatrix& a);
    const RowBlocks& matrix() const { return matrix_; }
    /// z = M^-1 r for some positive definite M; 3 numbers a row.
    using Preconditioner = std::function<void(const std::vector<double>& r, std::vector<double>& z)>;

    struct Result {
        int iterations = 0;
        bool converged = false;
        bool definite = true; ///< false: met a direction of negative curvature, so the matrix is not positive definite
    };
    /// Solves A x = b from x = 0 until |b - A x| <= tolerance |b|, both in the preconditioner's norm.
    /// The same bits for any number of threads.
    Result solve(const double* b, double* x, double tolerance, int max_iterations,
                 const Preconditioner& preconditioner);

  private:
    void multiply(const std::vector<double>& x, std::vector<double>& y) const;
    double dot(const std::vector<double>& a, const std::vector<double>& b);

    std::vector<int> source_; ///< where each block comes from
    RowBlocks matrix_;
    std::vector<FloatBlock> row_sums_;
    const Overlay* overlay_ = nullptr;
    std::vector<double> r_, z_, p_, ap_, sums_;
};

} // namespace sinew::solver
