// What a step left behind, looked at from outside: its equations made anew from the states before and after it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/step.h"

#include <string>

namespace sinew::bench {

/// How far the state after a step is from solving the step's equations.
struct StepCheck {
    double residual = 0;  ///< the worst tissue's forces that are left, relative to those at work
    double move = 0;      ///< longest vertex move of Newton's next step with the exact Hessian [m]
    bool definite = true; ///< the exact Hessian is positive definite: a minimum
};

/// `after` must be one step of `in` from `before`: no halvings. TR-BDF2's state in between is recovered from both.
StepCheck check_step(const solver::Scene& scene, const solver::State& before, const solver::StepInputs& in,
                     const solver::State& after);

/// Least det F of all tissues, from the vertices alone: at the corners of quadratic tets.
double least_det(const solver::Scene& scene, const std::vector<double>& x);

/// The first number of the state that is none, in words; empty if all are.
std::string not_a_number(const solver::State& state);

} // namespace sinew::bench
