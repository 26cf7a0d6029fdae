// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/body_motion.h"

#include "solver/index.h"
#include "solver/mesh/triangle_math.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

/// The rigid motion that takes one set of points nearest to another (Kabsch 1976).
Eigen::Isometry3d nearest_motion(const Points& from, const Points& to) {
    Vec3 first = Vec3::Zero(), second = Vec3::Zero();
    for (std::size_t p = 0; p < from.size(); ++p) first += from[p], second += to[p];
    first /= static_cast<double>(from.size()), second /= static_cast<double>(from.size());
    Mat3 covariance = Mat3::Zero();
    for (std::size_t p = 0; p < from.size(); ++p) covariance += (to[p] - second) * (from[p] - first).transpose();
    const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = u * svd.matrixV().transpose();
    out.translation() = second - out.linear() * first;
    return out;
}

double farthest_between(const Points& one, const Points& other) {
    double square = 0;
    for (std::size_t p = 0; p < one.size(); ++p) square = std::max(square, (other[p] - one[p]).squaredNorm());
    return std::sqrt(square);
}

} // namespace

void BodyMotion::set(const Points& from, const Points& to) {
    later_.assign(to.begin(), to.end());
    back_ = Eigen::Isometry3d::Identity();
    farthest_ = farthest_between(from, to);
    if (farthest_ == 0) return;
    back_ = nearest_motion(to, from);
    for (Vec3& p : later_) p = back_ * p;
    farthest_ = farthest_between(from, later_);
}

double BodyMotion::farthest_way(const Points& from, const Points& now) const {
    double square = 0;
    for (std::size_t p = 0; p < from.size(); ++p) square = std::max(square, (seen(now[p]) - from[p]).squaredNorm());
    return std::sqrt(square);
}

void BodyMotion::fit_boxes(const CollisionBody& body, const Points& from) {
    body_ = &body;
    to_modelled_ = nearest_motion(from, body.modelled());
    turned_.assign(from.begin(), from.end());
    for (Vec3& p : turned_) p = to_modelled_ * p;
    for (Vec3& p : later_) p = to_modelled_ * p;
    refit(body.bvh(), nodes_, [&](int triangle, BvhNode& node) {
        for (const int v : body.triangles()[at(triangle)])
            for (const Points* points : {&turned_, &later_})
                node.min = node.min.cwiseMin((*points)[at(v)]), node.max = node.max.cwiseMax((*points)[at(v)]);
    });
}

/// No nearer than at the start, less the farthest that a corner and the place move against each other.
bool BodyMotion::may_come_near(int triangle, const Vec3& one, const Vec3& other, double margin) const {
    const Triangle& corners = body_->triangles()[at(triangle)];
    double way2 = 0;
    for (const int v : corners) way2 = std::max(way2, (other - one - later_[at(v)] + turned_[at(v)]).squaredNorm());
    const std::array<Vec3, 3> places{turned_[at(corners[0])], turned_[at(corners[1])], turned_[at(corners[2])]};
    const Vec3 nearest = closest_on_triangle(one, places, corners).point;
    return (one - nearest).norm() <= std::sqrt(way2) + margin;
}

bool BodyMotion::meets(const Vec3& one, const Vec3& other, double margin) const {
    if (nodes_.empty()) return false;
    const Vec3 a = to_modelled_ * one, b = to_modelled_ * other;
    const Vec3 low = a.cwiseMin(b) - Vec3::Constant(margin), high = a.cwiseMax(b) + Vec3::Constant(margin);
    int stack[128]; // the tree of 2^31 triangles is 30 levels deep
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const int n = stack[--depth];
        const BvhNode& node = nodes_[at(n)];
        if ((node.min.array() > high.array()).any() || (node.max.array() < low.array()).any()) continue;
        if (node.count > 0) {
            for (int i = node.first; i < node.first + node.count; ++i)
                if (may_come_near(body_->bvh().order[at(i)], a, b, margin)) return true;
            continue;
        }
        stack[depth++] = n + 1, stack[depth++] = node.first;
    }
    return false;
}

} // namespace sinew::solver
