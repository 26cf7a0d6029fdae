// The tet lattice of zTet: body-centred cubic, 12 tets a cube, one lattice vertex at the centre of the
// surface's bounding box; tets that touch the solid are kept and know their coverage.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_mesh.h"

namespace sinew::solver {

struct LatticeOptions {
    double tet_size = 0;      ///< cube side; 0 = longest side of the bounding box / 3.5
    int max_resolution = 150; ///< refuse (FE210) a lattice with more cubes than this along the longest side
    /// Lower bound of a tet's coverage: a tet that the solid only grazes keeps this much mass and stiffness,
    /// so that vertices which hang on such tets alone do not fold. Costs about 1e-5 of the volume at the
    /// default size.
    double least_coverage = 1e-3;
};

/// What is inside: where the winding number exceeds one half in size, so overlapping parts are one solid.
/// Cracks and small holes are closed by triangles, large holes by the surface on which the winding number is
/// one half (solid.h). Which tets: those that a triangle of the surface comes within 1e-9 cube sides of, or
/// that are wholly inside. Around a closed surface, tets that hold less than 1e-9 of their volume (touched
/// from outside along a face, edge or corner) are left out. Coverage: for closed surfaces exact up to
/// rounding, but for small tets where parts cross (tet_share.h); for surfaces with large holes by
/// subdivision, second order (tet_quadrature.h). Order: tets by cube (z, then y, then x), vertices by z, then
/// y, then x; the same for any thread count. Throws Error FE201 (empty), FE202 (not finite), FE203 (index),
/// FE206 (options), FE210 (too fine), FE211 (flat, or closed around no volume).
TetMesh make_lattice(const Points& points, const std::vector<Triangle>& triangles,
                     const LatticeOptions& options);

} // namespace sinew::solver
