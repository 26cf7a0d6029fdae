// Points on a level set, evenly spaced, from which its surface mesher starts.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/distance_grid.h"

namespace sinew::solver {

struct IsoSeeds {
    Points points;
    std::vector<int> component; ///< of each point: its connected piece of the level set
    std::vector<double> areas;  ///< of each component, estimated
    Vec3 inside = Vec3::Zero(); ///< a sample with f < 0; meaningless without points
    double area() const;
};

/// Points where the grid's lines cross the level set, thinned so that those of one component are at least
/// `spacing` apart; closer on components that would get less than thirty. A mesher that starts from random
/// rays loses small components and thin shells; these points are on all of them. The same for every thread
/// count. Throws Stopped; reports no progress.
/// \param finer components that get a fraction 1 / 2^finer[c] of the spacing; empty = none
IsoSeeds make_iso_seeds(const DistanceGrid& grid, double spacing, const std::vector<int>& finer = {},
                        const MeshingControl& control = {});

} // namespace sinew::solver
