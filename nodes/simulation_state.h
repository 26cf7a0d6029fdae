// Bytes of zSolver's state: the scene's key, then the solver's state.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"

#include <cstddef>
#include <span>
#include <vector>

namespace sinew::nodes {

std::vector<std::byte> save(const SimulationState& state);
/// Throws engine::Failure IO403 if the bytes are not a state of this version.
SimulationState load_simulation(std::span<const std::byte> bytes);

} // namespace sinew::nodes
