// One regular tet whose four vertices hang on springs: exactly one degree of freedom, whatever the material.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/beams.h"

#include <complex>

namespace sinew::bench {

class Oscillator {
  public:
    /// Starts from rest in gravity, or upwards at `speed` [m/s] without it.
    Oscillator(solver::Integrator integrator, double step_size, double damping_per_mass = 0, double speed = 0);
    double omega, sag; ///< circular frequency [rad/s], static sag under gravity [m]
    double height() const { return position(sim.state.x, 0).z() - rest_height_; } ///< of the tet over its rest [m]
    double speed() const { return sim.state.v[2]; }                               ///< upwards [m/s]
    /// What BDF2 knows of the step before: height + speed / (i omega).
    void set_history(std::complex<double> y);
    /// From what is known to `end` [s] in `steps` equal steps, from rest; the error of the height there [m].
    static double error_at(solver::Integrator integrator, double end, int steps);
    Simulation sim;

  private:
    double rest_height_;
};

} // namespace sinew::bench
