// The complete state of a simulation: all that the next step reads. Plain values; load(save(s)) equals s bit for bit.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/linear_method.h"
#include "solver/step_inputs.h"
#include "solver/term/measure.h"
#include "solver/term/memory.h"
#include "solver/types.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace sinew::solver {

/// What the last step did, for the report. Part of the state, so that a reused frame reports what it did when it ran.
struct StepRecord {
    double residual = 0; ///< force residual / forces at work
    bool converged = true;
    int newton_iterations = 0, substeps = 0;
    int halvings = 0;               ///< steps that failed and were taken again in two halves
    int linear_iterations = 0;      ///< of conjugate gradients; 0 where every solve was direct
    int factorizations = 0;         ///< of matrices, also those that were found indefinite
    double energy = 0;              ///< elastic + fibre + attachment [J]
    double min_j = 1;               ///< least det F over all tets
    int inverted = 0;               ///< tets with det F <= 0
    std::vector<Measured> measured; ///< of the terms, in their order
    double seconds_assembly = 0, seconds_factor = 0, seconds_solve = 0, seconds_other = 0; ///< not digested
};

/// What multi-step schemes know of the step before the last one. Kept by the schemes that read it, empty otherwise.
struct History {
    double step_size = 0;             ///< of the last step [s]; 0 = nothing is known
    std::vector<double> x, v;         ///< at the start of the last step
    std::vector<Points> bones;        ///< likewise, per body
    std::vector<double> acceleration; ///< at the end of the last step, 3 per vertex [m/s^2]; empty = not known
    std::optional<StepInputs> values; ///< that the last step ended with, as copy_values leaves them
    std::vector<char> frozen;         ///< flags of bodies that stood still in it, which is no past; empty: none did
};

struct State {
    std::vector<double> x, v; ///< 3 numbers per unknown vertex; order of the scene [m], [m/s]
    History history;
    std::vector<TermMemory> memories; ///< of the terms that keep something
    /// Per part whose values say where it is (TermType::mix): those at the end of the step; empty for others.
    std::vector<PartValues> parts;
    std::vector<Points> bones; ///< per body: bone vertex positions at the end of the step; empty for tissues
    long long steps = 0;       ///< since the start frame
    LinearMemory linear;
    StepRecord record;
};

std::vector<std::byte> save(const State& state);
/// Throws Error IO403 if the bytes are not a state of this version.
State load(std::span<const std::byte> bytes);

} // namespace sinew::solver
