// Surfaces from files of any format that Sinew reads.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"

#include <string>
#include <vector>

namespace sinew::nodes {

/// What solver::read_surface reads, and .glb. Throws solver::Error as that does.
solver::SurfaceMesh read_mesh(const std::string& path);
/// The endings of those formats, lower case with the dot.
std::vector<std::string> mesh_endings();

} // namespace sinew::nodes
