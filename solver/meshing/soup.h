// Polygon soups made ready for distances and for the question "what is inside".
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <string>
#include <vector>

namespace sinew::solver {

/// What is left of a soup when vertices at the same place are one, triangles with two corners in one place
/// are gone, and of triangles with the same corners in the same order one is left.
struct Soup {
    Points points; ///< only those that triangles use
    std::vector<Triangle> triangles;
    /// Every directed edge is used as often as its reverse, so winding numbers are whole numbers.
    bool is_closed = false;
    std::size_t open_edges = 0;            ///< edges whose uses do not cancel; 0 if closed
    std::array<int, 2> first_open{-1, -1}; ///< the first of them, by the vertices of the input
};

/// Triangles that face the wrong way are turned where that closes the surface (turn_alike in welding.h). Order
/// of vertices and triangles is kept. Throws Error FE201 (no triangle is left), FE202 (not finite), FE203 (index).
Soup make_soup(const Points& points, const std::vector<Triangle>& triangles);

/// Whether the soup that is made of them is closed: what zIsoMesh goes by.
bool is_closed_once_welded(const Points& points, const std::vector<Triangle>& triangles);

} // namespace sinew::solver
