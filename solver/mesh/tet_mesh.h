// Tetrahedral meshes: the lattice or a user's mesh, with the share of each tet that is filled with solid.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <array>
#include <vector>

namespace sinew::solver {

struct TetMesh {
    Points vertices;
    std::vector<Tet> tets;        ///< positively oriented: det(x1-x0, x2-x0, x3-x0) > 0
    std::vector<double> coverage; ///< per tet in (0, 1]: share of its volume inside the solid; 1 if not told
};

double tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// Triangles that belong to one tet only, outward oriented.
std::vector<Triangle> boundary_triangles(const std::vector<Tet>& tets);
/// Throws Error: FE201 empty, FE202 not finite, FE203 index, FE215 zero volume, FE221 repeated tets. Flips
/// negatively oriented tets.
void check_and_orient(TetMesh& mesh);

/// Every edge of the mesh once, as (lower, higher) vertex, sorted.
std::vector<std::array<int, 2>> edges_of(const std::vector<Tet>& tets);

} // namespace sinew::solver
