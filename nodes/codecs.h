// How meshes and tets are kept on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/registry.h"

namespace sinew::nodes {

/// Codecs of Mesh and TetMeshValue: every number with its bits.
void add_codecs(engine::Registry& registry);

} // namespace sinew::nodes
