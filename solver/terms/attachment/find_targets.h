// To which points of the target the samples of an attachment's source hold on.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/closest_point.h"
#include "solver/scene.h"
#include "solver/surface/quadrature.h"

namespace sinew::solver {

struct TargetSearch {
    const AttachmentRest& attachment;
    const Points& target; ///< surface of the target at the start frame [m]
    const std::vector<Triangle>&triangles, &source_triangles;
    const SurfaceTree* tree; ///< of the target; only closest_point needs it
    double source_edge;      ///< mean edge of the source's samples [m]
};

struct TargetPoint {
    bool allowed = false;
    Triangle vertices{-1, -1, -1}; ///< of the target
    Vec3 place = Vec3::Zero();     ///< barycentric coordinates among them
    Vec3 point = Vec3::Zero();     ///< [m]
};

struct FoundTargets {
    std::vector<TargetPoint> points; ///< one a sample
    double max_distance = 0;         ///< in use [m]
};

/// Which triangles of a target may be held on to: those painted at all their corners. Throws Error FE204, FE240 (none).
std::vector<char> allowed_triangles(const AttachmentRest& attachment, const Points& target,
                                    const std::vector<Triangle>& triangles);

/// Throws Error FE204 (weights or meshes that do not fit), FE217 (faces that do not match), FE240 (no sample finds a
/// hold).
FoundTargets find_targets(const TargetSearch& in, const std::vector<SurfaceSample>& samples);

} // namespace sinew::solver
