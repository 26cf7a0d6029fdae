// What a body's surface sweeps from one time to another, as someone sees it who moves along with the body: a hand and
// the muscles about it, carried far by an arm, stay as near or far as they were.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/contact/collision_body.h"

#include <Eigen/Geometry>

namespace sinew::solver {

class BodyMotion {
  public:
    /// Places of the body's points at the two times.
    void set(const Points& from, const Points& to);
    /// Where something at the second time would have been at the first, had it moved along: back by the rigid motion
    /// nearest to the body's own (Kabsch 1976).
    Vec3 seen(const Vec3& later) const { return back_ * later; }
    /// How far the farthest of places is from where it was at the first time, so seen [m].
    double farthest_way(const Points& from, const Points& now) const;
    /// No point of its surface has moved farther, so seen [m].
    double farthest() const { return farthest_; }
    /// After set, with the same places at the first time: boxes around what its triangles sweep, so seen, along the
    /// axes that the body was modelled in, so that nothing depends on how the scene is turned.
    void fit_boxes(const CollisionBody& body, const Points& from);
    /// Whether something that goes straight from one place to the other, as seen at the two times, comes nearer than a
    /// margin to a triangle, or may: each corner goes straight as well.
    bool meets(const Vec3& one, const Vec3& other, double margin) const;

  private:
    bool may_come_near(int triangle, const Vec3& one, const Vec3& other, double margin) const;
    Eigen::Isometry3d back_ = Eigen::Isometry3d::Identity();
    double farthest_ = 0;
    Points later_; ///< so seen, after fit_boxes in the axes of the boxes
    Eigen::Isometry3d to_modelled_ = Eigen::Isometry3d::Identity();
    const CollisionBody* body_ = nullptr; ///< that has the boxes
    Points turned_;                       ///< the first places, in the axes of the boxes
    std::vector<BvhNode> nodes_;
};

} // namespace sinew::solver
