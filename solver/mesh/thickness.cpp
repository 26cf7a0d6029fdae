// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/thickness.h"

#include "solver/error.h"
#include "solver/mesh/bvh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numbers>

namespace sinew::solver {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Corners {
    Vec3 a, b, c;
    Vec3 normal() const { return (b - a).cross(c - a); } ///< twice as long as the area
};

/// Where the ray meets the triangle from behind; infinite if it does not.
double leaves_at(const Vec3& origin, const Vec3& direction, const Corners& t) {
    const Vec3 normal = t.normal();
    const double along = normal.dot(direction);
    if (!(along > 0)) return infinite;
    const double distance = normal.dot(t.a - origin) / along;
    if (!(distance > 0)) return infinite;
    const Vec3 p = origin + distance * direction;
    // Of the three, which sum up to the normal's square: on an edge both of its triangles are met, never none.
    const double rounding = -1e-9 * normal.squaredNorm();
    const auto is_within = [&](const Vec3& from, const Vec3& to) {
        return (to - from).cross(p - from).dot(normal) >= rounding;
    };
    return is_within(t.a, t.b) && is_within(t.b, t.c) && is_within(t.c, t.a) ? distance : infinite;
}

/// Distance at which the ray enters the box; infinite if it misses it.
double enters_at(const Vec3& origin, const Vec3& inverse, const BvhNode& box) {
    double first = 0, last = infinite;
    for (int d = 0; d < 3; ++d) {
        const double one = (box.min[d] - origin[d]) * inverse[d], other = (box.max[d] - origin[d]) * inverse[d];
        // 0 times infinity: the ray lies in the box's side.
        if (std::isnan(one) || std::isnan(other)) continue;
        first = std::max(first, std::min(one, other)), last = std::min(last, std::max(one, other));
    }
    return first <= last ? first : infinite;
}

enum class Towards { inside, outside };

class Rays {
  public:
    Rays(const Points& points, const std::vector<Triangle>& triangles, Towards side)
        : points_(points)
        , triangles_(triangles) {
        Points least, most;
        double six_volumes = 0;
        for (const Triangle& t : triangles) {
            for (const int v : t)
                if (v < 0 || static_cast<std::size_t>(v) >= points.size())
                    throw Error("FE203",
                                "a triangle uses vertex " + std::to_string(v) + " of " + std::to_string(points.size()));
            const Corners c = corners(static_cast<int>(least.size()));
            least.push_back(c.a.cwiseMin(c.b).cwiseMin(c.c));
            most.push_back(c.a.cwiseMax(c.b).cwiseMax(c.c));
            six_volumes += c.a.dot(c.b.cross(c.c));
        }
        is_turned_ = (six_volumes < 0) == (side == Towards::inside);
        bvh_ = build_bvh(least, most);
    }

    Corners corners(int triangle) const {
        const Triangle& t = triangles_[static_cast<std::size_t>(triangle)];
        const auto at = [&](std::size_t k) { return points_[static_cast<std::size_t>(t[k])]; };
        // All normals away from the side that the rays go to.
        return is_turned_ ? Corners{at(0), at(2), at(1)} : Corners{at(0), at(1), at(2)};
    }

    /// Of those that are nearer than `out` says.
    void meet(const Vec3& origin, const Vec3& direction, Thickness& out) {
        const Vec3 inverse = direction.cwiseInverse();
        open_.assign(1, 0);
        while (!open_.empty()) {
            const int at = open_.back();
            open_.pop_back();
            const BvhNode& node = bvh_.nodes[static_cast<std::size_t>(at)];
            if (!(enters_at(origin, inverse, node) < out.distance)) continue;
            if (node.count == 0) {
                open_.push_back(node.first);
                open_.push_back(at + 1);
            }
            for (int i = node.first; i < node.first + node.count; ++i)
                if (const int t = bvh_.order[static_cast<std::size_t>(i)]; t != out.triangle)
                    if (const double distance = leaves_at(origin, direction, corners(t)); distance < out.distance)
                        out.distance = distance, out.opposite = t;
        }
    }

  private:
    const Points& points_;
    const std::vector<Triangle>& triangles_;
    Bvh bvh_;
    bool is_turned_ = false;
    std::vector<int> open_;
};

/// The normal alone, or with six more at 30 degrees about it: two rounded parts face each other on a narrow strip,
/// which normals of a coarse mesh all miss.
std::vector<Vec3> around(const Vec3& normal, Towards side) {
    std::vector<Vec3> out = {normal};
    if (side == Towards::inside) return out;
    const Vec3 across = normal.unitOrthogonal(), third = normal.cross(across);
    for (int k = 0; k < 6; ++k) {
        const double turn = k * std::numbers::pi / 3;
        out.push_back(std::sqrt(0.75) * normal + 0.5 * (std::cos(turn) * across + std::sin(turn) * third));
    }
    return out;
}

std::vector<Thickness> measured(const Points& points, const std::vector<Triangle>& triangles, std::size_t most,
                                Towards side) {
    std::vector<Thickness> out;
    if (triangles.empty() || most == 0) return out;
    Rays rays(points, triangles, side);
    const std::size_t count = std::min(most, triangles.size());
    for (std::size_t i = 0; i < count; ++i) {
        const int t = static_cast<int>(i * triangles.size() / count);
        const Corners c = rays.corners(t);
        const Vec3 normal = c.normal();
        const double area = normal.norm() / 2;
        if (!(area > 0)) continue;
        out.push_back({t, area, -1, infinite});
        for (const Vec3& direction : around(-normal / (2 * area), side))
            rays.meet((c.a + c.b + c.c) / 3, direction, out.back());
    }
    return out;
}

} // namespace

std::vector<Thickness> thickness(const Points& points, const std::vector<Triangle>& triangles, std::size_t most) {
    return measured(points, triangles, most, Towards::inside);
}

std::vector<Thickness> gaps(const Points& points, const std::vector<Triangle>& triangles, std::size_t most) {
    return measured(points, triangles, most, Towards::outside);
}

} // namespace sinew::solver
