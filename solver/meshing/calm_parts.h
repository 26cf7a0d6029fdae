// Parts of a closed surface that nothing else comes near to: below each of them, and above, the winding number is one.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/meshing_control.h"
#include "solver/types.h"

#include <array>
#include <functional>
#include <vector>

namespace sinew::solver {

/// The triangle across each edge that has just one other, which runs along it the other way; -1 for others.
/// Edge k lies opposite corner k.
std::vector<std::array<int, 3>> find_neighbours(const std::vector<Triangle>& triangles);

/// What of the space about a triangle counts: places beside it, all as far from its plane.
struct Neighbourhood {
    Points places;   ///< none: the triangle has no area
    double step = 0; ///< from the plane
};

/// A triangle is calm where no other one comes between its places on either side of it: in the prism that holds all of
/// them. Calm triangles belong together that share an edge with no third one, where none touches the way from the
/// middle of one to the middle of the edge to the middle of the other, and which are not folded upon each other. The
/// winding number is then the same at all places above the triangles of a part, and at all below. Where rounding could
/// let a triangle be near that is not, or the other way round, it counts as near.
/// \return of each triangle the first one of its part; -1 for those that are not calm. Throws Stopped.
std::vector<int> calm_parts(const Points& points, const std::vector<Triangle>& triangles,
                            const std::function<Neighbourhood(std::size_t)>& neighbourhood, const MeshingPhase& phase);

} // namespace sinew::solver
