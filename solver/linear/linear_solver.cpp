// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/linear_solver.h"

#include "solver/stopwatch.h"

#include <algorithm>
#include <cstdlib>

namespace sinew::solver {

namespace {

/// Steps that stay with multigrid or with the kept factor after what is cheaper did not pay; then that is tried again.
constexpr int kept_steps = 24;
/// Newton iterations of one step after which the inexact directions are taken to be what holds it up.
const int patience = getenv("PAT") ? atoi(getenv("PAT")) : 5;
const int plain_iterations = getenv("PLAIN") ? atoi(getenv("PLAIN")) : 100, multigrid_iterations = getenv("MG") ? atoi(getenv("MG")) : 100;
/// A solve with the factor costs about a fiftieth of making it.
constexpr int kept_factor_iterations = 30;

} // namespace

int LinearSolver::break_even() const {
    // Nested dissection of three-dimensional meshes costs about 90 flops per squared vertex count (measured between 73
    // and 98 from 1,225 to 95,033 vertices), at about 10 GFLOP/s for the small supernodes of such sizes. An iteration
    // streams the single-precision blocks and some ten vectors, at about 60 GB/s while they fit the third-level cache
    // and 14 beyond. Constants, not measurements of this run: the choice must repeat.
    const double n = pattern_.rows, blocks = 2 * static_cast<double>(pattern_.block_count()) - n;
    const double factor_seconds = 90 * n * n / 10e9;
    const double bytes = 48 * blocks + 10 * 24 * n;
    const double iteration_seconds = bytes / (bytes < 24e6 ? 60e9 : 14e9) + 2e-6;
    return static_cast<int>(std::clamp(factor_seconds / iteration_seconds, 60.0, 5000.0));
}

void LinearSolver::factorize_and_solve(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                       Outcome& outcome) {
    {
        const Stopwatch timer(outcome.seconds_factor);
        if (!direct_) {
            direct_ = std::make_unique<Cholesky>(pattern_);
            ++symbolic_analyses_;
        }
        outcome.definite = direct_->factorize(a);
        factor_of_this_step_ = outcome.definite;
    }
    const Stopwatch timer(outcome.seconds_solve);
    if (outcome.definite) direct_->solve(b.data(), x.data());
}

void LinearSolver::solve_with_kept_factor(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                          double tolerance, bool projected, Outcome& outcome) {
    if (factor_of_this_step_) {
        ConjugateGradients::Result r;
        {
            const Stopwatch timer(outcome.seconds_solve);
            const ConjugateGradients::Preconditioner factor = [&](const std::vector<double>& in, std::vector<double>& out) {
                direct_->solve(in.data(), out.data());
            };
            if (!iterative_) iterative_ = std::make_unique<ConjugateGradients>(pattern_);
            iterative_->set(a);
            r = iterative_->solve(b.data(), x.data(), tolerance, kept_factor_iterations, &factor);
        }
        outcome.iterations += r.iterations;
        outcome.definite = r.definite;
        if (r.converged || (!r.definite && !projected)) return;
    }
    factorize_and_solve(a, b, x, outcome);
}

ConjugateGradients::Result LinearSolver::iterate(const std::vector<double>& b, std::vector<double>& x, double tolerance,
                                                 LinearMemory& memory, Outcome& outcome) {
    ConjugateGradients::Result r;
    if (memory.multigrid_steps_left == 0) {
        r = iterative_->solve(b.data(), x.data(), tolerance, plain_iterations);
        outcome.iterations += r.iterations;
        if (r.converged || !r.definite) return r;
        memory.multigrid_steps_left = kept_steps;
    }
    if (!multigrid_) multigrid_ = std::make_unique<Multigrid>(iterative_->matrix(), places_);
    if (!multigrid_->set_values()) {
        r.definite = false;
        return r;
    }
    const ConjugateGradients::Preconditioner cycle = [&](const std::vector<double>& in, std::vector<double>& out) {
        multigrid_->apply(in, out);
    };
    r = iterative_->solve(b.data(), x.data(), tolerance, multigrid_iterations, &cycle);
    outcome.iterations += r.iterations;
    return r;
}

LinearSolver::Outcome LinearSolver::solve(LinearMethod method, const BlockMatrix& a, const std::vector<double>& b,
                                          std::vector<double>& x, double tolerance, int newton_iteration,
                                          bool projected, LinearMemory& memory) {
    Outcome outcome;
    x.resize(b.size());
    if (method == LinearMethod::direct) {
        factorize_and_solve(a, b, x, outcome);
        return outcome;
    }
    const bool automatic = method == LinearMethod::automatic;
    if (automatic && newton_iteration >= patience) memory.factor_steps_left = kept_steps;
    if (automatic && memory.factor_steps_left > 0) {
        solve_with_kept_factor(a, b, x, tolerance, projected, outcome);
        return outcome;
    }
    ConjugateGradients::Result r;
    {
        const Stopwatch timer(outcome.seconds_solve);
        if (!iterative_) iterative_ = std::make_unique<ConjugateGradients>(pattern_);
        iterative_->set(a);
        r = iterate(b, x, tolerance, memory, outcome);
    }
    outcome.definite = r.definite;
    if (r.converged || (!r.definite && !projected) || (r.definite && !automatic)) return outcome;
    if (automatic) memory.factor_steps_left = kept_steps;
    factorize_and_solve(a, b, x, outcome);
    return outcome;
}

} // namespace sinew::solver
