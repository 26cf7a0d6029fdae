// Points inside a closed surface, as dense as its triangles near it and sparser with depth.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/meshing_control.h"
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

struct InnerPoints {
    Points points;
    std::vector<double> edges; ///< of each: the length of edges that is wanted there
};

/// Centres and corners of an octree's leaves: a body-centred lattice wherever the leaves are alike. A leaf's
/// size fits edges of length e + growth * distance, with e the mean edge of the surface at the closest point.
/// Points closer to the surface than about half e are left out. In Morton order; the same for every thread
/// count. Throws Stopped; Error FE232 (more than `most` points).
/// \param triangles closed, facing outwards
InnerPoints inner_points(const Points& points, const std::vector<Triangle>& triangles, double growth, std::size_t most,
                         const MeshingControl& control);

} // namespace sinew::solver
