// How linear systems are solved, and what of that a simulation's state keeps.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace sinew::solver {

/// `plain` is the yardstick that the others are measured against: CHOLMOD as it comes, on all bodies at once, in every
/// Newton iteration.
enum class LinearMethod { automatic, direct, iterative, plain };

/// What Auto remembers from step to step. Part of the simulation's state: the next step reads it.
struct LinearMemory {
    int factor_steps_left = 0; ///< steps that take the kept factor at once, after multigrid did not pay
};

} // namespace sinew::solver
