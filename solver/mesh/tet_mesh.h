// Tetrahedral meshes: the lattice or a user's mesh, with the share of each tet that is filled with solid.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_moments.h"
#include "solver/types.h"

#include <array>
#include <vector>

namespace sinew::solver {

/// What lies inside the solid of the tets that its surface cuts: integrals over the part inside of the homogeneous
/// monomials of one degree in the barycentric coordinates, per volume of the tet (tet_moments.h).
struct CutTets {
    int degree = 1;              ///< 1 or 4
    std::vector<int> tets;       ///< increasing
    std::vector<double> moments; ///< moment_count(degree) for each
    const double* of(std::size_t place) const { return moments.data() + place * moment_count(degree); }
    bool operator==(const CutTets&) const = default;
};

struct TetMesh {
    Points vertices;
    std::vector<Tet> tets;        ///< positively oriented: det(x1-x0, x2-x0, x3-x0) > 0
    std::vector<double> coverage; ///< per tet in (0, 1]: share of its volume inside the solid; 1 if not told
    /// Tets with a coverage below 1 that are not named here are solid all over, but that much thinner.
    CutTets cut = {};
};

double tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// Triangles that belong to one tet only, outward oriented.
std::vector<Triangle> boundary_triangles(const std::vector<Tet>& tets);
/// Throws Error: FE201 empty, FE202 not finite, FE203 index, FE215 zero volume, FE221 repeated tets, FE224 beyond
/// largest_coordinate. Flips negatively oriented tets.
void check_and_orient(TetMesh& mesh);

/// Every edge of the mesh once, as (lower, higher) vertex, sorted.
std::vector<std::array<int, 2>> edges_of(const std::vector<Tet>& tets);

} // namespace sinew::solver
