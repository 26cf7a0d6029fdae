// A spring that slips where it would pull with more than a given force: friction as potentials know it. Its energy has
// Newton's method throw points back and forth where they slip, as the exact Hessian knows nothing of how soon the force
// turns; so the force is followed as an unknown of its own beside the positions (Chan, Golub and Mulet 1999, A
// nonlinear primal-dual method for total variation-based image restoration).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

namespace sinew::solver {

/// By its way h, a vector: 1/2 k |h|^2 as long as k |h| <= most, then most (|h| - most / 2 k).
struct SlippingSpring {
    double stiffness = 0; ///< k [N/m]
    double most = 0;      ///< force at which it slips [N]; infinite if it does not
    bool slips(const Vec3& way) const { return stiffness * way.norm() > most; }
    double energy(const Vec3& way) const; ///< [J]
    Vec3 force(const Vec3& way) const;    ///< its derivative [N]
};

/// The force of a slipping spring as Newton's iterations carry it along: what the equation
/// max(1, k |h| / most) f = k h, linearised where the last iteration was, gives for where that has led to, and never
/// more than the spring's most. Where ways no longer change it is the spring's own force.
class FollowedForce {
  public:
    FollowedForce() = default;
    /// Starts with a force that is known, as of the step before [N].
    explicit FollowedForce(const Vec3& force)
        : force_(force) {}
    /// Before an iteration, with the way that it begins at.
    void follow(const SlippingSpring& spring, const Vec3& way);
    /// What the way's change by one does to the force, once the equation's linear part is solved for it [N/m]:
    /// symmetric, positive semi-definite, and the second derivative of the energy where the force is the spring's own.
    /// `holds` projects on the directions that the spring sees.
    Mat3 stiffness(const SlippingSpring& spring, const Vec3& way, const Mat3& holds) const;
    const Vec3& force() const { return force_; }

  private:
    Vec3 force_ = Vec3::Zero(), way_ = Vec3::Zero();
    bool has_way_ = false;
};

} // namespace sinew::solver
