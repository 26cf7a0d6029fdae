// Points for the places that the guarded Delaunay triangulation had to leave empty.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"
#include "solver/meshing/inner_points.h"

namespace sinew::solver {

/// A point that the guarded triangulation leaves out does no harm as long as others are near. Where all the
/// surface's vertices lie on one sphere, though, none is taken. Points in tets that are more than three times
/// as long as wanted are put in here: the tets whose balls hold the point and that can be reached from its
/// own without crossing the boundary make room, as many as see it. The boundary stays as it is; without such
/// points the mesh keeps its bits. New vertices come last. Throws Stopped.
/// \param mesh all tets positively oriented or flat
void add_starved_points(TetMesh& mesh, const InnerPoints& points, const MeshingControl& control);

} // namespace sinew::solver
