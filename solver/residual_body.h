// Which body a step's residual belongs to.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace sinew::solver {

class Workspace;

/// The body whose residual the last advance of this workspace recorded (StepRecord::residual); -1 if no force was left
/// anywhere, or nothing was advanced.
int residual_body(Workspace& workspace);

} // namespace sinew::solver
