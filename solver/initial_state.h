// Where a simulation starts.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/state.h"
#include "solver/step_inputs.h"

#include <span>
#include <vector>

namespace sinew::solver {

/// How a body moves at the start frame; what is held stays.
struct InitialMotion {
    Vec3 velocity = Vec3::Zero();         ///< of the centre of mass [m/s]
    Vec3 angular_velocity = Vec3::Zero(); ///< about it [rad/s]
};

/// The state at the start frame: rest positions, and what terms keep from there. `inputs` are those of the start frame.
/// `motions`: one a body, or none for bodies at rest.
State initial_state(const Scene& scene, const StepInputs& inputs, std::span<const InitialMotion> motions = {});

} // namespace sinew::solver
