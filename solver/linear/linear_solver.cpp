// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/linear_solver.h"

#include "solver/stopwatch.h"

#include <algorithm>

namespace sinew::solver {

namespace {

/// Steps that stay with the kept factor after multigrid did not pay; then that is tried again.
constexpr int kept_steps = 24;
/// Newton iterations of one step after which the inexact directions are taken to be what holds it up; more where a
/// factor is dear.
int patience(int break_even) { return std::max(5, break_even / 40); }
/// A solve with the factor costs about a fiftieth of making it.
constexpr int kept_factor_iterations = 30;
/// Solving more exactly than this costs more with the kept factor than the Newton iterations that it may save.
constexpr double kept_factor_tolerance = 1e-2;
/// Up to here a factor is too cheap for anything else to pay.
constexpr int small_rows = 200;
/// Where there is no factor to fall back on.
constexpr int most_iterations = 5000;

} // namespace

int LinearSolver::break_even() const {
    // Nested dissection of three-dimensional meshes costs about 90 flops per squared vertex count (measured between 73
    // and 98 from 1,225 to 95,033 vertices), at about 10 GFLOP/s for the small supernodes of such sizes. An iteration
    // with a multigrid cycle streams the single-precision blocks four and a half times and some forty vectors, at about
    // 60 GB/s while they fit the third-level cache and 14 beyond. Constants, not measurements of this run: the choice
    // must repeat.
    const double n = pattern_.rows, blocks = 2 * static_cast<double>(pattern_.block_count()) - n;
    const double factor_seconds = 90 * n * n / 10e9;
    const double bytes = 4.5 * 52 * blocks + 40 * 24 * n;
    const double iteration_seconds = bytes / (48 * blocks < 24e6 ? 60e9 : 14e9) + 2e-5;
    return static_cast<int>(std::clamp(factor_seconds / iteration_seconds, 30.0, 1000.0));
}

void LinearSolver::make_factors(bool plain) {
    if (factors_ && plain == plain_factors_) return;
    factors_ = std::make_unique<ComponentFactors>(pattern_, plain ? Factoring::plain : Factoring::by_component);
    plain_factors_ = plain;
    ++symbolic_analyses_;
}

void LinearSolver::factorize_and_solve(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                       Outcome& outcome, bool plain) {
    {
        const Stopwatch timer(outcome.seconds_factor);
        make_factors(plain);
        outcome.definite = factor_of_this_step_ = factors_->factorize(a);
    }
    const Stopwatch timer(outcome.seconds_solve);
    if (outcome.definite) factors_->solve(b.data(), x.data());
}

void LinearSolver::solve_with_kept_factor(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                          double tolerance, bool projected, Outcome& outcome) {
    if (factor_of_this_step_) {
        ConjugateGradients::Result r;
        {
            const Stopwatch timer(outcome.seconds_solve);
            const ConjugateGradients::Preconditioner factor = [&](const std::vector<double>& in,
                                                                  std::vector<double>& out) {
                factors_->solve(in.data(), out.data());
            };
            if (!iterative_) iterative_ = std::make_unique<ConjugateGradients>(pattern_);
            iterative_->set(a);
            r = iterative_->solve(b.data(), x.data(), std::max(tolerance, kept_factor_tolerance),
                                  kept_factor_iterations, factor);
        }
        outcome.iterations += r.iterations;
        outcome.definite = r.definite;
        if (r.converged || (!r.definite && !projected)) return;
    }
    factorize_and_solve(a, b, x, outcome);
}

ConjugateGradients::Result LinearSolver::iterate(const BlockMatrix& a, const std::vector<double>& b,
                                                 std::vector<double>& x, double tolerance, int most) {
    if (!iterative_) iterative_ = std::make_unique<ConjugateGradients>(pattern_);
    iterative_->set(a);
    if (!multigrid_) multigrid_ = std::make_unique<Multigrid>(iterative_->matrix(), places_);
    if (!multigrid_->set_values()) return {0, false, false};
    const ConjugateGradients::Preconditioner cycle = [&](const std::vector<double>& in, std::vector<double>& out) {
        multigrid_->apply(in, out);
    };
    return iterative_->solve(b.data(), x.data(), tolerance, most, cycle);
}

LinearSolver::Outcome LinearSolver::solve(LinearMethod method, const BlockMatrix& a, const std::vector<double>& b,
                                          std::vector<double>& x, double tolerance, int newton_iteration,
                                          bool projected, LinearMemory& memory) {
    Outcome outcome;
    x.resize(b.size());
    const bool automatic = method == LinearMethod::automatic;
    const bool plain = method == LinearMethod::plain;
    if (plain || method == LinearMethod::direct || (automatic && pattern_.rows <= small_rows)) {
        factorize_and_solve(a, b, x, outcome, plain);
        return outcome;
    }
    if (automatic && newton_iteration >= patience(break_even())) memory.factor_steps_left = kept_steps;
    if (automatic && memory.factor_steps_left > 0) {
        solve_with_kept_factor(a, b, x, tolerance, projected, outcome);
        return outcome;
    }
    ConjugateGradients::Result r;
    {
        const Stopwatch timer(outcome.seconds_solve);
        r = iterate(a, b, x, tolerance, automatic ? break_even() : most_iterations);
    }
    outcome.iterations = r.iterations;
    outcome.definite = r.definite;
    // The projected matrix is the last there is: where single precision cannot solve it, a factor must.
    if (r.converged || (!projected && (!r.definite || !automatic))) return outcome;
    if (automatic) memory.factor_steps_left = kept_steps;
    factorize_and_solve(a, b, x, outcome);
    return outcome;
}

} // namespace sinew::solver
