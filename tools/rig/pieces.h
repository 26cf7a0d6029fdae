// The pieces that a surface falls into, where its file is one.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <cstddef>
#include <vector>

namespace sinew::rig {

/// What triangles join, vertices at one place counting as one.
struct Pieces {
    std::size_t count = 0;
    std::vector<int> of_vertex; ///< from 0 on, in the order of their first triangles; -1: of no triangle
};
Pieces pieces_of(const solver::Points& points, const std::vector<solver::Triangle>& triangles);

} // namespace sinew::rig
