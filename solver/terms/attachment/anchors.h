// Where attachments hold: made once, at the start frame, from the closest points then.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/step_inputs.h"
#include "solver/term/memory.h"

#include <array>
#include <span>
#include <vector>

namespace sinew::solver {

/// A point that a body carries.
struct AnchorEnd {
    int tet = -1;                            ///< of a tissue; -1 on a bone or cloth
    std::array<int, 3> vertices{-1, -1, -1}; ///< of a bone's or cloth's surface: those of a triangle
    std::array<double, 4> coordinates{};     ///< barycentric in the tet, or in the triangle (the fourth is 0)
    friend bool operator==(const AnchorEnd&, const AnchorEnd&) = default;
};

/// Where a sample of a source's surface holds on to the target, fixed at the start frame.
struct Anchor {
    AnchorEnd source, target;
    std::array<double, 3> offset{}; ///< from the target's point, in the frame of its triangle [m]; bones and cloth
    double area_weight = 0;         ///< the sample's area x painted weight [m^2]
    friend bool operator==(const Anchor&, const Anchor&) = default;
};
static_assert(sizeof(Anchor) == 4 * 2 * 4 + 8 * (4 + 4 + 3 + 1), "no padding: its bytes are kept as they are");

/// What became of an attachment at the start frame.
struct AttachmentStart {
    double painted = 0;      ///< area x weight of the source's samples [m^2]
    double left_out = 0;     ///< that of those without an allowed point of the target near by [m^2]
    double max_distance = 0; ///< in use [m]
    double longest = 0;      ///< farthest that a sample reaches to the target [m]
    double source_size = 0;  ///< diagonal of the box around the painted part of the source [m]
    friend bool operator==(const AttachmentStart&, const AttachmentStart&) = default;
};

/// What attachments keep from the start frame, each in the order of the scene's attachments.
struct AttachmentMemory {
    std::vector<std::vector<Anchor>> anchors;
    std::vector<AttachmentStart> starts;
    friend bool operator==(const AttachmentMemory&, const AttachmentMemory&) = default;
};

/// The same, read where a term's memory holds it: nothing is copied, and the bytes stay as long as this does.
struct AttachmentView {
    SharedBytes bytes;
    std::vector<std::span<const Anchor>> anchors;
    std::vector<AttachmentStart> starts;
};

/// Position of an end on a bone.
Vec3 bone_point(const AnchorEnd& end, const Points& positions);
/// Where an end was modelled, on a tissue or a bone.
Vec3 modelled_point(const Scene& scene, int body, const AnchorEnd& end);
/// Position of an anchor whose target is a bone: the point on its triangle plus the offset, turned with the triangle.
Vec3 bone_anchor(const Anchor& anchor, const Points& positions);
/// What carries an end on a body that deforms.
PointWeights carried_end(const Scene& scene, int body, const AnchorEnd& end);
/// The offset of an anchor whose target is a cloth, turned with its triangle; `x`: 3 numbers a vertex of the scene.
Vec3 cloth_offset(const Scene& scene, int target, const Anchor& anchor, const std::vector<double>& x);

/// Anchors of all attachments, whatever their mode is, which may change; `inputs`, one an attachment, at the start
/// frame: what is off then may lack a hold, and has no anchors. `surfaces[body]` are the surface positions of every
/// body at the start frame [m]; areas are those at rest.
///
/// The source's painted triangles are cut to the size of the tets that carry either end, and sampled (solver/surface).
/// Each sample holds on to the closest point of the target; if that is forbidden, to the closest allowed one up to
/// max_distance away, or to nothing. By vertex_id it holds on to the same place in the triangle of the same vertex
/// numbers, where all three are allowed.
///
/// A tissue target carries the anchor in the tet that holds the closest point: with maintain_offset the coordinates are
/// those of the source point itself (outside the tet they extrapolate), so the offset turns and stretches with the
/// target and the forces on both sides balance in sum and in moment. A bone target carries it in the closest
/// triangle's own frame, which is exact for rigid motion. So does a cloth target, whose triangle is looked at as it is
/// at the start of a step: a cloth that turns fast under a large offset lags behind by a step's turn.
/// Throws Error, its attachment set: FE204 (weights), FE212 (nothing painted), FE240 (nothing of it finds a hold),
/// FE232 (too many samples).
AttachmentMemory make_anchors(const Scene& scene, const std::vector<AttachmentInputs>& inputs,
                              const std::vector<Points>& surfaces);

/// To and from the bytes of a term's memory.
void keep_attachments(const AttachmentMemory& attachments, TermMemory& memory);
/// Empty where none of `memories` is that of attachments. Throws Error IO403 where the bytes end too early.
AttachmentView attachments_kept(const std::vector<TermMemory>& memories);
/// Throws Error IO403 where what was kept is of another scene, FE240 (attachment set) where an attachment is on that
/// found no hold at the start frame.
void check_kept(const Scene& scene, const std::vector<AttachmentInputs>& inputs, const AttachmentView& kept);

} // namespace sinew::solver
