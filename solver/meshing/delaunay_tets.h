// zDelaunayTetMesh: the inside of a closed surface as tets whose boundary is exactly that surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"
#include "solver/meshing/meshing_control.h"

namespace sinew::solver {

struct DelaunayTetOptions {
    /// 0: no vertices inside, tets as they come. Above: inside, the edges grow by 1.2 (1 - quality) of the
    /// distance from the surface, and tets are improved; 1: as fine inside as on the surface.
    double refinement_quality = 0.8;
    double most_seconds = 0; ///< wall clock; 0 = no limit
};

/// Delaunay triangulation of the surface's vertices, vertices on a graded body-centred lattice inside that
/// leave the surface's triangles alone, recovery of triangles that Delaunay does not have
/// (boundary_recovery.h; iso meshes never need it), lattice vertices where none was possible before
/// (starved_points.h), then improvement (tet_improve.h). Vertices of the result: those of the input in their
/// order, so that vertex i of the surface is vertex i of the tets, then new ones, all inside. Cavities (parts
/// facing inwards inside another) stay empty. No tet has a dihedral angle below 0.05 degrees. The same bits on
/// every run.
/// \param triangles  closed, manifold, no vertex twice at one place, every vertex used, none crossing another;
///                   facing outwards, or all inwards
/// Throws Stopped; Error FE201 to FE203 (input), FE222 (options), FE230 (open: the edges), FE236 (not
/// manifold, oriented or clean: the edges, vertices, triangles; parts that face the wrong way), FE237
/// (triangles that cross, that could not be recovered, or that leave flat tets), FE232 (too many tets), FE233 (time).
TetMesh make_delaunay_tets(const Points& points, const std::vector<Triangle>& triangles,
                           const DelaunayTetOptions& options, const MeshingControl& control = {});

} // namespace sinew::solver
