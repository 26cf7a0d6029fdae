// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/rigid_motion.h"

#include "solver/mesh/rigid_motion.h"
#include "solver/mesh/surface_mesh.h"

namespace sinew::cli {

using solver::Points;
using solver::Vec3;

namespace {

Eigen::Matrix3Xd as_columns(const Points& points) {
    Eigen::Matrix3Xd out(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = points[i];
    return out;
}

} // namespace

std::optional<RigidMotion> find_rigid_motion(const std::vector<std::shared_ptr<const Points>>& poses,
                                             double tolerance) {
    RigidMotion out;
    if (poses.empty() || poses.front()->empty()) return out;
    const Points& first = *poses.front();
    const double allowed = tolerance * solver::bounding_box(first).size().norm();
    Eigen::Matrix3Xd rest = as_columns(first);
    out.pivot = rest.rowwise().mean();
    rest.colwise() -= out.pivot;
    for (const auto& pose : poses) {
        RigidPose fit;
        if (*pose == first) { // exact, so that a body at rest has no motion at all
            fit.translation = out.pivot;
        } else {
            const Eigen::Matrix3Xd now = as_columns(*pose);
            fit.translation = now.rowwise().mean();
            fit.rotation = solver::best_rotation((now.colwise() - fit.translation) * rest.transpose());
            const Eigen::Matrix3Xd off = (fit.rotation.toRotationMatrix() * rest).colwise() + fit.translation - now;
            if (!(off.colwise().norm().maxCoeff() <= allowed)) return {};
            out.moves = true;
        }
        // q and -q are one rotation; a viewer that blends two frames must not take the long way round.
        if (!out.poses.empty() && out.poses.back().rotation.dot(fit.rotation) < 0) fit.rotation.coeffs() *= -1;
        out.poses.push_back(fit);
    }
    return out;
}

} // namespace sinew::cli
