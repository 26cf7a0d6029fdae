// The connected pieces of a triangle mesh, and which of them enclose a volume.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <cstddef>
#include <vector>

namespace sinew::solver {

struct SurfacePieces {
    std::vector<int> of_point;    ///< -1 = in no triangle
    std::vector<int> first_point; ///< per piece: one of its points
    std::vector<char> is_closed;  ///< per piece: each edge has as many triangles on one side as on the other
    std::size_t count() const { return first_point.size(); }
};

SurfacePieces find_pieces(std::size_t points, const std::vector<Triangle>& triangles);
/// Points at exactly the same place count as one.
SurfacePieces find_pieces_by_place(const Points& points, std::vector<Triangle> triangles);

} // namespace sinew::solver
