// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/coordinates.h"

#include "solver/error.h"

namespace sinew::solver {

void check_coordinates(const Points& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (is_within_reach(points[i])) continue;
        if (!points[i].allFinite())
            throw Error("FE202", "vertex " + std::to_string(i) + " (counted from 0) is not finite");
        throw Error("FE224", "vertex " + std::to_string(i) + " lies more than 1e60 from the origin",
                    "Repair the coordinates, or the matrix that moves them.");
    }
}

} // namespace sinew::solver
