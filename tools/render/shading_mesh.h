// Vertices for shading: a vertex on a sharp edge is split, so that each side has a normal of its own. The
// split is made once from one pose and kept for all frames. Used by pictures and by the GLB writer.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::render {

struct ShadingMesh {
    std::vector<int> source;                 ///< the original vertex of each shading vertex
    std::vector<solver::Triangle> triangles; ///< of shading vertices
    solver::Points gather(const solver::Points& points) const;
};

/// Splits along edges whose triangles meet at more than `crease_degrees`. Unused vertices are dropped.
ShadingMesh split_creases(const solver::Points& points, const std::vector<solver::Triangle>& triangles,
                          double crease_degrees = 65);

} // namespace sinew::render
