// Where a material layer is, given by a closed mesh: its share of each tet, and which points of a surface it reaches.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_mesh.h"
#include "solver/meshing/meshing_control.h"
#include "solver/meshing/solid.h"

#include <optional>
#include <vector>

namespace sinew::solver {

/// A closed mesh as the place of a layer. Parts may overlap and be turned either way; a shell inside another one
/// bounds a hollow (Fill::empty_cavities), so that two shells make a skin. Throws Error FE230 (open, with the edges),
/// and what make_solid throws.
Solid make_layer_place(const Points& points, const std::vector<Triangle>& triangles,
                       const MeshingControl& control = {});

/// The tissue's own solid, if its surface is closed and can be made one; else the tets were made for another surface,
/// or end elsewhere than at its triangles.
std::optional<Solid> tissue_solid(const Points& surface, const std::vector<Triangle>& triangles,
                                  const MeshingControl& control = {});

/// Share of each tet's solid part that lies inside `place`, 0 to 1.
///
/// Exact up to rounding (tet_share.h): no point is sampled. Of a tet that the tissue's surface cuts (TetMesh::cut) it
/// is the share of what both enclose in what the surface encloses, if the surface is closed and encloses what the tet
/// knows of itself, within 1e-6 of the tet; of tets that another mesh was cut by, or with holes or cavities, and of
/// all that are not cut, the share of the whole tet. The same for any number of threads.
/// \param surface, triangles the tissue's own mesh, in the same place
/// \param tissue what tissue_solid makes of it, where that is known
std::vector<double> layer_shares(const TetMesh& tets, const Solid& place, const Points& surface,
                                 const std::vector<Triangle>& triangles, const MeshingControl& control = {},
                                 const Solid* tissue = nullptr);

/// Share of a tet that its own surface encloses, as it was found when the tet was made.
/// \param place in `cut.tets`
double known_share(const CutTets& cut, std::size_t place);

/// 1 for each point inside `place` or on it, within 1e-6 of its longest side; else 0.
std::vector<double> points_in_layer(const Points& points, const Solid& place);

} // namespace sinew::solver
