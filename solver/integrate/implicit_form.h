// What an implicit scheme asks of one nonlinear solve: minimise
//   (m/2) |x' - target|^2_M + Psi(x') + damping,  with the new velocity v' = velocity_factor x' + velocity_offset.
// Each scheme fills this in a file of its own; TR-BDF2 does so twice a step.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/integrate/strain_reference.h"
#include "solver/state.h"
#include "solver/step_inputs.h"

#include <array>
#include <cmath>
#include <vector>

namespace sinew::solver {

struct ImplicitForm {
    double mass_factor = 0;              ///< m [1/s^2]; 0 = no inertia
    double velocity_factor = 0;          ///< [1/s]; 0 = no velocity, so no damping either
    std::vector<double> target;          ///< 3 a vertex [m]
    std::vector<double> velocity_offset; ///< 3 a vertex [m/s]
    StrainReference strain;              ///< points into the states that the form was made from
    double press = 1;                    ///< how many times what touches counts (TermType::presses)
    /// Where bones are at the end of the stage and how fast they move there: weights on their positions at the start
    /// of the last step, at the start of this one and at its end (a parabola through the three, or a line). Where
    /// `bones_within` is not null, it stands for the first: positions at tr_bdf2_gamma of this step.
    std::array<double, 3> bone_position{0, 0, 1}, bone_velocity{};
    const std::vector<Points>* bones_within = nullptr;
};

/// Backward Euler: v' = (x' - x)/h, target = x + h v, m = 1/h^2. First order.
void backward_euler_form(const State& before, double step_size, ImplicitForm& form);

/// BDF2 with a variable step, r = h/h_before: v' = ((1+2r)/(1+r) x' - (1+r) x + r^2/(1+r) x_before)/h. Second order.
/// Needs a history; the first step after a start, after a scheme without velocities, or after a step less than h/2.4
/// long (beyond 1 + sqrt 2 the scheme loses stability) is one of backward Euler, whose local error of second order does
/// not lower the order of the whole.
void bdf2_form(const State& before, double step_size, ImplicitForm& form);
/// Whether `before` holds what BDF2 needs for a step of this size.
bool has_bdf2_history(const State& before, double step_size);

/// TR-BDF2, gamma = 2 - sqrt 2 (Bank et al. 1985): the trapezoid rule over gamma h, then BDF2 from 0 and gamma h to h.
/// Second order, L-stable; both stages have m = 4/(gamma h)^2. The first needs bones and values at gamma h; bones are
/// read from `bones_at_gamma`, which must outlive the form, or, where that is null, on set_bone_weights' curve.
///
/// What touches counts at the end of each stage alone, twice in the first: the trapezoid rule would push once more by
/// half the force that has just stopped a body, which then leaves as fast as it came, or, where sheets are light
/// against the stiffness of their contacts, faster.
inline const double tr_bdf2_gamma = 2 - std::sqrt(2.0);
/// Stage 0 needs before.history.acceleration, which leaves out what touches.
void tr_bdf2_trapezoid_form(const State& before, double step_size, const std::vector<Points>* bones_at_gamma,
                            ImplicitForm& form);
/// Stage 1, from the state at gamma h.
void tr_bdf2_bdf2_form(const State& before, const std::vector<double>& x_gamma, const std::vector<double>& v_gamma,
                       double step_size, const std::vector<Points>* bones_at_gamma, ImplicitForm& form);

/// No momentum: equilibrium under the present loads, v' = 0.
void quasi_static_form(const State& before, ImplicitForm& form);

/// New velocities from new positions, 3 a vertex.
void update_velocity(const ImplicitForm& form, const std::vector<double>& x, std::vector<double>& v);
/// Accelerations that the solved stage implies, m (x' - target), 3 a vertex.
void implied_acceleration(const ImplicitForm& form, const std::vector<double>& x, std::vector<double>& acceleration);

/// Weights of bone positions (and of their velocities, per second) at `fraction` of a step of `step_size`.
void set_bone_weights(const State& before, double step_size, double fraction, ImplicitForm& form);
/// Likewise, of bones that are known at tr_bdf2_gamma of the step.
void set_bone_weights(const std::vector<Points>& at_gamma, double step_size, double fraction, ImplicitForm& form);
/// The bones that the form's three weights are for; `after`: at the end of the step.
std::array<const std::vector<Points>*, 3> bones_weighed(const ImplicitForm& form, const State& before,
                                                        const std::vector<Points>& after);

/// Where a bone is in the stage; `weighed`: as bones_weighed gives them.
void place_bone(const ImplicitForm& form, const std::array<const std::vector<Points>*, 3>& weighed, std::size_t body,
                Points& out);

} // namespace sinew::solver
