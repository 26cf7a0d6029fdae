// Surfaces from files of any format that Sinew reads.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/file_access.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_mesh.h"

#include <string>
#include <vector>

namespace sinew::nodes {

/// What solver::parse_surface reads, and .glb. Throws solver::Error as that and FileAccess::read do.
solver::SurfaceMesh read_mesh(const engine::FileAccess& files, const std::string& path);
/// What solver::parse_tets reads, and TetGen's two files, where `path` names the .node file and `elements` the .ele
/// file.
solver::TetMesh read_tets(const engine::FileAccess& files, const std::string& path, const std::string& elements = {});
/// The endings of those formats, lower case with the dot.
std::vector<std::string> mesh_endings();

} // namespace sinew::nodes
