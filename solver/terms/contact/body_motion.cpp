// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/body_motion.h"

#include "solver/index.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace sinew::solver {

void BodyMotion::set(const Points& from, const Points& to) {
    farthest_ = 0;
    later_.assign(to.begin(), to.end());
    if (from.empty()) return;
    Vec3 first = Vec3::Zero(), second = Vec3::Zero();
    double farthest = 0;
    for (std::size_t p = 0; p < from.size(); ++p) {
        first += from[p], second += to[p];
        farthest = std::max(farthest, (to[p] - from[p]).squaredNorm());
    }
    back_ = Eigen::Isometry3d::Identity();
    farthest_ = std::sqrt(farthest);
    if (farthest == 0) return;
    first /= static_cast<double>(from.size()), second /= static_cast<double>(from.size());
    Mat3 covariance = Mat3::Zero();
    for (std::size_t p = 0; p < from.size(); ++p) covariance += (from[p] - first) * (to[p] - second).transpose();
    const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
    Eigen::Isometry3d back = Eigen::Isometry3d::Identity();
    back.linear() = u * svd.matrixV().transpose();
    back.translation() = first - back.linear() * second;
    farthest = 0;
    for (std::size_t p = 0; p < from.size(); ++p) {
        later_[p] = back * to[p];
        farthest = std::max(farthest, (later_[p] - from[p]).squaredNorm());
    }
    if (std::sqrt(farthest) < farthest_)
        back_ = back, farthest_ = std::sqrt(farthest);
    else
        later_.assign(to.begin(), to.end());
}

void BodyMotion::fit_boxes(const CollisionBody& body, const CollisionBoxes& start) {
    nodes_ = start.nodes();
    // Children stand behind their parents.
    for (std::size_t n = nodes_.size(); n-- > 0;) {
        BvhNode& node = nodes_[n];
        if (node.count == 0) {
            const BvhNode &one = nodes_[n + 1], &other = nodes_[at(node.first)];
            node.min = one.min.cwiseMin(other.min), node.max = one.max.cwiseMax(other.max);
            continue;
        }
        for (int i = node.first; i < node.first + node.count; ++i)
            for (const int v : body.triangles()[at(body.bvh().order[at(i)])])
                node.min = node.min.cwiseMin(later_[at(v)]), node.max = node.max.cwiseMax(later_[at(v)]);
    }
}

bool BodyMotion::meets(const Vec3& low, const Vec3& high) const {
    if (nodes_.empty()) return false;
    int stack[128]; // the tree of 2^31 triangles is 30 levels deep
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const int n = stack[--depth];
        const BvhNode& node = nodes_[at(n)];
        if ((node.min.array() > high.array()).any() || (node.max.array() < low.array()).any()) continue;
        if (node.count > 0) return true;
        stack[depth++] = n + 1, stack[depth++] = node.first;
    }
    return false;
}

} // namespace sinew::solver
