// The coarse lattice around a solid: which of its tets the surface touches, and which lie inside.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/bcc_grid.h"
#include "solver/meshing/solid.h"
#include "solver/meshing/tet_share.h"

#include <span>
#include <vector>

namespace sinew::solver {

enum class CellState : char {
    outside,
    inside,  ///< wholly
    mixed,   ///< of a surface with large holes: no triangle near, but the winding number passes one half
    touched, ///< by triangles
};

/// Lattice tets in increasing order, with the triangles that touch each.
struct CoarseCells {
    std::vector<std::int64_t> tets;
    std::vector<CellState> states;
    std::vector<std::size_t> first{0}; ///< of each tet's triangles, and the end
    std::vector<int> triangles;
    std::span<const int> touching(std::size_t i) const {
        return {triangles.data() + first[i], first[i + 1] - first[i]};
    }
};

/// Corners of all triangles in the lattice's coordinates.
std::vector<std::array<Vec3, 3>> lattice_corners(const Solid& solid, const BccGrid& grid);

/// A triangle, given in the lattice's coordinates, as seen from a tet.
BarycentricTriangle seen_from(const BccGrid& grid, std::int64_t tet, const std::array<Vec3, 3>& lattice_triangle);

std::array<Vec3, 4> corner_positions(const BccGrid& grid, std::int64_t tet);

/// State of a tet that no triangle touches.
CellState untouched_state(const Solid& solid, const std::array<Vec3, 4>& corners);

/// All tets that touch the surface or lie inside; only the former if `is_surface_only`. Throws Stopped.
CoarseCells find_coarse_cells(const Solid& solid, const BccGrid& grid, bool is_surface_only,
                              const MeshingControl& control);

} // namespace sinew::solver
