// One door to the linear solvers. Auto takes conjugate gradients with a multigrid cycle. Where those take too many
// iterations, or Newton does not converge on what they give (stiff attachments on soft flesh), it goes over to a kept
// factor for a while: one factorisation a step, which then preconditions conjugate gradients on the step's later
// matrices. The choice is by counted cost, never by the clock, so that the same scene takes the same path everywhere;
// and no factor outlives its step, so that a result never depends on what a workspace happens to hold.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/component_factors.h"
#include "solver/linear/conjugate_gradients.h"
#include "solver/linear/multigrid.h"

#include <memory>

namespace sinew::solver {

/// `plain` is the yardstick that the others are measured against: CHOLMOD as it comes, on all bodies at once, in every
/// Newton iteration.
enum class LinearMethod { automatic, direct, iterative, plain };

/// What Auto remembers from step to step. Part of the simulation's state: the next step reads it.
struct LinearMemory {
    int factor_steps_left = 0; ///< steps that take the kept factor at once, after multigrid did not pay
};

class LinearSolver {
  public:
    LinearSolver(const BlockPattern& pattern, UnknownPlaces places)
        : pattern_(pattern)
        , places_(std::move(places)) {}

    struct Outcome {
        bool definite = false; ///< false: the matrix is not positive definite, x is not set
        int iterations = 0;    ///< of conjugate gradients, also those that were given up
        double seconds_factor = 0, seconds_solve = 0;
    };
    /// A new step: the factor of the last one is not used any more.
    void begin_step() { factor_of_this_step_ = false; }
    /// Solves A x = b. `newton_iteration` counts from 0 in the step. `projected`: the matrix is positive definite by
    /// construction, so iterations that find otherwise met the limits of single precision, and the factor decides.
    /// `tolerance` is for the iterative path; the direct one is exact to rounding.
    Outcome solve(LinearMethod method, const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                  double tolerance, int newton_iteration, bool projected, LinearMemory& memory);
    int symbolic_analyses() const { return symbolic_analyses_; }
    /// Iterations after which a factorisation would have been cheaper.
    int break_even() const;

  private:
    void make_factors(bool plain);
    void factorize_and_solve(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                             Outcome& outcome, bool plain = false);
    void solve_with_kept_factor(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                double tolerance, bool projected, Outcome& outcome);
    ConjugateGradients::Result iterate(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                       double tolerance, int most);
    const BlockPattern& pattern_;
    UnknownPlaces places_;
    std::unique_ptr<ComponentFactors> factors_;     ///< made when first needed
    std::unique_ptr<ConjugateGradients> iterative_; ///< made when first needed
    std::unique_ptr<Multigrid> multigrid_;          ///< likewise
    bool plain_factors_ = false;
    int symbolic_analyses_ = 0;
    bool factor_of_this_step_ = false; ///< factors_ holds one
};

} // namespace sinew::solver
