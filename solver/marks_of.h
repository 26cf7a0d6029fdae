// What the forces of a scene show of themselves, for viewers (term/marks.h).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/step.h"
#include "solver/term/marks.h"

namespace sinew::solver {

class Term;
struct TermType;

/// Marks of `state` under the values of its time. Terms are asked once a stage that ends where the state is has begun,
/// without an evaluation before; they give a few hundred marks a part at most. Only parts have marks: without any it is
/// empty at no cost. Errors as `advance`.
Marks marks_of(Workspace& workspace, const State& state, const StepInputs& inputs);

/// The term of a type as the last marks_of left it: its stage has begun and ends at that state. Null: the scene does
/// not use it. Valid until the workspace is used for anything else.
const Term* term_shown(Workspace& workspace, const TermType& type);

} // namespace sinew::solver
