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

/// `before` as a state of a scene that is alike but for parts at the end of its list: it has the first `same` of those
/// that `before` belongs to, and its own after them. What comes in is started where things are (TermType::begin); what
/// went is forgotten. `inputs`: of the first step that follows.
State with_other_parts(const Scene& scene, const State& before, std::size_t same, const StepInputs& inputs);

} // namespace sinew::solver
