// What an implicit scheme asks of one nonlinear solve: minimise
//   (m/2) |x' - target|^2_M + Psi(x') + damping,  with the new velocity v' = velocity_factor x' + velocity_offset.
// Each scheme fills this in a file of its own.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/state.h"
#include "solver/step_inputs.h"

#include <vector>

namespace sinew::solver {

struct ImplicitForm {
    double mass_factor = 0;              ///< m [1/s^2]; 0 = no inertia
    double velocity_factor = 0;          ///< [1/s]; 0 = no velocity, so no damping either
    std::vector<double> target;          ///< 3 a vertex [m]
    std::vector<double> velocity_offset; ///< 3 a vertex [m/s]
};

/// Backward Euler: v' = (x' - x)/h, target = x + h v, m = 1/h^2. First order.
void backward_euler_form(const State& before, double step_size, ImplicitForm& form);
/// No momentum: equilibrium under the present loads, v' = 0.
void quasi_static_form(const State& before, ImplicitForm& form);

/// The form of the integrator that `inputs` names.
void make_form(const State& before, const StepInputs& inputs, ImplicitForm& form);
/// New velocities from new positions, 3 a vertex.
void update_velocity(const ImplicitForm& form, const std::vector<double>& x, std::vector<double>& v);

} // namespace sinew::solver
