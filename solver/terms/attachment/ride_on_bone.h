// Points that ride on a bone beside a triangle of its surface, as anchors of attachments do.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/attachment/anchors.h"

namespace sinew::solver {

/// An anchor without a source, whose target is this place of a bone's triangle and whose offset reaches to `point`:
/// bone_anchor gives `point` while the bone stands at `positions`. The triangle must have an area.
Anchor ride_on_bone(const Triangle& triangle, const Vec3& place, const Points& positions, const Vec3& point);

} // namespace sinew::solver
