// What a muscle's surface tells of it: its two tips, how far along it a point is, how thick it is, where it gets thin.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <array>
#include <vector>

namespace sinew::rig {

/// Lengths are in the mesh's units.
struct MuscleShape {
    std::array<int, 2> tips{};       ///< vertices that are farthest from each other along the surface
    std::vector<double> along;       ///< of each vertex, from 0 at the first tip to 1 at the second
    std::vector<double> areas;       ///< of each vertex, a third of its triangles'
    double length = 0;               ///< between the tips, along the surface's edges
    double thickness = 0;            ///< of the belly: what 40 % of the surface is thicker than
    std::array<double, 2> tendons{}; ///< how much of the length at either tip is thin; 0 if nothing is
};

/// By shortest ways along edges (Dijkstra 1959): the farthest vertex from any, the farthest from that, and so on until
/// it gets no farther. Vertices of parts that are apart take what their nearest neighbour has. Thickness by one ray a
/// triangle (solver/mesh/thickness.h), in bins along the muscle; thin is below 0.4 of the thickest bin.
MuscleShape measure_muscle(const solver::Points& points, const std::vector<solver::Triangle>& triangles);

} // namespace sinew::rig
