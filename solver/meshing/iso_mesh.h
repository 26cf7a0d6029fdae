// zIsoMesh: a level set of a surface's distance as a triangle mesh without small angles.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/meshing_control.h"

namespace sinew::solver {

struct IsoMeshOptions {
    double iso_value = 0;     ///< distance from the surface, in the mesh's units; > 0 outside, < 0 inside
    double triangle_size = 0; ///< mean edge of the triangles, in the mesh's units;
                              ///< 0 = default_triangle_size
    int resolution = 128;     ///< grid cells along the longest side, 16 to 1024
    bool is_manifold = true;  ///< closed 2-manifold; otherwise angles and size alone are refined for
    double most_seconds = 0;  ///< wall clock; 0 = no limit
};

struct IsoMesh {
    Points points;
    std::vector<Triangle> triangles; ///< facing outwards
    std::size_t components = 0;      ///< of the level set on the grid
    std::size_t lost = 0;            ///< components that are too small for any triangle
    std::size_t buried = 0;          ///< closed parts of the input in others that bound no hollow there
};

/// A fortieth of the diagonal of the box around the triangles. Throws Error FE201 to FE203 (also for surfaces
/// larger than 1e60 or smaller than 1e-60 units).
double default_triangle_size(const Points& points, const std::vector<Triangle>& triangles);

/// Any triangles will do: open, overlapping, in any order and direction; vertices at the same place count as
/// one. Around a closed surface the level set is that of the signed distance (inside: winding number above
/// one half in size); parts that overlap are one. An open one has no inside: iso_value must be above 0, and
/// only what can be reached from outside is meshed, so holes smaller than 2 iso_value are closed. All angles
/// are at least 30 degrees (Boissonnat & Oudot 2005, refinement by CGAL); surface to level set about 0.1
/// triangle size, level set to true distance about a grid cell's curvature error. The same bits on every run
/// and for every number of threads; a time limit ends in an error, never in another mesh.
/// It is made near the origin and at a size near 1, wherever the surface is; of triangles that lie on each
/// other face to face neither counts for an iso_value <= 0.
/// Throws Stopped; Error FE201 to FE203 (input), FE222 (options), FE224 (larger than 1e60 or smaller than 1e-60 units,
/// or so far away that numbers there are more than 1e-5 triangle sizes apart), FE223 (closed, but encloses
/// nothing), FE230 (open and iso_value <= 0), FE231 (nothing there, or sheets too thin to follow), FE232 (too many
/// triangles or samples), FE233 (time), FE234 (not manifold after all, or parts that meet in an edge, so that
/// refinement has no end).
IsoMesh make_iso_mesh(const Points& points, const std::vector<Triangle>& triangles, const IsoMeshOptions& options,
                      const MeshingControl& control = {});

} // namespace sinew::solver
