// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/rigid_motion.h"

#include "solver/mesh/rigid_motion.h"
#include "solver/mesh/surface_mesh.h"

namespace sinew::cli {

using solver::Points;

namespace {

Eigen::Map<const Eigen::Matrix3Xd> as_columns(const Points& points) {
    static_assert(sizeof(solver::Vec3) == 3 * sizeof(double));
    return {points.front().data(), 3, static_cast<Eigen::Index>(points.size())};
}

} // namespace

RigidFit::RigidFit(Points first, double tolerance)
    : first_(std::move(first))
    , rest_(as_columns(first_))
    , allowed_(tolerance * solver::bounding_box(first_).size().norm()) {
    // Aligned, because the order in which Eigen adds follows the alignment of what it adds into.
    alignas(16) const solver::Vec3 mean = rest_.rowwise().mean();
    pivot_ = mean;
    rest_.colwise() -= pivot_;
}

std::optional<RigidPose> RigidFit::add(const Points& pose) {
    RigidPose fit;
    if (pose == first_) { // exact, so that a body at rest has no motion at all
        fit.translation = pivot_;
    } else {
        const Eigen::Matrix3Xd now = as_columns(pose);
        fit.translation = now.rowwise().mean();
        fit.rotation = solver::best_rotation((now.colwise() - fit.translation) * rest_.transpose());
        const Eigen::Matrix3Xd off = (fit.rotation.toRotationMatrix() * rest_).colwise() + fit.translation - now;
        if (!(off.colwise().norm().maxCoeff() <= allowed_)) return {};
    }
    // q and -q are one rotation; a viewer that blends two frames must not take the long way round.
    if (last_.dot(fit.rotation) < 0) fit.rotation.coeffs() *= -1;
    last_ = fit.rotation;
    return fit;
}

} // namespace sinew::cli
