// Painted triangles cut by the tets that they pass through: on each piece what tets say is linear.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/paint_samples.h"

#include <vector>

namespace sinew::solver {

/// Pieces of the triangles whose three corners are painted alike, each by its centroid, at which a linear function has
/// its mean. A painted vertex of none of these is a piece of its own. Between corners that are painted otherwise, paint
/// holds nothing.
struct PaintPieces {
    Embedding embedding;        ///< of the centroids
    std::vector<double> areas;  ///< of the pieces [m^2]; of a vertex, what it stands for
    std::vector<double> values; ///< what is painted
    std::size_t size() const { return areas.size(); }
};

/// The pieces of a triangle together are the triangle: one that lies in a side of two tets is cut by one of them, and
/// one that leaves the tets is taken at samples (sample_paint) instead. The same for any number of threads. Throws as
/// sample_paint does.
/// \param values, painted one per vertex of the surface
PaintPieces cut_paint(const TetMesh& mesh, const PaintedSurface& surface, const std::vector<double>& values,
                      const std::vector<char>& painted);

} // namespace sinew::solver
