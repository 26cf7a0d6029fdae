// Painted maps as they run over a surface's triangles.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <array>
#include <vector>

namespace sinew::solver {

/// Whether a map has a number for each vertex of a surface or for each of its triangles.
enum class PaintedOn { vertices, faces };

/// The value of a map at the corners of every triangle; it is linear between them.
using CornerWeights = std::vector<std::array<double, 3>>;

/// A map over the triangles of a surface. `map`: a number for each, one for all, or none for 1 everywhere.
///
/// Painted faces are sharp. Painted vertices run to 0 over the triangles that have some corners at 0, but not around an
/// edge where the surface bends by more than 60 degrees: of the faces that such edges part at a vertex, those without a
/// triangle that is painted at all its corners stay empty if the others have one. So the painted rim of a box's top
/// means the top, and a single painted vertex the triangles about it.
/// Throws Error FE204 if the count does not fit.
CornerWeights corner_weights(const Points& points, const std::vector<Triangle>& triangles,
                             const std::vector<double>& map, PaintedOn on);

} // namespace sinew::solver
