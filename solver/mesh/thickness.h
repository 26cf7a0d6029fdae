// How thick a solid is below its surface: along the inward normal to where that leaves the solid again (the shape
// diameter of Shapira, Shamir and Cohen-Or 2008, by one ray instead of a cone); and how wide what lies between two
// parts of it: the same outwards.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

struct Thickness {
    int triangle = 0;
    double area = 0;
    int opposite = -1;   ///< triangle that the ray meets; -1 if none
    double distance = 0; ///< from the triangle's middle; infinite where the ray meets nothing, as at holes
};

/// At `most` triangles spread evenly over the list, or at all if there are fewer. A surface that encloses a negative
/// volume is taken as turned inside out. Triangles without area are left out. Throws Error FE203.
std::vector<Thickness> thickness(const Points& points, const std::vector<Triangle>& triangles, std::size_t most);

/// How far it is outwards to another part of the solid that lies opposite: the shortest of seven rays within 30 degrees
/// of the outward normal to where they enter the solid again; infinite where none does.
std::vector<Thickness> gaps(const Points& points, const std::vector<Triangle>& triangles, std::size_t most);

} // namespace sinew::solver
