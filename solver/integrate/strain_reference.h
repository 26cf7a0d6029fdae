// How a time scheme sees strains: the rate of a strain E at the end of a stage by the scheme's own formula is
//   velocity_factor (E(x') - E_ref),  E_ref = start E(x) + between E(x_between) + rate dE/dt(x, v).
// Strains do not see a body turn, which the chord from x to x' does: damping by them leaves rotations alone.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

namespace sinew::solver {

struct StrainReference {
    const std::vector<double>* x = nullptr; ///< at the start of the step, 3 a vertex [m]
    double start = 1;
    const std::vector<double>* x_between = nullptr; ///< another time the scheme looks at; null where its weight is 0
    double between = 0;
    /// Velocities at the start of the step, for dE/dt there, 3 a vertex [m/s]; null where its weight is 0. Velocities
    /// of turning bodies are chords and strain them by a little: where the last step's rate of strain is remembered and
    /// `takes_known_rate`, that is taken in their place.
    const std::vector<double>* v = nullptr;
    bool takes_known_rate = false;
    double rate = 0; ///< [s]
};

} // namespace sinew::solver
