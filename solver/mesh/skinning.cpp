// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/skinning.h"

#include "solver/mesh/rigid_motion.h"
#include "solver/parallel.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace sinew::solver {

namespace {

/// real + dual epsilon, of a turn and the translation after it.
struct DualQuaternion {
    Eigen::Vector4d real = Eigen::Vector4d::Zero(), dual = Eigen::Vector4d::Zero(); ///< x, y, z, w
};

DualQuaternion dual_quaternion(const JointMotion& joint) {
    const Eigen::Quaterniond turn = best_rotation(joint.linear);
    const Eigen::Quaterniond shift(0, joint.shift.x(), joint.shift.y(), joint.shift.z());
    return {turn.coeffs(), 0.5 * (shift * turn).coeffs()};
}

Vec3 moved(const DualQuaternion& q, const Vec3& p) {
    const double length = q.real.norm();
    const Eigen::Quaterniond turn(Eigen::Vector4d(q.real / length)), dual(Eigen::Vector4d(q.dual / length));
    return turn.toRotationMatrix() * p + 2 * (dual * turn.conjugate()).vec();
}

} // namespace

Points skin_linearly(const Points& bound, std::span<const JointMotion> joints,
                     std::span<const std::vector<double>> weights) {
    Points out(bound.size());
    parallel_for(bound.size(), 1024, [&](std::size_t v) {
        Vec3 p = Vec3::Zero();
        for (std::size_t j = 0; j < joints.size(); ++j)
            if (const double w = weights[j][v]; w != 0) p += w * (joints[j].linear * bound[v] + joints[j].shift);
        out[v] = p;
    });
    return out;
}

double unlike_rigid(const JointMotion& joint) {
    const double off = (joint.linear.transpose() * joint.linear - Mat3::Identity()).cwiseAbs().maxCoeff();
    return joint.linear.determinant() > 0 ? off : off + 1;
}

Points skin_by_dual_quaternions(const Points& bound, std::span<const JointMotion> joints,
                                std::span<const std::vector<double>> weights) {
    std::vector<DualQuaternion> motions;
    for (const JointMotion& joint : joints) motions.push_back(dual_quaternion(joint));
    Points out(bound.size());
    parallel_for(bound.size(), 1024, [&](std::size_t v) {
        std::size_t heaviest = 0;
        for (std::size_t j = 1; j < joints.size(); ++j)
            if (weights[j][v] > weights[heaviest][v]) heaviest = j;
        DualQuaternion sum;
        for (std::size_t j = 0; j < joints.size(); ++j) {
            if (weights[j][v] == 0) continue;
            const double w = motions[j].real.dot(motions[heaviest].real) < 0 ? -weights[j][v] : weights[j][v];
            sum.real += w * motions[j].real;
            sum.dual += w * motions[j].dual;
        }
        out[v] = moved(sum, bound[v]);
    });
    return out;
}

} // namespace sinew::solver
