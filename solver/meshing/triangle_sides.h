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
    /// hang together with no other near have the same numbers, and between others it is counted what lies; so that
    /// the numbers are asked once for all that hang together. The result is that of asking for each, which costs as
    /// many triangles times as many where they are long.
    bool is_closed = false;
    bool is_each_asked = false; ///< for tests: nothing is spared where the surface is closed
};

/// Looks just below and above each triangle, at places that are no farther apart than a twentieth of the surface or so.
/// Of a closed surface it looks nearer where they do not agree, as beside a sharp fold: what another triangle goes
/// through disagrees from near, too.
FoundSides find_sides(const Points& points, const std::vector<Triangle>& triangles, const SurfaceTree& tree,
                      const SidesOptions& options, const MeshingPhase& phase);

} // namespace sinew::solver
