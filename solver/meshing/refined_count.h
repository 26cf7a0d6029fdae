// How many cells a refined lattice has at least, counted without making them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/lattice_cells.h"
#include "solver/meshing/paint.h"

namespace sinew::solver {

/// What is refined: `corners` of the triangles in the coarse lattice's coordinates (lattice_corners).
struct RefinedCount {
    const Solid& solid;
    const BccGrid& grid;
    const CoarseCells& coarse;
    const Paint& paint;
    const std::vector<std::array<Vec3, 3>>& corners;
    bool is_surface_only = false;

    /// Cells of all levels that the paint asks for by itself: at the surface, and inside as far as few questions
    /// tell; those that only keep the lattice conforming are not among them. Stops soon once there are more than
    /// `most`, and gives 0 where there cannot be so many. Throws Stopped.
    std::int64_t at_least(std::int64_t most, const MeshingControl& control) const;
};

} // namespace sinew::solver
