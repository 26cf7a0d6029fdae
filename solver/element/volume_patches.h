// Volume conservation for linear tets: 1/2 k (J - 1)^2 with J the mean over a patch of about seven tets (F-bar patches,
// de Souza Neto, Pires, Owen 2005). One condition a patch instead of one a tet leaves the mesh free to bend: conditions
// on every tet would lock it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

#include <vector>

namespace sinew::solver {

/// Disjoint, connected groups of a tissue's tets; every tet is in one.
struct VolumePatches {
    std::vector<int> patch_of_tet;
    std::vector<int> tet_start, tets;       ///< tets of each patch
    std::vector<int> member_start, vertex;  ///< vertices of each patch, in the mesh's numbers
    std::vector<int> corner_start, corners; ///< per member: corners of the patch's tets there, as 4 tet + corner
    std::size_t count() const { return tet_start.size() - 1; }
};

/// Grown from the lowest free tet over faces, taking the neighbour that adds the fewest vertices; leftovers of less
/// than half a patch join a neighbour. The same for the same mesh.
VolumePatches make_volume_patches(const TetMesh& mesh);

} // namespace sinew::solver
