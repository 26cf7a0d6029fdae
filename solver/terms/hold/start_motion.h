// What a hold remembers of the start frame: the motion that it counts from, or the bone that it follows as it was then.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/hold/hold.h"

#include <span>

namespace sinew::solver {

/// The body that a part of type hold_type holds; -1 if it or the bone that it follows takes no part.
int held_body(const Scene& scene, const Part& part);

/// Fills the memory at the start frame. `surfaces`: of all bodies then [m].
void remember_start(const Scene& scene, const StepInputs& inputs, const std::vector<Points>& surfaces,
                    TermMemory& memory);
/// Of a part that follows a bone: puts the bone's motion since the start frame into the values. Throws Error FE250
/// (body set) where the bone has changed its shape.
void follow_bone(const Scene& scene, std::size_t part, const TermMemory& memory, const std::vector<Points>& bones,
                 std::span<double> values);
/// Where a part with these values has moved to since the start frame; exactly nowhere where nothing has changed.
RigidMotion moved_since_start(const Scene& scene, std::size_t part, const TermMemory& memory,
                              std::span<const double> values);

} // namespace sinew::solver
