// Closes the cracks and small holes of a surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

/// Triangles that close the surface, so that every directed edge is used as often as its reverse; none if it
/// is closed already. Loops of border edges are closed by joining, again and again, the two nearest corners
/// that have one corner between them: a crack is zipped up, a round hole gets a lid. Vertices at the same
/// place must be one.
std::vector<Triangle> close_holes(const Points& points, const std::vector<Triangle>& triangles);

} // namespace sinew::solver
