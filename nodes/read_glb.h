// Surfaces from binary glTF 2.0 (Khronos specification). It lies here and not among the solver's readers because the
// description is JSON.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"

#include <string>
#include <string_view>

namespace sinew::nodes {

/// All triangles of the default scene in one mesh, each mesh where its node stands at rest (skinned ones where they are
/// bound), in the file's numbers. Corners at exactly the same place become one vertex, since files split vertices at
/// seams of colour and shading; triangles that lose a corner by that are left out. Throws Error IO403 for what is
/// wrong, IO404 for what a file may need and this does not read (compression, sparse accessors, other files), FE232
/// beyond 20 million triangles, FE2xx for an unusable mesh. `file` is the name that messages begin with.
solver::SurfaceMesh read_glb(std::string_view bytes, const std::string& file);

} // namespace sinew::nodes
