// What is told of a frame that has not gone well.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/simulation_state.h"
#include "nodes/solver_setup.h"
#include "solver/scene.h"

namespace sinew::nodes {

/// Newton iterations that a step of cloth takes where it touches or folds: from so many, up to so many.
inline constexpr int few_cloth_iterations = 20, most_cloth_iterations = 60;

/// Warns of a frame that has not converged (FE301): its residual, and what may be behind it, a bone that has jumped or
/// a limit too low for cloth. `before`: the state that it began with.
void warn_if_unconverged(const engine::Reads& in, const Setup& setup, const solver::State& before,
                         const SimulationState& s);

/// Of a step that failed: the bone that has jumped from the state `before` to where `after` takes it, and what to do
/// about that. Empty: none has.
std::string hint_of_jump(const engine::Reads& in, const Setup& setup, const solver::State& before,
                         const solver::StepInputs& after);

/// Warns of one that has converged with tets inside out (FE306): a shape can be in balance that way and is wrong all
/// the same.
void warn_if_inverted(const engine::Reads& in, const Setup& setup, const solver::Scene& scene,
                      const solver::State& state);

} // namespace sinew::nodes
