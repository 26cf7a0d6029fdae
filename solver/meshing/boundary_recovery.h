// Triangles of a surface that a Delaunay triangulation of its vertices does not have, put into it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/meshing_control.h"
#include "solver/meshing/tet_complex.h"

namespace sinew::solver {

/// Changes tets until the edges and then the faces of the triangles are theirs: an edge or face that crosses
/// what is wanted is replaced by flips (2 to 3, or the tets around an edge triangulated anew), each only if
/// fewer cross afterwards. Edges and faces that are there already stay. All decisions by exact predicates.
/// \param complex   fills a convex region that holds the triangles in its inside
/// \param triangles vertices of the complex; they must not cross each other
/// \return the triangles that could not be had, by number. Throws Stopped.
std::vector<int> recover_boundary(TetComplex& complex, const std::vector<Triangle>& triangles,
                                  const MeshingControl& control);

} // namespace sinew::solver
