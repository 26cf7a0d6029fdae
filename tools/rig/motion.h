// A motion file as a new rig sees it: which bones move in it, how fast, and in which space.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/guess.h"

#include <map>
#include <string>

namespace sinew::rig {

struct Motion {
    std::string file;
    double fps = 24;                           ///< of the file
    double first = 1, last = 1;                ///< its frames
    std::map<std::string, std::string> tracks; ///< by bones' names: the track's
    /// Graph frames at `graph_fps` that it lasts.
    int frames(int graph_fps) const;
};

/// Tracks are matched with bones by name, whatever the case and '_'. Takes the way up from the file if it is told
/// there (`up_axis`) and the rig's was not given. Notes: DG159 for bones that have no track, and for a file in another
/// unit. Throws engine::Failure (IO4xx; DG159 if no bone has a track).
Motion read_motion(const engine::FileAccess& access, const std::string& file, Rig& rig, bool is_up_given);

} // namespace sinew::rig
