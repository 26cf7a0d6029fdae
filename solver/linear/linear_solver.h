// One door to the linear solvers. Auto takes conjugate gradients with a multigrid cycle, and around it exact solves of
// what attachments hold too stiffly for grids (held_block.h). Where the iterations of a step have cost as much as a
// factor would (stiff attachments on soft flesh, small bodies), or Newton does not converge on what they give, it goes
// over to a kept factor for a while: made once, in single precision, it preconditions conjugate gradients on the later
// matrices of this frame and the next ones, until those take so many iterations that a new one is cheaper. The choice
// is by counted cost (linear_costs.h), never by the clock. An overlay's share is solved for by conjugate gradients in
// any case, smoothed around grids or factor (overlay_smoother.h). A factor that outlives its frame is the state's: a
// workspace that holds another one makes it again from what stands there, so no result depends on what that happens to
// hold.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/component_factors.h"
#include "solver/linear/conjugate_gradients.h"
#include "solver/linear/held_block.h"
#include "solver/linear/linear_costs.h"
#include "solver/linear/linear_method.h"
#include "solver/linear/multigrid.h"
#include "solver/linear/overlay_smoother.h"
#include "solver/linear/truncated_newton.h"

#include <memory>

namespace sinew::solver {

class LinearSolver {
  public:
    LinearSolver(const BlockPattern& pattern, UnknownPlaces places);

    struct Outcome {
        bool definite = false; ///< false: the matrix is not positive definite, x is not set
        int iterations = 0;    ///< of conjugate gradients, also those that were given up
        int factors = 0;       ///< made
        double seconds_factor = 0, seconds_solve = 0;
        bool worn = false; ///< solve_truncated: a new factor would be cheaper
    };
    /// A new frame: of the factor that it begins with, see LinearMemory.
    void begin_frame(const LinearMemory& memory);
    /// Puts the factor into it that the next frame is to begin with, if one is still worth it.
    void end_frame(LinearMemory& memory);
    /// A new nonlinear solve: what its iterations cost is counted anew. What holds unknowns: see find_held_rows.
    void begin_step(std::span<const double> springs, std::span<const double> elastic);
    /// Flags of the bodies whose rows are those of the identity from here on, and zero in b: no factor is made for
    /// them. Bodies that the pattern couples have the same flag. An empty list: none.
    void rest(std::span<const char> bodies);
    /// Whether what the coming matrices are Hessians of has kinks, as where contacts come and go: then it is those that
    /// hold Newton's method up, not inexact directions.
    void set_kinked(bool kinked) { kinked_ = kinked; }
    /// Solves A x = b. `newton_iteration` counts from 0 in the step. `projected`: the matrix is positive definite by
    /// construction, so iterations that find otherwise met the limits of single precision, and the factor decides.
    /// `tolerance` is for the iterative path; the direct one is exact to rounding.
    Outcome solve(LinearMethod method, const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                  double tolerance, int newton_iteration, bool projected, LinearMemory& memory);
    /// For sheets, whose Hessian is seldom positive definite. Makes a factor to precondition solve_truncated with;
    /// false: the matrix is not positive definite. With `must` what single precision cannot tell is tried in double.
    bool precondition(const BlockMatrix& a, bool must, Outcome& outcome);
    bool is_preconditioned() const { return kept_ == Kept::single || kept_ == Kept::full; }
    /// x = A^-1 b with that factor, which may be of an earlier matrix. `definite` says whether no negative curvature
    /// was met; x gives descent in any case.
    /// `length`: how far x may go at most in the norm of the factor, and how far it goes.
    void solve_truncated(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x, double tolerance,
                         double& length, Outcome& outcome);
    bool takes_sheets(LinearMethod method) const { return method == LinearMethod::automatic && places_.any_sheet; }
    int symbolic_analyses() const { return symbolic_analyses_; }

  private:
    /// The factor that `factors_` or `single_` holds.
    enum class Kept { none, full, single };
    bool make_single(const BlockMatrix& a, Outcome& outcome);
    void prepare_single();
    void keep_rounded(const BlockMatrix& a);
    void make_again();
    void factorize_and_solve(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                             double tolerance, bool projected, Outcome& outcome, bool plain = false);
    ConjugateGradients::Result iterate_with_factor(const BlockMatrix& a, const std::vector<double>& b,
                                                   std::vector<double>& x, double tolerance, int most,
                                                   Outcome& outcome);
    void solve_with_kept_factor(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                double tolerance, int newton_iteration, bool projected, Outcome& outcome);
    ConjugateGradients::Result iterate(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                       double tolerance, int most);
    int allowed_cycles(int newton_iteration, double solves) const;
    void make_multigrid();
    ConjugateGradients::Result precondition_and_iterate(const BlockMatrix& a, const std::vector<double>& b,
                                                        std::vector<double>& x, double tolerance, int most,
                                                        const ConjugateGradients::Preconditioner& by_pattern);
    /// Whether a usual step costs less with a factor that is kept than with multigrid.
    bool factor_is_cheaper() const;
    double factor_cost(double solves) const;
    double hierarchy_cost() const;
    double cycle_cost() const;
    const BlockPattern& pattern_;
    UnknownPlaces places_;
    HeldRows held_;                         ///< that the grids were, or will be, made for
    std::vector<double> springs_, elastic_; ///< of which held_ was made
    LinearCosts costs_, held_costs_;
    /// Made when first needed. Only one of them holds a factor that is large: the one that was made last.
    std::unique_ptr<ComponentFactors> factors_, single_;
    std::unique_ptr<ConjugateGradients> iterative_; ///< likewise
    std::unique_ptr<Multigrid> multigrid_;          ///< likewise
    std::unique_ptr<OverlaySmoother> smoother_;     ///< likewise
    std::unique_ptr<HeldBlock> held_block_;         ///< with multigrid_; null: nothing is held
    TruncatedNewton truncated_;
    bool plain_factors_ = false;
    int symbolic_analyses_ = 0;
    Kept kept_ = Kept::none;
    std::uint64_t mark_;         ///< of the pattern
    std::vector<float> made_of_; ///< what single_ was made of: each component of it, when that was
    /// The same where a state has it; and what single_ is to be made of again before it is used.
    std::shared_ptr<const FactorSource> source_, again_;
    bool used_ = false;         ///< the kept factor, in this frame
    int late_iterations_ = 0;   ///< see LinearMemory
    int fresh_iterations_ = 0;  ///< likewise
    std::vector<char> resting_; ///< per row; empty: none does
    bool kinked_ = false;
    bool indefinite_ = false; ///< the last factor of an exact Hessian in this step found it so
    double spent_ = 0;        ///< on multigrid in this step, as costs_ count
};

} // namespace sinew::solver
