// A state's bytes, handed on as they lie in memory, for whom need not hold them all at once.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/state.h"

#include <cstddef>
#include <functional>
#include <span>

namespace sinew::solver {

/// Takes bytes, one run after the other.
using ByteSink = std::function<void(std::span<const std::byte>)>;
/// The bytes of save: all that the next step reads, the same state in the same runs.
void write(const State& state, const ByteSink& to);

} // namespace sinew::solver
