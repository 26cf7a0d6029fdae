// What attachments leave out and how far they reach, told at the start frame.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/solver_setup.h"
#include "solver/terms/attachment/anchors.h"

#include <vector>

namespace sinew::nodes {

/// Warns of painted area that finds no hold (FE241), and of what reaches farther than the painted part of its source is
/// large, or than three times its target (FE242): with the sizes of the two bodies where they are so unlike that one of
/// them may be modelled in another unit.
void warn_of_reach(const engine::Reads& in, const Setup& setup, const std::vector<solver::AttachmentStart>& starts);

} // namespace sinew::nodes
