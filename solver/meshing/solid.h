// A surface prepared for the question "what is inside": welded, oriented outwards, with its search tree.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/closest_point.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/meshing_control.h"
#include "solver/meshing/shells.h"

namespace sinew::solver {

/// Inside is where the winding number exceeds one half in size; so parts may overlap. Triangles that face the
/// wrong way are turned first (turn_alike in welding.h), then closed parts that are inside out, so these are as
/// solid as any (shells.h). Cracks and holes whose lids have less than a
/// tenth of the surface's area are closed first (holes.h); larger ones are closed by the surface on which the
/// winding number is one half.
struct Solid {
    /// The whole winding numbers just below and above a triangle: 1 and 0 on an ordinary one, 2 and 1 inside
    /// another part.
    struct Sides {
        signed char below = 0, above = 0; ///< both 0: not the same all over the triangle
        bool are_known() const { return below != above; }
        bool operator==(const Sides& o) const { return below == o.below && above == o.above; }
    };
    Points points;                   ///< as given
    std::vector<int> place;          ///< first vertex at the same place, for each; the triangles use only these
    std::vector<Triangle> triangles; ///< without those that have two corners in one place; lids at the end
    Box box;                         ///< of the triangles
    int border_edges = 0;            ///< before holes were closed
    bool is_closed = false;          ///< the triangles' edges cancel: winding numbers are whole numbers
    std::vector<Sides> sides;        ///< of the triangles; unknown near large holes
    SurfaceTree tree;

    double winding_number(const Vec3& p) const { return tree.winding_number(p); }
};

/// Throws Error FE201 (empty), FE202 (not finite), FE203 (index), FE223 (flat, closed around no volume, or one-sided),
/// FE220 (not watertight, where empty cavities ask for it); Stopped.
Solid make_solid(const Points& points, const std::vector<Triangle>& triangles, Fill fill = Fill::filled_cavities,
                 const MeshingControl& control = {});

} // namespace sinew::solver
