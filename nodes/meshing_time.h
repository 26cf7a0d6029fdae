// The time limit that meshing nodes share.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/attribute.h"

namespace sinew::nodes {

inline const engine::Input<double> max_time{
    .name = "maxTime",
    .def = 120,
    .unit = "s",
    .limits = {.min = 0, .max = 1e9},
    .doc = "Gives up with FE233 after so many seconds; 0 waits for ever. It never changes the result.",
    .keyable = false,
};

} // namespace sinew::nodes
