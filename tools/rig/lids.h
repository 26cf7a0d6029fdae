// Lids over the wide holes of an open surface, so that a narrow wrap around both encloses what the surface was cut
// from.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <cstddef>
#include <vector>

namespace sinew::rig {

/// A patch that spans holes, as it stands in the graph beside the file's mesh.
struct Lids {
    solver::Points points; ///< on the holes' rims, to the digits that the graph has
    std::vector<solver::Triangle> triangles;
    std::size_t count = 0; ///< holes
    double widest = 0;     ///< across the widest of them: of the largest ball that would fall through
};

/// Over holes that a wrap at this distance would go through. None where there is no such hole; where lids would be over
/// a third as large as the surface, which then is rather a sheet with a border; and where the rims have more points
/// than a graph should hold.
Lids make_lids(const solver::Points& points, const std::vector<solver::Triangle>& triangles, double distance);

} // namespace sinew::rig
