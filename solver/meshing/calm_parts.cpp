// Parts of a closed surface that nothing else comes near to.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/calm_parts.h"

#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/meshing/leaf_corners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace sinew::solver {
namespace {

/// How much wider than they are the prism and the ways to the edges are taken, in barycentric coordinates and in steps.
/// Far above rounding: what could be off by a tenth of it counts as near.
constexpr double wider_across = 1e-4, wider_up = 1e-2;
/// Rounding errors are a few times smaller than this, relatively.
constexpr double rounding = 1e-15;

/// Barycentric coordinates of a point's foot in a triangle's plane, and how many steps it lies above.
using Local = Eigen::Vector4d;

/// Corners of a triangle.
using Seen = std::array<Local, 3>;

/// A convex polygon that half-spaces cut down.
class Polygon {
  public:
    explicit Polygon(const Seen& triangle) { std::ranges::copy(triangle, corner_.begin()); }
    bool is_empty() const { return size_ == 0; }

    /// Keeps what lies where `inner`, which is linear, is not negative.
    template <class Inner>
    Polygon& cut(const Inner& inner) {
        std::array<double, capacity> depth;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size_; ++i) kept += (depth[i] = inner(corner_[i])) >= 0;
        if (kept == size_) return *this;
        if (kept == 0) {
            size_ = 0;
            return *this;
        }
        std::array<Local, capacity> before;
        std::copy_n(corner_.begin(), size_, before.begin());
        const std::size_t count = std::exchange(size_, 0);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t next = i + 1 < count ? i + 1 : 0;
            if (depth[i] >= 0) add(before[i]);
            if ((depth[i] >= 0) != (depth[next] >= 0))
                add(before[i] + depth[i] / (depth[i] - depth[next]) * (before[next] - before[i]));
        }
        return *this;
    }

  private:
    static constexpr std::size_t capacity = 16; // each half-space adds one corner at most, but for rounding
    void add(const Local& corner) {
        if (size_ < capacity) corner_[size_++] = corner;
    }
    std::array<Local, capacity> corner_;
    std::size_t size_ = 3;
};

/// A triangle with the space beside it.
class Surroundings {
  public:
    /// `extent`: no two points of the surface are farther apart.
    Surroundings(const Points& points, const Triangle& triangle, const Neighbourhood& near, double extent)
        : origin_(points[at(triangle[0])])
        , step_(near.step) {
        const Vec3 u = points[at(triangle[1])] - origin_, v = points[at(triangle[2])] - origin_;
        const Vec3 normal = u.cross(v);
        twice_area_ = normal.norm();
        longest_ = std::max({u.norm(), v.norm(), (u - v).norm()});
        double farthest = 0;
        for (const int c : triangle) farthest = std::max(farthest, points[at(c)].cwiseAbs().maxCoeff());
        is_known_ = !near.places.empty() && twice_area_ > 0 && step_ > 0 && near_enough(longest_) &&
                    rounding * farthest < 0.1 * wider_up * step_;
        if (!is_known_) return;
        all_near_enough_ = near_enough(extent);
        const Vec3 up = normal / twice_area_;
        towards_second_ = v.cross(up) / twice_area_;
        towards_third_ = up.cross(u) / twice_area_;
        up_ = up / step_;
        low_ = high_ = origin_;
        for (const int c : triangle) {
            low_ = low_.cwiseMin(points[at(c)]);
            high_ = high_.cwiseMax(points[at(c)]);
        }
        const Vec3 margin = Vec3::Constant(1.1 * step_);
        low_ -= margin, high_ += margin;
        for (const Vec3& p : near.places) least_ = least_.cwiseMin(local(p).head<3>());
    }

    bool is_known() const { return is_known_; }
    const Vec3& low() const { return low_; }
    const Vec3& high() const { return high_; }

    /// Whether points so far away keep enough digits in local coordinates.
    bool near_enough(double distance) const {
        const double across = rounding * distance * longest_ / twice_area_;
        return across < 0.1 * wider_across && across * longest_ < 0.1 * wider_up * step_;
    }

    /// A triangle as seen from here; nothing where that is not known well enough.
    std::optional<Seen> seen(const std::array<Vec3, 3>& corners) const {
        for (const Vec3& c : corners)
            if (!all_near_enough_ && !near_enough((c - origin_).norm())) return {};
        return Seen{local(corners[0]), local(corners[1]), local(corners[2])};
    }

    /// Of four triangles those that lie beyond one of the edges, and of lines through its ends that are turned a
    /// little: they meet neither prism nor ways. In fans of long triangles, whose boxes all meet, these are nearly all.
    std::array<bool, 4> are_beyond(const LeafCorners& corners, const BvhNode& leaf) const {
        using Four = LeafCorners::Four;
        std::array<std::array<Four, 3>, 3> place; // of each corner
        for (std::size_t c = 0; c < 3; ++c) {
            const Four x = corners.four(leaf, c, 0) - origin_.x(), y = corners.four(leaf, c, 1) - origin_.y(),
                       z = corners.four(leaf, c, 2) - origin_.z();
            place[c][1] = towards_second_.x() * x + towards_second_.y() * y + towards_second_.z() * z;
            place[c][2] = towards_third_.x() * x + towards_third_.y() * y + towards_third_.z() * z;
            place[c][0] = 1 - place[c][1] - place[c][2];
        }
        const auto farthest = [&](std::size_t k) -> Four { return place[0][k].max(place[1][k]).max(place[2][k]); };
        const auto farthest_turned = [&](std::size_t k, std::size_t end) -> Four {
            const auto turned = [&](std::size_t c) -> Four { return place[c][k] + turn * place[c][end]; };
            return turned(0).max(turned(1)).max(turned(2));
        };
        std::array<bool, 4> result{};
        for (std::size_t k = 0; k < 3 && all_near_enough_; ++k) {
            const double least = std::min(least_[static_cast<int>(k)] - wider_across, least_end);
            const Four one = farthest_turned(k, (k + 1) % 3), other = farthest_turned(k, (k + 2) % 3);
            const auto beyond = (farthest(k) < least && one.min(other) < least_turned).eval();
            for (std::size_t i = 0; i < 4; ++i) result[i] = result[i] || beyond[static_cast<int>(i)];
        }
        return result;
    }

    /// Whether a triangle comes between the places.
    bool meets_prism(const Seen& triangle) const {
        const auto is_beyond = [&](const auto& inner) { return std::ranges::none_of(triangle, inner); };
        // Most are told apart by one half-space.
        const double reach = 1 + wider_up;
        for (int k = 0; k < 3; ++k)
            if (is_beyond([&](const Local& l) { return l[k] >= least_[k] - wider_across; })) return false;
        if (is_beyond([&](const Local& l) { return l[3] <= reach; })) return false;
        if (is_beyond([&](const Local& l) { return l[3] >= -reach; })) return false;
        Polygon rest(triangle);
        for (int k = 0; k < 3; ++k) rest.cut([&](const Local& l) { return l[k] - least_[k] + wider_across; });
        rest.cut([&](const Local& l) { return reach - l[3]; }).cut([&](const Local& l) { return reach + l[3]; });
        return !rest.is_empty();
    }

    /// Whether a triangle touches the way from the middle to that of the edge opposite corner k.
    static bool meets_way(const Seen& triangle, int k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const auto is_beyond = [&](const auto& inner) { return std::ranges::none_of(triangle, inner); };
        for (const int end : {i, j})
            if (is_beyond([&](const Local& l) { return l[end] >= least_end; }) ||
                is_beyond([&](const Local& l) { return l[k] + turn * l[end] >= least_turned; }))
                return false;
        if (is_beyond([&](const Local& l) { return l[3] <= wider_up; })) return false;
        if (is_beyond([&](const Local& l) { return l[3] >= -wider_up; })) return false;
        Polygon rest(triangle);
        rest.cut([&](const Local& l) { return l[k] + wider_across; })
            .cut([&](const Local& l) { return 1.0 / 3 + wider_across - l[k]; })
            .cut([&](const Local& l) { return l[i] - l[j] + wider_across; })
            .cut([&](const Local& l) { return l[j] - l[i] + wider_across; })
            .cut([](const Local& l) { return wider_up - l[3]; })
            .cut([](const Local& l) { return wider_up + l[3]; });
        return !rest.is_empty();
    }

  private:
    /// On the way to an edge the coordinates of the edge's ends are a third or more. So it lies inwards of lines
    /// through the ends, too, that are turned a little.
    static constexpr double least_end = 0.3, turn = 0.01, least_turned = 0.003;

    Local local(const Vec3& p) const {
        const Vec3 d = p - origin_;
        const double second = towards_second_.dot(d), third = towards_third_.dot(d);
        return {1 - second - third, second, third, up_.dot(d)};
    }

    Vec3 origin_, up_, towards_second_, towards_third_, low_, high_;
    Vec3 least_ = Vec3::Constant(1); ///< barycentric coordinates that the places have
    double step_, twice_area_ = 0, longest_ = 0;
    bool is_known_ = false, all_near_enough_ = false;
};

/// What is known of a triangle: whether it is calm, and across which edges the way is free.
struct Calm {
    bool is_calm = false;
    std::array<bool, 3> is_free{};
};

} // namespace

std::vector<std::array<int, 3>> find_neighbours(const std::vector<Triangle>& triangles) {
    struct Side {
        int low, high, triangle, edge;
        bool is_rising;
    };
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = triangles[t][(k + 1) % 3], b = triangles[t][(k + 2) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), static_cast<int>(k), a < b});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::array{a.low, a.high, a.triangle, a.edge} < std::array{b.low, b.high, b.triangle, b.edge};
    });
    std::vector<std::array<int, 3>> result(triangles.size(), {-1, -1, -1});
    for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
        while (end < sides.size() && sides[end].low == sides[first].low && sides[end].high == sides[first].high) ++end;
        if (end - first != 2 || sides[first].is_rising == sides[first + 1].is_rising) continue;
        const Side &one = sides[first], &other = sides[first + 1];
        result[at(one.triangle)][at(one.edge)] = other.triangle;
        result[at(other.triangle)][at(other.edge)] = one.triangle;
    }
    return result;
}

std::vector<int> calm_parts(const Points& points, const std::vector<Triangle>& triangles,
                            const std::function<Neighbourhood(std::size_t)>& neighbourhood, const MeshingPhase& phase) {
    const auto corners = [&](std::size_t t) {
        const Triangle& c = triangles[t];
        return std::array<Vec3, 3>{points[at(c[0])], points[at(c[1])], points[at(c[2])]};
    };
    Points low, high, normals;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto [a, b, c] = corners(t);
        low.push_back(a.cwiseMin(b).cwiseMin(c));
        high.push_back(a.cwiseMax(b).cwiseMax(c));
        normals.push_back((b - a).cross(c - a).normalized());
    }
    const Bvh tree = build_bvh(low, high);
    const LeafCorners leaf_corners(tree, points, triangles);
    const double extent = tree.nodes.empty() ? 0 : (tree.nodes[0].max - tree.nodes[0].min).norm();
    const std::vector<std::array<int, 3>> neighbours = find_neighbours(triangles);

    std::vector<Calm> calm(triangles.size());
    phase.run(triangles.size(), 16, [&](std::size_t t) {
        const Surroundings here(points, triangles[t], neighbourhood(t), extent);
        if (!here.is_known()) return;
        Calm& found = calm[t];
        found.is_calm = true;
        for (std::size_t k = 0; k < 3; ++k) found.is_free[k] = neighbours[t][k] >= 0;
        const auto look_at = [&](int other) {
            const std::size_t o = at(other);
            if (o == t || (low[o].array() > here.high().array()).any() || (high[o].array() < here.low().array()).any())
                return;
            const auto seen = here.seen(corners(o));
            found.is_calm = seen && !here.meets_prism(*seen);
            for (int k = 0; k < 3 && found.is_calm; ++k)
                if (found.is_free[at(k)] && neighbours[t][at(k)] != other)
                    found.is_free[at(k)] = !Surroundings::meets_way(*seen, k);
        };
        visit_leaves_near(tree, here.low(), here.high(), [&](const BvhNode& leaf) {
            const std::array<bool, 4> are_beyond = here.are_beyond(leaf_corners, leaf);
            for (int i = 0; i < leaf.count && found.is_calm; ++i)
                if (!are_beyond[at(i)]) look_at(tree.order[at(leaf.first + i)]);
            return found.is_calm;
        });
    });

    std::vector<int> part(triangles.size(), -1);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (calm[t].is_calm) part[t] = static_cast<int>(t);
    const auto root = [&](int i) {
        while (part[at(i)] != i) i = part[at(i)] = part[at(part[at(i)])];
        return i;
    };
    const auto is_free_to = [&](std::size_t from, int to) {
        for (std::size_t k = 0; k < 3; ++k)
            if (neighbours[from][k] == to && !calm[from].is_free[k]) return false;
        return true;
    };
    constexpr double folded = -0.999; // cosine of the angle between normals
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (const int other : neighbours[t]) {
            if (other < static_cast<int>(t) || !calm[t].is_calm || !calm[at(other)].is_calm) continue;
            if (!is_free_to(t, other) || !is_free_to(at(other), static_cast<int>(t))) continue;
            if (!(normals[t].dot(normals[at(other)]) > folded)) continue;
            const int a = root(static_cast<int>(t)), b = root(other);
            part[at(std::max(a, b))] = std::min(a, b);
        }
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (part[t] >= 0) part[t] = root(static_cast<int>(t));
    return part;
}

} // namespace sinew::solver
