// How meshes, tets and frames are kept on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/registry.h"

namespace sinew::nodes {

/// Codecs of meshes, tets and what a solver gives of a frame, but for its tets: every number with its bits.
void add_codecs(engine::Registry& registry);

} // namespace sinew::nodes
