// Newton directions where the Hessian need not be positive definite: conjugate gradients on it, preconditioned by a
// factor of its projection, which is. Where they meet negative curvature they end, and go along that as far as they
// would if it were positive (Dauphin et al. 2014): from near a saddle, as of a sheet that is about to buckle, that
// leads away at once, where steps of the projected matrix crawl.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"
#include "solver/linear/component_factors.h"

#include <functional>

namespace sinew::solver {

class TruncatedNewton {
  public:
    struct Result {
        int iterations = 0;
        bool converged = false;
        bool negative = false; ///< curvature was met
        double length = 0;     ///< of x in the norm of the preconditioner
    };
    /// x = A^-1 b, until the residual in the norm of the preconditioner is `tolerance` times that of b, after so many
    /// iterations, or where x would get longer than `longest` in that norm (Steihaug 1983). Double precision
    /// throughout.
    Result solve(const BlockMatrix& a, ComponentFactors& preconditioner, const std::vector<double>& b,
                 std::vector<double>& x, double tolerance, int most_iterations, double longest);

  private:
    std::vector<double> r_, z_, p_, ap_;
};

} // namespace sinew::solver
