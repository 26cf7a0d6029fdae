// Bytes of zSolver's state: the scene's key, then the solver's state.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"
#include "solver/state_bytes.h"

#include <cstddef>
#include <span>
#include <vector>

namespace sinew::nodes {

/// The bytes of save, run by run.
void write(const SimulationState& state, const solver::ByteSink& to);
std::vector<std::byte> save(const SimulationState& state);
/// Throws engine::Failure IO403 if the bytes are not a state of this version.
SimulationState load_simulation(std::span<const std::byte> bytes);

} // namespace sinew::nodes
