// Rigid motions: going part of the way from one to another, and finding the one that moved a cloud of points.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <span>

namespace sinew::solver {

/// p' = rotation p + translation.
struct RigidMotion {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity(); ///< of unit length
    Vec3 translation = Vec3::Zero();

    Vec3 operator()(const Vec3& p) const { return rotation.toRotationMatrix() * p + translation; }
    /// First `first`, then this.
    RigidMotion after(const RigidMotion& first) const;
    RigidMotion inverse() const;
    bool operator==(const RigidMotion& other) const {
        return rotation.coeffs() == other.rotation.coeffs() && translation == other.translation;
    }
};

/// The axis of a rotation times its angle, at most pi; and back.
Vec3 rotation_vector(const Eigen::Quaterniond& rotation);
Eigen::Quaterniond rotation_by(const Vec3& vector);

/// At `share` of the way: along the screw that leads from one to the other, the shorter way round and at a steady rate,
/// so that what turns about a fixed axis stays on its circle. 0 and 1 are the two exactly.
RigidMotion between(const RigidMotion& from, const RigidMotion& to, double share);

/// The rotation that brings points nearest to others (Kabsch 1978), from the sum of to fromᵀ, both about their centres.
/// Never a reflection, even where that would fit better. Of points on a line the one that turns least.
Eigen::Quaterniond best_rotation(const Mat3& covariance);

/// A rigid motion and how far it misses.
struct RigidFit {
    RigidMotion motion;
    double farthest = 0; ///< largest distance of a moved point from where it should be [m]
};
/// The rigid motion that brings `from` nearest to `to`, of as many points; exactly none where they are the same.
RigidFit fit_rigid(std::span<const Vec3> from, std::span<const Vec3> to);

} // namespace sinew::solver
