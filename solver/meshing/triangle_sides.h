// The winding numbers just below and above the triangles of a surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/solid.h"

#include <cstddef>
#include <vector>

namespace sinew::solver {

struct FoundSides {
    std::vector<Solid::Sides> sides; ///< of the triangles
    std::size_t asked = 0;           ///< places at which the winding number was asked
};

struct SidesOptions {
    double longest_side = 0; ///< of the surface's bounding box
    /// The triangles' edges cancel, so winding numbers are whole and change at triangles alone. Then triangles that
    /// hang together with no other near have the same numbers, and these are asked once for all of them; the result
    /// is that of asking for each, which costs as many triangles times as many where they are long.
    bool is_closed = false;
};

/// Looks just below and above each triangle, at places that are no farther apart than a twentieth of the surface or so.
FoundSides find_sides(const Points& points, const std::vector<Triangle>& triangles, const SurfaceTree& tree,
                      const SidesOptions& options, const MeshingPhase& phase);

} // namespace sinew::solver
