// The tet lattice of zTet: body-centred cubic, 12 tets a cube, one lattice vertex at the centre of the
// surface's bounding box; tets that touch the solid are kept and know their coverage. Finer where painted.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_mesh.h"
#include "solver/meshing/meshing_control.h"
#include "solver/meshing/shells.h"

namespace sinew::solver {

struct LatticeOptions {
    double tet_size = 0;      ///< cube side; 0 = longest side of the bounding box / 3.5
    int max_resolution = 150; ///< refuse (FE210) a lattice with more of its finest cubes along the longest side
    /// Lower bound of a tet's coverage: a tet that the solid only grazes keeps this much mass and stiffness,
    /// so that vertices which hang on such tets alone do not fold. Costs about 1e-5 of the volume at the
    /// default size; a lattice that it makes more than a tenth too heavy is refused (FE210).
    double least_coverage = 1e-3;
    Fill fill = Fill::filled_cavities;
    /// surface_only: how thick the shell is that the surface stands for. 0: sheets (is_sheet) are a tenth of the tet
    /// size thick, and of other surfaces the tets that they pass through are as solid as the inside is.
    double thickness = 0;
    /// How often the tet size is to be halved at the surface: a number per vertex, one for all, or none. The
    /// numbers are linear on the triangles and then rounded up (paint.h).
    std::vector<double> refinement = {};
    double propagation = 0; ///< 0 to 1: share of the surface's refinement that the inside takes over
    int moments = 1;        ///< degree of TetMesh::cut: 1 for linear tets, 4 for quadratic ones
};

/// What is inside: where the winding number exceeds one half in size, so overlapping parts are one solid;
/// closed shells inside others as `fill` says (shells.h). Cracks and small holes are closed by triangles,
/// large holes by the surface on which the winding number is one half (solid.h). Which tets: those that a
/// triangle of the surface comes within 1e-9 cube sides of, or that are wholly inside (unless surface_only).
/// Around a closed surface, tets that hold less than 1e-9 of their volume (touched from outside along a face,
/// edge or corner) are left out. Coverage: for closed surfaces exact up to rounding, but for small tets where
/// parts cross (tet_share.h); for surfaces with large holes by subdivision, second order (tet_quadrature.h).
/// The moments of cut tets are as exact as their coverage, and know no least coverage.
/// Refinement: tets whose piece of the surface asks for it are cut into eight of the same shape, their
/// neighbours into two or four so that no vertex hangs (red_green.h): all dihedral angles lie in 60 to 90
/// degrees without refinement, and in 30 to 116.6 degrees between levels. Order: tets by coarse cube (z, then
/// y, then x), parts of a tet together; vertices by z, then y, then x; the same for any thread count. Throws
/// Error FE201 (empty), FE202 (not finite), FE203 (index), FE204 (count of refinement), FE222 (options),
/// FE210 (too fine, or too coarse to know its volume), FE223 (flat, closed around no volume, or one-sided),
/// FE220 (not watertight); Stopped.
TetMesh make_lattice(const Points& points, const std::vector<Triangle>& triangles, const LatticeOptions& options,
                     const MeshingControl& control = {});

} // namespace sinew::solver
