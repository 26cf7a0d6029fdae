// How linear systems are solved, and what of that a simulation's state keeps.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

namespace sinew::solver {

/// `plain` is the yardstick that the others are measured against: CHOLMOD as it comes, on all bodies at once, in every
/// Newton iteration.
enum class LinearMethod { automatic, direct, iterative, plain };

/// What a factor in single precision was made of, so that it can be made again, to the bit, where it is not at hand.
struct FactorSource {
    std::uint64_t pattern = 0; ///< the mark of the pattern that the blocks are those of
    std::vector<float> values; ///< 9 a block
    std::vector<char> without; ///< flags of rows that have no factor: their bodies rested
};

/// What Auto remembers from step to step. Part of the simulation's state: the next step reads it.
struct LinearMemory {
    int factor_steps_left = 0; ///< steps that take the kept factor at once, after multigrid did not pay
    /// Of the factor that the last frame ended with. Null: the next frame begins without one. States share it.
    std::shared_ptr<const FactorSource> factor;
    int late_iterations = 0;  ///< how many more a new one would have saved since it was made
    int fresh_iterations = 0; ///< that an overlay cost when it was new
};

} // namespace sinew::solver
