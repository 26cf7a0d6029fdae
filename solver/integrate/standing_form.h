// A stage that is no step: what acts on a state as it is.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/integrate/implicit_form.h"

namespace sinew::solver {

/// No inertia; ends where `before` is, with the velocities that it has there. The gradient of the stage is the force.
void standing_form(const State& before, ImplicitForm& form);

} // namespace sinew::solver
