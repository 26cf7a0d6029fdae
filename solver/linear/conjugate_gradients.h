// Conjugate gradients on 3x3-block matrices, preconditioned by the inverses of the diagonal blocks or by the factor of a
// matrix that is near. The blocks are kept in single precision, which halves what each iteration must read; vectors and sums are double. What single precision
// leaves of the error is Newton's to remove: its residual is evaluated in double.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

#include <functional>
#include <vector>

namespace sinew::solver {

class ConjugateGradients {
  public:
    explicit ConjugateGradients(const BlockPattern& pattern);
    /// Takes the matrix's values.
    void set(const BlockMatrix& a);
    /// z = M^-1 r for some positive definite M; 3 numbers a row.
    using Preconditioner = std::function<void(const std::vector<double>& r, std::vector<double>& z)>;

    struct Result {
        int iterations = 0;
        bool converged = false;
        bool definite = true; ///< false: met a direction of negative curvature, so the matrix is not positive definite
    };
    /// Solves A x = b from x = 0 until |b - A x| <= tolerance |b|, both in the preconditioner's norm.
    /// Without a preconditioner: the inverses of the diagonal blocks. The same bits for any number of threads.
    Result solve(const double* b, double* x, double tolerance, int max_iterations,
                 const Preconditioner* preconditioner = nullptr);

  private:
    /// One block as three columns of four floats (the fourth is 0), so that a row of blocks is a chain of multiply-adds.
    struct alignas(16) Block {
        float column[3][4];
    };
    void multiply(const std::vector<float>& x, std::vector<double>& y) const;
    bool invert_diagonal();
    void precondition(const std::vector<double>& r, std::vector<double>& z) const;
    double dot(const std::vector<double>& a, const std::vector<double>& b);

    const BlockPattern& pattern_;
    const BlockMatrix* matrix_ = nullptr;
    std::vector<int> row_start_, column_; ///< both triangles, by rows
    std::vector<int> source_;             ///< index in the upper triangle; negative - 1 = transposed
    std::vector<Block> blocks_;
    std::vector<double> inverse_; ///< of the diagonal blocks, 9 a row
    std::vector<float> p_single_;
    std::vector<double> r_, z_, p_, ap_, sums_;
};

} // namespace sinew::solver
