// What drives a step, held against the scene that it drives.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/step_inputs.h"

namespace sinew::solver {

/// Throws Error FE304 (a value is not finite or out of range), FE211 (a bone has other vertices) or FE202 (a vertex is
/// not finite), and std::logic_error where `in` does not name every body, attachment and part of the scene, in order.
void check_inputs(const Scene& scene, const StepInputs& in);

/// Puts where bones are at the end of the step into `bones`, one entry a body; those of other bodies stay.
void set_bones(const Scene& scene, const StepInputs& in, std::vector<Points>& bones);

} // namespace sinew::solver
