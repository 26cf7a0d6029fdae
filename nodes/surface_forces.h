// What a tissue's material layers ask for on its surface: pressure and surface tension, as forces that the body brings
// along.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/painted_volume.h"

#include <vector>

namespace sinew::nodes {

/// Each adds a force for the layers of a tissue, from bottom to top, whose maps fit its mesh, if some layer has a value
/// other than 0, and nothing otherwise. A layer that has a mesh acts at the vertices in it or on it, times their
/// weights. Pressure warns (FE245) where the mesh, the tissue's, is open or looks inwards.
void add_pressure(const engine::Reads& in, const Mesh& mesh, const Layers& layers, double envelope,
                  std::vector<Force>& forces);
void add_surface_tension(const engine::Reads& in, const Mesh& mesh, const Layers& layers, double envelope,
                         std::vector<Force>& forces);

} // namespace sinew::nodes
