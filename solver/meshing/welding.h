// What every preparation of a surface begins with: vertices at one place made one, parts turned alike.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

struct Welded {
    std::vector<int> place;          ///< first vertex at the same place, for each
    std::vector<Triangle> triangles; ///< of such vertices, in order; without those that have two corners in one
                                     ///< place, and one of those with the same corners in the same order
};
Welded weld(const Points& points, const std::vector<Triangle>& triangles);

/// Edges at which a part cannot be turned alike: going round it one comes back on the other side.
struct OneSided {
    std::size_t parts = 0;
    std::array<int, 2> first{-1, -1}; ///< an edge of the first such part
};

/// Turns triangles so that the two triangles of an edge with two agree. A part is what such edges join; parts
/// that agree already stay as they are, those in which triangles were turned face outwards afterwards (the volume
/// about their middle is positive), and one-sided parts stay as they are.
OneSided turn_alike(const Points& points, std::vector<Triangle>& triangles);

} // namespace sinew::solver
