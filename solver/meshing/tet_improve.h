// Better tets inside a boundary that stays as it is.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"
#include "solver/meshing/meshing_control.h"

namespace sinew::solver {

/// Moves interior vertices, replaces edges and faces inside (Freitag & Ollivier-Gooch 1997: the tets around
/// an edge are triangulated anew without it, by dynamic programming), and splits the edges of what is still
/// bad by new vertices. A change is made only if the worst of the tets that it touches becomes better, so the
/// worst tet of the mesh never gets worse. Quality is the mean ratio (tet_quality.h).
/// Boundary triangles and their vertices do not change. Throws Stopped.
/// \param mesh   positively oriented; vertices are added at the end; coverage is left alone
/// \param passes over the whole mesh; 0 does nothing
void improve_tets(TetMesh& mesh, int passes, const MeshingControl& control = {});

} // namespace sinew::solver
