// Does the motion in a graph reach over the frames that are run, and at the speed that it was recorded at? Before its
// first and after its last key or sample it stands still, which is easily taken for a fault of the simulation.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <optional>
#include <string>
#include <vector>

namespace sinew::cli {

/// Warnings FE266, one an input, or one a motion file that several nodes read alike: of keyed vectors and matrices, and
/// of recorded tracks and channels, that begin a frame or more after `first` or end that much before `last`; of keyed
/// numbers only where the keys reach over the graph's own timing, because numbers are often switched on and left so.
/// Nothing is said of what never changes, of stepped keys, and of an end where two keys hold the value. Files that
/// cannot be read are left out: find_problems tells. FE334 where a file says that it was recorded at another rate than
/// the graph's and the node does not say how fast it follows.
/// \param nodes to look at
/// \param first the first frame that is simulated or shown, pre-roll included
/// \param last the last one
std::vector<engine::Diagnostic> find_motion_doubts(const engine::Graph& graph, const std::vector<std::string>& nodes,
                                                   int first, int last);

/// Those of some frames that lie outside of the graph's timing.
std::vector<int> frames_outside(const engine::Timing& timing, const std::vector<int>& frames);

/// Warning FE333, if some of the `frames` lie outside of the graph's timing. A graph of a single frame says nothing of
/// how long it is. The hint names the `command` that shows them.
std::optional<engine::Diagnostic> find_timing_doubt(const engine::Timing& timing, const std::vector<int>& frames,
                                                    const std::string& command);

} // namespace sinew::cli
