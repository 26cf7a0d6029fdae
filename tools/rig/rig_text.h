// A guessed rig as a commented graph file.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/part_text.h"

#include <string>

namespace sinew::rig {

std::string rig_text(const Rig& rig, const TextOptions& options);

} // namespace sinew::rig
