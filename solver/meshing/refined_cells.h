// The tets of the final lattice: coarse cells as they are, or refined where the paint asks for it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/lattice_cells.h"
#include "solver/meshing/paint.h"

#include <functional>
#include <memory>
#include <vector>

namespace sinew::solver {

/// A tet with its corners in the coordinates of the finest level's grid, and the share of it that is solid.
struct LatticePiece {
    std::array<BccGrid::Key, 4> corners;
    double share; ///< negative: not part of the lattice
    /// Integrals of the monomials of RefineOptions::degree over the solid part, as many as there are; null where the
    /// tet is solid as a whole.
    std::unique_ptr<double[]> moments;
};

struct RefinedCells {
    std::vector<LatticePiece> pieces;
    int levels = 0;         ///< how often the side was halved at the finest place
    std::int64_t cells = 0; ///< of all levels, those that are cut and those outside too: what the limit is on
};

struct RefineOptions {
    bool is_surface_only = false;
    std::int64_t most_tets = 0; ///< Error FE210 above
    int degree = 1;             ///< of the moments
    /// Takes shares for what they are where the winding number is 0 or 1 everywhere, and no moments: much quicker where
    /// triangles are so near to each other that what is between them is not known.
    bool is_estimate = false;
};

/// Refines and computes all shares. Order: coarse tets by number; inside one the tree of its parts, each cut
/// as RedGreen says. Throws Error FE210 (too many tets; before any is made, where the paint alone surely asks for too
/// many), Stopped.
RefinedCells refine_cells(const Solid& solid, const BccGrid& grid, const CoarseCells& coarse, const Paint& paint,
                          const RefineOptions& options, const MeshingControl& control);

} // namespace sinew::solver
