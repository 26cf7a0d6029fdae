// Frame chains of an edited graph: what an edit leaves alone need not be hashed again.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/program.h"

namespace sinew::engine {

/// The last time up to which every input of the two graphs holds the same, whatever is sampled: infinite if they are
/// alike, minus infinite if more differs than later keys of curves.
double same_until(const Graph& a, const Graph& b);

/// Gives `to` the frames of the chains of `from`, the program of another snapshot, that an edit cannot have moved:
/// those whose frames end no later than the first difference. Both must have the files of the cone of `node` (of `to`).
/// A host that sends values frame by frame would otherwise hash all earlier frames again at each.
void carry_chains(Program& from, Program& to, int node);

} // namespace sinew::engine
