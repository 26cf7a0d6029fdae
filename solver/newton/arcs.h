// Moves along a direction on which every body turns as a whole along an arc. A straight move stretches what it should
// turn, by theta^2/2 for an angle theta: in stiff flesh that costs more energy than the motion gains, and the line
// search would let a stiff body turn by a fraction of a degree an iteration. The arc has the same tangent, so it is a
// direction of descent wherever the straight move is, and Newton's quadratic rate stays.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/newton/potential.h"

namespace sinew::solver {

class Arcs {
  public:
    /// Finds each body's turn: the rigid motion nearest to `direction` (3 an unknown) at x (3 a vertex), vertices
    /// weighted by the stiffness about them, so that the stiffest part of a body turns without strain. Where the
    /// direction bends more than a straight move would stretch, as on a beam that is held, or where the stretch of a
    /// straight move costs little of the `gain` [J] that the direction promises the body, it goes straight.
    void fit(const Potential& potential, const std::vector<double>& x, const std::vector<double>& direction,
             const std::vector<double>& gain);
    /// out = x moved along `share` of the direction, both those of fit.
    void move(const Potential& potential, const std::vector<double>& x, const std::vector<double>& direction,
              double share, std::vector<double>& out) const;

  private:
    struct Turn {
        Vec3 centre, rate; ///< the rigid part of the direction is rate x (x - centre) and a shift
    };
    std::vector<Turn> turns_; ///< per deformable
};

} // namespace sinew::solver
