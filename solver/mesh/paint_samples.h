// Painted triangles as points that are dense enough for the tets they pass through.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/embedding.h"

#include <vector>

namespace sinew::solver {

/// A surface whose paint is linear on each triangle. References must outlive it.
struct PaintedSurface {
    const Points& points;
    const std::vector<Triangle>& triangles;
    const Embedding& embedding;          ///< of the points, in the tet mesh
    const TetLocator* locator = nullptr; ///< of the tet mesh, where there is one already
};

/// The surface's vertices, then further points on painted triangles.
struct PaintSamples {
    Embedding embedding;           ///< of all of them
    std::vector<double> areas;     ///< what each stands for [m^2]; together the surface's area
    std::vector<Triangle> corners; ///< of the triangle of each further point
    Points shares;                 ///< of the corners in each further point; sum to 1
    std::size_t vertices() const { return areas.size() - corners.size(); }

    /// One value a vertex -> one value a sample.
    std::vector<double> values(const std::vector<double>& at_vertices) const;
    /// Further points are painted.
    std::vector<char> painted(const std::vector<char>& at_vertices) const;
};

/// In three dimensions a value held at a point has an influence that shrinks with the tets about it; held on an area
/// it keeps it. So a triangle with three painted corners is halved across its longest edge until no edge is longer
/// than half the mean edge of the tets at its ends; each part gives a third of its area to each of its corners.
/// Triangles smaller than that add no point. Corners far outside of all tets (beyond twice their host's width) ask
/// for no halving. Throws Error FE204 (sizes), FE203 (indices), FE201 (no tets).
PaintSamples sample_paint(const TetMesh& mesh, const PaintedSurface& surface, const std::vector<char>& painted);

} // namespace sinew::solver
