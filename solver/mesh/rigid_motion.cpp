// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/rigid_motion.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

/// Points spread less than this share of their length across their main axis lie on a line.
constexpr double on_a_line = 1e-12;

Mat3 cross_matrix(const Vec3& w) {
    Mat3 k;
    k << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    return k;
}

/// V(w) of the exponential map of rigid motions: exp(w, u) translates by V u.
Mat3 translation_factor(const Vec3& w) {
    const double a = w.norm(), half = std::sin(0.5 * a);
    const double first = a < 1e-4 ? 0.5 - a * a / 24 : 2 * half * half / (a * a);
    const double second = a < 1e-2 ? 1.0 / 6 - a * a / 120 + a * a * a * a / 5040 : (a - std::sin(a)) / (a * a * a);
    const Mat3 k = cross_matrix(w);
    return Mat3::Identity() + first * k + second * k * k;
}

} // namespace

Vec3 rotation_vector(const Eigen::Quaterniond& q) {
    const double s = q.vec().norm();
    if (s < 1e-150) return Vec3::Zero();
    const double way = q.w() < 0 ? -1 : 1; // q and -q are one rotation
    return 2 * way * std::atan2(s, way * q.w()) / s * q.vec();
}

Eigen::Quaterniond rotation_by(const Vec3& w) {
    const double angle = w.norm();
    if (angle < 1e-150) return Eigen::Quaterniond::Identity();
    const Vec3 v = std::sin(0.5 * angle) / angle * w;
    return {std::cos(0.5 * angle), v.x(), v.y(), v.z()};
}

RigidMotion RigidMotion::after(const RigidMotion& first) const {
    return {(rotation * first.rotation).normalized(), (*this)(first.translation)};
}

RigidMotion RigidMotion::inverse() const {
    const Eigen::Quaterniond back = rotation.conjugate();
    return {back, -(back.toRotationMatrix() * translation)};
}

RigidMotion between(const RigidMotion& from, const RigidMotion& to, double share) {
    if (share == 1 || from == to) return to;
    if (share == 0) return from;
    const RigidMotion way = to.after(from.inverse());
    const Vec3 turn = rotation_vector(way.rotation);
    const Vec3 shift = translation_factor(turn).partialPivLu().solve(way.translation);
    const RigidMotion part{rotation_by(share * turn), translation_factor(share * turn) * (share * shift)};
    return part.after(from);
}

Eigen::Quaterniond best_rotation(const Mat3& covariance) {
    const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Vec3 spread = svd.singularValues();
    if (!(spread[0] > 0)) return Eigen::Quaterniond::Identity();
    if (spread[1] <= on_a_line * spread[0])
        return Eigen::Quaterniond::FromTwoVectors(svd.matrixV().col(0), svd.matrixU().col(0));
    Vec3 sign(1, 1, 1);
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign[2] = -1;
    const Mat3 rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
    return Eigen::Quaterniond(rotation).normalized();
}

RigidFit fit_rigid(std::span<const Vec3> from, std::span<const Vec3> to) {
    RigidFit out;
    if (from.empty() || std::equal(from.begin(), from.end(), to.begin(), to.end())) return out;
    Vec3 from_centre = Vec3::Zero(), to_centre = Vec3::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) from_centre += from[i], to_centre += to[i];
    from_centre /= static_cast<double>(from.size()), to_centre /= static_cast<double>(from.size());
    Mat3 covariance = Mat3::Zero();
    for (std::size_t i = 0; i < from.size(); ++i)
        covariance += (to[i] - to_centre) * (from[i] - from_centre).transpose();
    out.motion.rotation = best_rotation(covariance);
    out.motion.translation = to_centre - out.motion.rotation.toRotationMatrix() * from_centre;
    for (std::size_t i = 0; i < from.size(); ++i)
        out.farthest = std::max(out.farthest, (out.motion(from[i]) - to[i]).norm());
    return out;
}

} // namespace sinew::solver
