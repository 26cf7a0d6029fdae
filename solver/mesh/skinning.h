// Skinning: points that follow several moving frames, each by its share.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <span>
#include <vector>

namespace sinew::solver {

/// From where points are bound to where one joint brings them: p' = linear p + shift.
struct JointMotion {
    Mat3 linear = Mat3::Identity();
    Vec3 shift = Vec3::Zero();
};

/// Linear blend: every point goes to the weighted mean of where its joints would bring it. Cheap, and loses volume
/// about joints that twist.
/// \param weights for each joint, one number a point, which sum to 1 over the joints
Points skin_linearly(const Points& bound, std::span<const JointMotion> joints,
                     std::span<const std::vector<double>> weights);

/// How far a joint is from turns and translations alone: the largest entry of LᵀL - I; 1 more where it mirrors.
double unlike_rigid(const JointMotion& joint);

/// Dual quaternion linear blending (Kavan, Collins, Zara, O'Sullivan: Geometric skinning with approximate dual
/// quaternion blending, ACM TOG 27 (4), 2008): every point moves rigidly, so twists keep their volume. The motions must
/// be rigid; of each pair of quaternions for one turn the one nearer to that of the point's heaviest joint is taken.
Points skin_by_dual_quaternions(const Points& bound, std::span<const JointMotion> joints,
                                std::span<const std::vector<double>> weights);

} // namespace sinew::solver
