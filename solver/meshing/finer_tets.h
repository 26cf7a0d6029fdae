// The tets of a body cut into smaller ones, for fields that vary within a tet: the simulation's own may be as large as
// the body is thick.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"
#include "solver/meshing/meshing_control.h"

#include <vector>

namespace sinew::solver {

struct FinerTets {
    TetMesh mesh;            ///< what holds something of the solid, with its share as coverage; without moments
    std::vector<int> parent; ///< which of the given tets each is a part of; every one of those has a part
};

/// Each tet cut into eight of an eighth of its volume, and again where that leaves no more than 4,000; not at all where
/// it would make more than 100,000. Of a tet that the surface cuts, the parts know what of them is inside
/// (tet_share.h). Where that is not what the tets know of themselves, as with surfaces that are open or that other tets
/// were made for, nothing is cut. Parts with next to nothing inside are left out. The same for any number of threads.
/// Throws Error as check_and_orient does; Stopped.
FinerTets finer_tets(const TetMesh& tets, const Points& surface, const std::vector<Triangle>& triangles,
                     const MeshingControl& control = {});

/// Means of vectors of the parts over the solid of each given tet.
Points means_over_parts(const FinerTets& finer, const Points& of_parts, std::size_t tet_count);

} // namespace sinew::solver
