// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/directions.h"

#include "solver/parallel.h"
#include "solver/stopwatch.h"

#include <algorithm>

namespace sinew::solver {

namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return ordered_sum(a.size(), [&](std::size_t i) { return a[i] * b[i]; });
}

/// How exactly the linear system needs to be solved: loosely far from the solution, where a better direction buys
/// nothing, to the residual itself nearer to it, where that keeps Newton's quadratic convergence, and no further than a
/// fifth of what is missing when this iteration can be the last. Where each digit costs the same, as with conjugate
/// gradients alone, quadratic convergence is not worth its digits.
double forcing(double residual, const NewtonOptions& options) {
    const double last = 0.2 * options.tolerance / residual;
    if (options.method == LinearMethod::iterative) return std::clamp(last, 1e-3, 1e-1);
    return std::clamp(std::max(residual, last), 1e-3, 3e-2);
}

/// Given up when this dies.
struct KeptToEdges {
    Potential& potential;
    ~KeptToEdges() { potential.keep_to_edges(false); }
};

} // namespace

double find_truncated(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, double residual,
                      const std::vector<double>& x, Truncated& how, bool& definite, StepRecord& record) {
    LinearSolver::Outcome outcome;
    const auto assemble = [&](bool project, BlockMatrix& a) {
        const Stopwatch timer(record.seconds_assembly);
        potential.assemble(x, project, a);
    };
    assemble(false, w.hessian);
    bool good = w.linear.is_preconditioned() && !how.fresh;
    // The Hessian itself, where it may be positive definite, else its projection.
    if (!good && !how.negative) good = w.linear.precondition(w.hessian, false, outcome);
    if (!good) {
        if (!w.projected) w.projected = std::make_unique<BlockMatrix>(potential.pattern());
        assemble(true, *w.projected);
        good = w.linear.precondition(*w.projected, true, outcome);
    }
    how.length = how.longest;
    if (good)
        w.linear.solve_truncated(w.hessian, w.gradient, w.direction, forcing(residual, options), how.length, outcome);
    how.fresh = outcome.worn, how.negative = !outcome.definite;
    record.linear_iterations += outcome.iterations;
    record.factorizations += outcome.factors;
    record.seconds_factor += outcome.seconds_factor;
    record.seconds_solve += outcome.seconds_solve;
    if (!good) return 0;
    definite = outcome.definite;
    for (double& d : w.direction) d = -d;
    potential.stop_frozen_unknowns(w.direction);
    return dot(w.gradient, w.direction);
}

double find_direction(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, double residual,
                      int iteration, const std::vector<double>& x, LinearMemory& memory, bool& definite,
                      StepRecord& record) {
    double slope = 0;
    for (const bool project : {false, true}) {
        definite = !project;
        {
            const Stopwatch timer(record.seconds_assembly);
            potential.assemble(x, project, w.hessian);
        }
        w.linear.set_kinked(potential.contacts_press());
        const LinearSolver::Outcome outcome = w.linear.solve(options.method, w.hessian, w.gradient, w.direction,
                                                             forcing(residual, options), iteration, project, memory);
        record.linear_iterations += outcome.iterations;
        record.factorizations += outcome.factors;
        record.seconds_factor += outcome.seconds_factor;
        record.seconds_solve += outcome.seconds_solve;
        if (!outcome.definite) continue;
        for (double& d : w.direction) d = -d;
        potential.stop_frozen_unknowns(w.direction);
        slope = dot(w.gradient, w.direction);
        if (slope < 0) break;
    }
    return slope;
}

double find_direction_to_edges(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, double residual,
                               int iteration, const std::vector<double>& x, LinearMemory& memory, bool& definite,
                               StepRecord& record) {
    constexpr double near_enough = 0.3; // the residual
    if (!(residual < near_enough) || !potential.keep_to_edges(true)) return 0;
    w.gradient_here = w.gradient;
    double slope = 0;
    {
        const KeptToEdges guard{potential};
        {
            const Stopwatch timer(record.seconds_assembly);
            potential.evaluate(x, &w.gradient, nullptr);
        }
        slope = find_direction(potential, w, options, residual, iteration, x, memory, definite, record);
    }
    w.gradient.swap(w.gradient_here);
    return slope < 0 ? dot(w.gradient, w.direction) : 0;
}

} // namespace sinew::solver
