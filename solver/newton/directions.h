// Directions of Newton's method: -H^-1 gradient, or what stands in for it where the Hessian is not positive definite or
// the gradient has kinks.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/newton/minimise.h"

#include <limits>

namespace sinew::solver {

/// What truncated directions go by from one iteration to the next.
struct Truncated {
    bool fresh = true;                                        ///< a new factor is due
    bool negative = false;                                    ///< the Hessian was not positive definite
    double longest = std::numeric_limits<double>::infinity(); ///< that is allowed, in the norm of the factor
    double length = 0;                                        ///< of the last direction
};

/// direction = -H^-1 gradient, or as far as that is defined (linear/truncated_newton.h). Returns the slope along it; 0:
/// there is none.
double find_truncated(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, double residual,
                      const std::vector<double>& x, Truncated& how, bool& definite, StepRecord& record);

/// direction = -H^-1 gradient with the exact Hessian if that is positive definite and gives descent, else with the
/// projected one; `definite` says which. Returns the slope along it; not below 0: not even that one does.
double find_direction(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, double residual,
                      int iteration, const std::vector<double>& x, LinearMemory& memory, bool& definite,
                      StepRecord& record);

/// The same where points that went to and fro over edges are taken to rest on them, for whom a step from one face ends
/// beyond the edge and one from the other back here; 0: there are none, or no such direction. Far from the solution
/// other edges are nearest soon.
double find_direction_to_edges(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, double residual,
                               int iteration, const std::vector<double>& x, LinearMemory& memory, bool& definite,
                               StepRecord& record);

} // namespace sinew::solver
