// Inertial damping: takes momentum of a body's affine modes (translation, rotation, shear, scaling) out of its
// velocities and leaves all finer motion alone. The affine part of a velocity field v is the field P v = A (x - c) + b
// that is nearest to it in kinetic energy; its momentum is all of v's in those twelve modes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/mass_matrix.h"
#include "solver/numbering.h"
#include "solver/step_inputs.h"

#include <vector>

namespace sinew::solver {

/// Whether some tissue that is not frozen asks for it.
bool damps_affine_momentum(const StepInputs& inputs);

class AffineMomentum {
  public:
    /// v of every tissue becomes v - share P v, share = 1 - (1 - inertialDamping)^(step / affine_damping_time), so that
    /// what is left after a time does not hang on the steps that it is cut into. Of the vertices that are unknowns;
    /// held ones keep their velocity and count for nothing.
    /// \param x, v 3 numbers a vertex [m], [m/s]
    void remove(const Numbering& numbering, const MassMatrix& masses, const StepInputs& inputs,
                const std::vector<double>& x, std::vector<double>& v);

  private:
    std::vector<double> ones_, mass_, places_, of_place_, speeds_, of_speed_; ///< 3 an unknown; with mass: times M
};

} // namespace sinew::solver
