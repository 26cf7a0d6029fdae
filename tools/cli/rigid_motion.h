// Does a body move without changing its shape, and if so, how?
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <Eigen/Geometry>
#include <optional>

namespace sinew::cli {

/// Pose of a rigid body: p = translation + rotation * (p_first - pivot).
struct RigidPose {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    solver::Vec3 translation = solver::Vec3::Zero();
};

/// Fits poses to the first one as they come.
class RigidFit {
  public:
    /// \param first      not empty
    /// \param tolerance  of the diagonal of the first pose: the farthest that a point may be off
    explicit RigidFit(solver::Points first, double tolerance = 2e-5);
    /// The best fit, its rotation on one hemisphere with that of the last fit; nothing if a point is farther off.
    std::optional<RigidPose> add(const solver::Points& pose);
    /// Centre of the points in the first pose.
    const solver::Vec3& pivot() const { return pivot_; }

  private:
    solver::Points first_;
    Eigen::Matrix3Xd rest_; ///< about the pivot
    solver::Vec3 pivot_;
    double allowed_;
    Eigen::Quaterniond last_ = Eigen::Quaterniond::Identity();
};

} // namespace sinew::cli
