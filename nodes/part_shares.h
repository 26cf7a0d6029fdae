// How the parts of a tissue divide its tets among them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/tissue_rest.h"

#include <vector>

namespace sinew::nodes {

/// Of each tet what is solid, in the mesh's units.
std::vector<double> solid_volumes(const solver::TetMesh& mesh);
/// The volume of shares.
double sum_of(const std::vector<double>& shares, const std::vector<double>& volumes);

/// What each part has of the tets to itself: a part within it takes its share away, and parts beside each other that
/// overlap divide what they share evenly.
/// \param inside [part][tet] what of the tet's solid lies in the part's mesh
/// \param volumes of the tets' solid
/// \param found gets `shared`
std::vector<std::vector<double>> exclusive_shares(const std::vector<NestedPart>& nested,
                                                  const std::vector<std::vector<double>>& inside,
                                                  const std::vector<double>& volumes, FoundParts& found);

} // namespace sinew::nodes
