// Tells forces that rounding makes from forces that a better step would lower. Newton's step with an exact, definite
// Hessian brings even a flat minimum (any even power of the distance) below half of its force. Where two in a row do
// not, though each was taken whole, solved its linear system for each body, and promised less than rounding does to the
// energy, what is left is rounding's.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"
#include "solver/newton/potential.h"

#include <vector>

namespace sinew::solver {

class RoundingFloor {
  public:
    static constexpr double strict = 1e-4; ///< no larger residual (sum / at work) is ever called rounding's

    /// Nothing is known: at the start, and after a step that says nothing.
    void forget() { least_.clear(); }
    /// Before a whole step along `direction` from where the potential has this gradient and Hessian.
    void take_direction(const Potential& potential, const BlockMatrix& hessian, const std::vector<double>& gradient,
                        const std::vector<double>& direction);
    /// The forces after that step.
    void take_forces(const std::vector<BodyForces>& forces);
    /// Whether every body is within the tolerance or on its floor.
    bool reached(const std::vector<BodyForces>& forces, double tolerance) const;

  private:
    std::vector<double> left_;  ///< of each body's force, by the linear system [N]
    std::vector<double> least_; ///< of each body's force, over whole steps in a row [N]
    std::vector<int> idle_;     ///< of these, how many at the end did not bring it down
    std::vector<double> product_;
};

/// Whether a body that is not within the tolerance has clearly less force left at `elsewhere` than at `here`.
bool is_lower(const std::vector<BodyForces>& elsewhere, const std::vector<BodyForces>& here, double tolerance);

} // namespace sinew::solver
