// Does a body move without changing its shape, and if so, how?
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

namespace sinew::cli {

/// Pose of a rigid body: p = translation + rotation * (p_first - pivot).
struct RigidPose {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    solver::Vec3 translation = solver::Vec3::Zero();
};

struct RigidMotion {
    solver::Vec3 pivot = solver::Vec3::Zero(); ///< centre of the points in the first pose
    std::vector<RigidPose> poses;              ///< one a frame; neighbouring rotations lie on one hemisphere
    bool moves = false;
};

/// Best fit of every pose to the first one; nothing if a point is farther off
/// than `tolerance` times the diagonal of the first pose.
std::optional<RigidMotion> find_rigid_motion(const std::vector<std::shared_ptr<const solver::Points>>& poses,
                                             double tolerance = 2e-5);

} // namespace sinew::cli
