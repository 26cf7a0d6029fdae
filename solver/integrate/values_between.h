// Values that are keyed, at times within a step: schemes that look there must see them as they are there, or lose their
// order.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/step_inputs.h"

namespace sinew::solver {

/// Copies what drives a step but the bones, whose positions the state keeps, into `out`. Takes nothing from the heap
/// where `out` is of the same scene.
void copy_values(const StepInputs& in, StepInputs& out);

/// The values at `share` of the way from those of `before` to those of `after`, each on a line (second order); settings
/// and bones are those of `after`, or empty. Where volume conservation comes or goes, materials jump to `after`; so
/// does an attachment that is made or released.
void values_between(const Scene& scene, const StepInputs& before, const StepInputs& after, double share,
                    StepInputs& out);

/// The values that `known` gives at a time within the step that ends with `after`. Materials are those of `after` where
/// volume conservation comes or goes in between, and so is a part whose values may not be mixed with the end's: the
/// step's pattern is made for its end.
void values_within(const Scene& scene, const StepInputs& known, const StepInputs& after, StepInputs& out);

} // namespace sinew::solver
