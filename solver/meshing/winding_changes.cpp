// How a closed surface's winding number changes along straight ways.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/winding_changes.h"

#include "solver/index.h"

#include <algorithm>

namespace sinew::solver {
namespace {

/// Rounding errors of the products below are several times smaller, relatively to those of the factors' lengths.
constexpr double rounding = 1e-14;

/// -1 or 1; 0 where rounding may have made the sign.
int sign(double x, double size) { return x > rounding * size ? 1 : x < -rounding * size ? -1 : 0; }

/// What going from p to p + way through a triangle changes; nothing where it is not sure. Places and corners are
/// exact, so nothing depends on how far they lie from the origin.
std::optional<int> change(const Vec3& p, const Vec3& way, const std::array<Vec3, 3>& triangle) {
    const Vec3 a = triangle[0] - p, b = triangle[1] - p, c = triangle[2] - p;
    const double reach = std::max({a.norm(), b.norm(), c.norm()}), length = way.norm();
    const double beyond = reach + length; // no corner is farther from the end
    const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    // The winding number is 1 below the triangle and 0 above.
    const int from = sign(-normal.dot(a), reach * reach * reach),
              to = sign(normal.dot(way - a), beyond * beyond * beyond);
    if (from != 0 && from == to) return 0;
    const double size = length * reach * reach;
    const int ab = sign(way.dot(a.cross(b)), size), bc = sign(way.dot(b.cross(c)), size),
              ca = sign(way.dot(c.cross(a)), size);
    if (std::min({ab, bc, ca}) < 0 && std::max({ab, bc, ca}) > 0) return 0; // the line passes by
    if (from == 0 || to == 0 || ab == 0 || bc == 0 || ca == 0) return {};
    return from > 0 ? 1 : -1;
}

Bvh tree_of(const Points& points, const std::vector<Triangle>& triangles) {
    Points low, high;
    low.reserve(triangles.size()), high.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles) {
        low.push_back(points[at(a)].cwiseMin(points[at(b)]).cwiseMin(points[at(c)]));
        high.push_back(points[at(a)].cwiseMax(points[at(b)]).cwiseMax(points[at(c)]));
    }
    return build_bvh(low, high);
}

/// A box around places, turned as they lie.
struct TurnedBox {
    Vec3 origin;
    std::array<Vec3, 3> axes;
    std::array<double, 3> low{}, high{};

    TurnedBox(const Points& places, double margin)
        : origin(places[0]) {
        const Vec3 along = farthest(places, [&](const Vec3& p) { return p; });
        axes[0] = along.norm() > 0 ? along.normalized() : Vec3::UnitX();
        const Vec3 aside = farthest(places, [&](const Vec3& p) -> Vec3 { return p - axes[0].dot(p) * axes[0]; });
        // Places in a row are off it by rounding: no direction is better than others.
        const Vec3 other = aside - axes[0].dot(aside) * axes[0];
        axes[1] = aside.norm() > 1e-9 * along.norm() ? other.normalized() : axes[0].unitOrthogonal();
        axes[2] = axes[0].cross(axes[1]);
        for (std::size_t d = 0; d < 3; ++d) {
            for (const Vec3& p : places) {
                low[d] = std::min(low[d], axes[d].dot(p - origin));
                high[d] = std::max(high[d], axes[d].dot(p - origin));
            }
            low[d] -= margin, high[d] += margin;
        }
    }

  private:
    template <class Seen>
    Vec3 farthest(const Points& places, const Seen& seen) const {
        Vec3 most = Vec3::Zero();
        for (const Vec3& p : places)
            if (const Vec3 here = seen(p - origin); here.squaredNorm() > most.squaredNorm()) most = here;
        return most;
    }
};

} // namespace

WindingChanges::WindingChanges(const Points& points, const std::vector<Triangle>& triangles)
    : points_(points)
    , triangles_(triangles)
    , tree_(tree_of(points, triangles))
    , corners_(tree_, points, triangles)
    , extent_(tree_.nodes.empty() ? 0 : (tree_.nodes[0].max - tree_.nodes[0].min).norm()) {}

std::vector<int> WindingChanges::near(const Points& places) const {
    using Four = LeafCorners::Four;
    Vec3 low = places[0], high = places[0];
    for (const Vec3& p : places) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const TurnedBox box(places, 10 * rounding * extent_);
    std::vector<int> found;
    visit_leaves_near(tree_, low, high, [&](const BvhNode& leaf) {
        std::array<std::array<Four, 3>, 3> corner; // less the origin
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t d = 0; d < 3; ++d)
                corner[c][d] = corners_.four(leaf, c, d) - box.origin[static_cast<int>(d)];
        Eigen::Array<bool, 4, 1> beyond = Eigen::Array<bool, 4, 1>::Constant(false);
        for (std::size_t d = 0; d < 3; ++d) {
            const Vec3& axis = box.axes[d];
            const auto place = [&](std::size_t c) -> Four {
                return axis.x() * corner[c][0] + axis.y() * corner[c][1] + axis.z() * corner[c][2];
            };
            const Four one = place(0), two = place(1), three = place(2);
            beyond = beyond || one.max(two).max(three) < box.low[d] || one.min(two).min(three) > box.high[d];
        }
        for (int i = 0; i < leaf.count; ++i)
            if (!beyond[i]) found.push_back(tree_.order[at(leaf.first + i)]);
        return true;
    });
    return found;
}

std::optional<int> WindingChanges::along(const Vec3& from, const Vec3& to, const std::vector<int>& near) const {
    const Vec3 low = from.cwiseMin(to), high = from.cwiseMax(to), way = to - from;
    int sum = 0;
    for (const int t : near) {
        const auto& [a, b, c] = triangles_[at(t)];
        const std::array<Vec3, 3> corners{points_[at(a)], points_[at(b)], points_[at(c)]};
        const Vec3 least = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]),
                   most = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
        if ((least.array() > high.array()).any() || (most.array() < low.array()).any()) continue;
        const std::optional<int> one = change(from, way, corners);
        if (!one) return {};
        sum += *one;
    }
    return sum;
}

} // namespace sinew::solver
