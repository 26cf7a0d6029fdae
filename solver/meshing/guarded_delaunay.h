// Delaunay triangulation that keeps given triangles: the one place that knows CGAL's 3D triangulation.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"
#include "solver/meshing/meshing_control.h"

namespace sinew::solver {

struct GuardedDelaunay {
    std::vector<int> missing;  ///< triangles that the vertices' Delaunay triangulation does not have; then no tets
    Points vertices;           ///< the surface's, then the inner points that were taken
    std::vector<int> left_out; ///< inner points that were not taken, by number
    std::vector<Tet> tets;     ///< inside the surface, positively oriented, in a canonical order
};

/// Triangulates the surface's vertices, then adds inner points one by one, leaving out those that would
/// destroy a triangle of the surface. Inside is what lies an odd number of triangles away from infinity.
/// \param surface   no two vertices at one place
/// \param triangles closed, not crossing each other
/// Throws Stopped.
GuardedDelaunay guarded_delaunay(const Points& surface, const std::vector<Triangle>& triangles, const Points& inner,
                                 const MeshingControl& control);

} // namespace sinew::solver
