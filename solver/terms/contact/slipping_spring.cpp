// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/slipping_spring.h"

namespace sinew::solver {

double SlippingSpring::energy(const Vec3& way) const {
    const double length = way.norm();
    return slips(way) ? most * (length - 0.5 * most / stiffness) : 0.5 * stiffness * length * length;
}

Vec3 SlippingSpring::force(const Vec3& way) const {
    return slips(way) ? Vec3(most / way.norm() * way) : Vec3(stiffness * way);
}

void FollowedForce::follow(const SlippingSpring& spring, const Vec3& way) {
    if (has_way_ && spring.slips(way_)) {
        const double length = way_.norm(), along = way_.dot(way - way_) / length;
        force_ = (spring.most * way - along * force_) / length;
    } else if (has_way_) {
        force_ = spring.stiffness * way;
    }
    const double size = force_.norm();
    if (size > spring.most) force_ *= spring.most / size;
    way_ = way, has_way_ = true;
}

Mat3 FollowedForce::stiffness(const SlippingSpring& spring, const Vec3& way, const Mat3& holds) const {
    if (!spring.slips(way)) return spring.stiffness * holds;
    const double length = way.norm();
    const Mat3 turned = force_ * way.transpose() / length;
    return (spring.most * holds - 0.5 * (turned + turned.transpose())) / length;
}

} // namespace sinew::solver
