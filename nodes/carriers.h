// Meshes that ride on a tissue's tets: found at rest once, moved at every frame. Exact for affine motion.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/values.h"

#include <string>
#include <string_view>

namespace sinew::nodes {

/// Which tet vertices carry each point. `points` stand beside the tissue at rest, in scene units. Points outside of all
/// tets are extrapolated from the nearest. Throws solver::Error FE201 (no tets), FE202 (a point is not finite).
CarriedPoints find_carriers(const solver::TissueRest& tissue, const solver::Points& points);

/// Where they are when the tets have moved. `midpoints`: of quadratic tets, else empty (see Solved).
solver::Points carried(const CarriedPoints& points, const solver::Points& corners, const solver::Points& midpoints);

/// Points of a mesh of the user's, placed in the tets of a tissue.
struct PlacedPoints {
    CarriedPoints carriers;
    std::size_t far_vertices = 0; ///< more than a tet's width outside of the tets
};

/// Throws solver::Error as find_carriers does, and FE239 where no vertex is in or near the tets.
/// \param whose "skin", for the message
PlacedPoints place(const solver::TissueRest& tissue, const Mesh& mesh, const std::string& whose);

/// Warns (FE239) at `attribute` if some of the `count` vertices are far.
void warn_of_far_vertices(const engine::Reads& in, std::string_view attribute, const PlacedPoints& placed,
                          const std::string& whose);

} // namespace sinew::nodes
