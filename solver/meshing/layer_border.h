// Tets fitted to the borders of layers that closed meshes bound: split along the border, so that each side has tets and
// strains of its own. A tet that both sides share has one strain for both, and a mean of moduli 1 to 1000 apart then
// makes the soft side stiff.
//
// After isosurface stuffing (Labelle & Shewchuk 2007): a vertex near the border moves onto it, tets that it still
// passes through are split where it cuts their edges. Other than there, one smooth part of the border is taken after
// another (border_patches.h), each as if it went on beyond its edge, so that creases and corners come out sharp; and
// tets are halved edge by edge (edge_splits.h), so that any tets will do, not lattices only.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"
#include "solver/meshing/meshing_control.h"
#include "solver/meshing/solid.h"

#include <memory>
#include <vector>

namespace sinew::solver {

struct FittedTets {
    TetMesh mesh;
    std::vector<int> parent; ///< tet of the given mesh that each is a part of
    /// [place][tet]: about what share of it lies between its flat sides and the curved border that they stand for; 0
    /// where the border is flat, elsewhere, or bends within the tet's width (where this would be more than one half).
    std::vector<std::vector<double>> slack;
    std::shared_ptr<const Solid> tissue; ///< what tissue_solid makes of the surface; null where it was not asked
};

/// Splits tets along the borders of `places` where these run within the solid. Exact for flat sides, second order for
/// curved ones. Vertices of the given mesh keep their order and numbers but those that no tet keeps; vertices at its
/// boundary move only where the surface cuts the tets, and only if all that is solid stays covered. Coverage and
/// moments of what is changed are found anew from the surface; tets with less than 1e-9 of their volume inside are left
/// out. The mesh stays as it is where it knows what the surface cuts off (TetMesh::cut) and that is not what `surface`
/// says (tets made for another mesh, with cavities or large holes); parts of a layer that end between the vertices of a
/// tet, so that no edge meets them, split nothing. The same for any number of threads.
/// \param surface, triangles the tissue's own mesh, in the same place
FittedTets fit_to_borders(const TetMesh& tets, const std::vector<const Solid*>& places, const Points& surface,
                          const std::vector<Triangle>& triangles, const MeshingControl& control = {});

/// layer_shares of a place, but none or all of a tet where no more than its slack is in the layer or missing.
std::vector<double> fitted_shares(const FittedTets& tets, std::size_t place_number, const Solid& place,
                                  const Points& surface, const std::vector<Triangle>& triangles,
                                  const MeshingControl& control = {});

} // namespace sinew::solver
