// What the two ends of each muscle reach.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/guess.h"

namespace sinew::rig {

/// Distances of each muscle's vertices to all other parts: [muscle][part].
using AllDistances = std::vector<std::vector<std::vector<double>>>;

/// Whether it is told that both ends of a muscle hold on to one bone. Where several bones are one mesh, as those of a
/// hand or a rib cage, that is right.
enum class OneBone {
    is_right,
    is_odd_if_near, ///< told where an end hardly misses another bone
    is_odd,         ///< told where there is another bone
};

/// Fills `ends` of every muscle. Of each end every part has a score: the area that touches it, the nearer to the tip
/// the more, times the share that this is of all that touches it along the muscle. The two ends take the two bones with
/// the best sum of scores, different ones if there are two; an end that no bone touches takes the muscle with the best
/// score, else the nearest bone within five times the reach, else nothing. Ends that touch a tendon hold on to that,
/// too. An end that reaches nothing by its vertices takes the bone that touches its faces between them, and is painted
/// as far as the nearest vertices are. Notes: DG155 an end that reaches nothing, or over a gap, or the bone of the
/// other end. Throws std::invalid_argument for attachTo with a name that is none.
/// \param distances those to what faces alone touch are filled in
/// \param surfaces of all parts
void find_reach(Rig& rig, AllDistances& distances, const std::vector<Surface>& surfaces, OneBone one_bone);

} // namespace sinew::rig
