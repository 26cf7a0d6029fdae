// What the material layers of a tissue or cloth ask for on its surface: pressure and surface tension, as forces that
// the body brings along.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/painted_volume.h"

#include <vector>

namespace sinew::nodes {

/// Where layer k counts: a number for each vertex of the mesh, one for all, or none for 1 everywhere. The first layer
/// covers all, so its own weights and mesh say nothing.
engine::NumberList painted_layer(const Mesh& mesh, const Layers& layers, std::size_t k);

/// Each adds a force for the layers of a body, from bottom to top, whose maps fit its mesh, if some layer has a value
/// other than 0, and nothing otherwise. A layer that has a mesh acts at the vertices in it or on it, times their
/// weights. Pressure warns (FE245) where the body's mesh is open or looks inwards, unless `closed` is false: of a cloth
/// either may be meant, but not faces that look to both sides (FE315).
void add_pressure(const engine::Reads& in, const Mesh& mesh, const Layers& layers, double envelope,
                  std::vector<Force>& forces, bool closed = true);
void add_surface_tension(const engine::Reads& in, const Mesh& mesh, const Layers& layers, double envelope,
                         std::vector<Force>& forces);

} // namespace sinew::nodes
