// Frames that went wrong: coordinates that are no numbers, and parts that fly far away. They are named, not
// hidden.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/viewer/view_data.h"

namespace sinew::viewer {

/// Beyond this a coordinate cannot be drawn: squares of it leave single precision.
constexpr double most_drawable = 1e18;

/// Coordinates that cannot be drawn take the vertex's last good place. Frames with such, and frames that
/// reach much farther than most, are named in their `faults` and in the scene's notes.
void find_faults(ViewScene& scene);

} // namespace sinew::viewer
