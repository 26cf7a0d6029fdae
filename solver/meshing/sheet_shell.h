// Sheets as thin solids: a surface that encloses nothing, made as thick as a sheet is, so that tets know how much of
// them it fills.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

/// Whether a surface bounds no solid: it is flat, or what it would take to close it has more than a tenth of its area
/// (the rule of Solid). False where it has no triangle with an area.
bool is_sheet(const Points& points, const std::vector<Triangle>& triangles);

struct SheetShell {
    Points points; ///< twice as many: of vertex v above the surface at v, below it at v + count
    std::vector<Triangle> triangles;
};

/// The closed surface half of `thickness` above and below a surface, with walls along its borders; corners are mitred,
/// so that the planes of flat parts are `thickness` apart. Its volume is area x thickness where the surface bends
/// little within that length. Closed surfaces become two, one in the other. Throws Error FE223 where the surface has
/// one side only (as a twisted ring) or no area; FE298 where `thickness` is no positive number, or more than half of
/// the surface's longest side.
SheetShell make_sheet_shell(const Points& points, const std::vector<Triangle>& triangles, double thickness);

} // namespace sinew::solver
