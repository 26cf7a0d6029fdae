// Meshes that ride on a tissue's tets: found at rest once, moved at every frame. Exact for affine motion.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"

namespace sinew::nodes {

/// Which tet vertices carry each point. `points` stand beside the tissue at rest, in scene units. Points outside of all
/// tets are extrapolated from the nearest. Throws solver::Error FE201 (no tets), FE202 (a point is not finite).
CarriedPoints find_carriers(const solver::TissueRest& tissue, const solver::Points& points);

/// Where they are when the tets have moved. `midpoints`: of quadratic tets, else empty (see Solved).
solver::Points carried(const CarriedPoints& points, const solver::Points& corners, const solver::Points& midpoints);

/// A collision mesh placed in the tets of a tissue. Throws solver::Error as solver::check_usable and find_carriers do, and
/// FE239 where no vertex is in or near the tets.
CollisionSurface place_collision_surface(const solver::TissueRest& tissue, const Mesh& mesh);

} // namespace sinew::nodes
