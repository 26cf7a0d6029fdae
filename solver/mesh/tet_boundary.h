// Bookkeeping on tet meshes that the geometry room shares: the border with its tets, removal of unused vertices.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

namespace sinew::solver {

/// The faces that belong to one tet only, outward oriented, in order of their tets.
struct TetBoundary {
    std::vector<Triangle> triangles;
    std::vector<int> tet; ///< which tet each triangle belongs to
};
TetBoundary tet_boundary(const std::vector<Tet>& tets);

/// Removes vertices that no tet uses and renumbers, keeping the order. Indices must be in range.
/// \return how many vertices went away
int drop_unused_vertices(TetMesh& mesh);

} // namespace sinew::solver
