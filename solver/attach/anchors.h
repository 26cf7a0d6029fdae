// Where attachments hold: made once, at the start frame, from the closest points then.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/state.h"

namespace sinew::solver {

/// Position of a bone anchor: the point on its triangle plus the offset, turned with the triangle.
Vec3 bone_anchor(const Anchor& anchor, const std::vector<Triangle>& triangles, const Points& positions);

/// Anchors of one attachment: source vertices, and on quadratic tets with a surface as coarse as they are the middles
/// of its edges too, so that the tets' own nodes there are held. `surfaces[body]` are the surface positions of every
/// body at the start frame [m].
///
/// A tissue target carries the anchor in the tet that holds the closest point: with maintainOffset the coordinates are
/// those of the source point itself (outside the tet they extrapolate), so the offset turns and stretches with the
/// target and the forces on both sides balance in sum and in moment. A bone target carries it in the closest
/// triangle's own frame, which is exact for rigid motion.
/// Throws Error FE204 (weights), FE212 (nothing to attach or nowhere to attach to).
std::vector<Anchor> make_anchors(const Scene& scene, const AttachmentRest& attachment,
                                 const std::vector<Points>& surfaces);

} // namespace sinew::solver
