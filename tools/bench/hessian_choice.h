// Newton's method on one step with exact Hessians, projected only where one is not positive definite (what the solver
// does), and with each projected always (what many codes do): how many iterations either takes. Built from the solver's
// own potential and factorisation, for the solver has no such option.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/newton/potential.h"

#include <stop_token>

namespace sinew::bench {

struct HessianRun {
    int newton = 0;
    bool converged = false;
    double seconds = 0;    ///< from the start of the step to its end, without making pattern and ordering
    std::vector<double> x; ///< at the end, 3 a vertex [m]
};

/// One step of backward Euler, or of no inertia if `inputs` say so, from `before`. Throws solver::Stopped.
HessianRun solve_step(const solver::Scene& scene, const solver::State& before, const solver::StepInputs& inputs,
                      bool always_project, const std::stop_token& stop = {});

} // namespace sinew::bench
