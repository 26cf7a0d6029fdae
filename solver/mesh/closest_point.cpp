// Closest point and winding number on a triangle surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/closest_point.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/mesh/coordinates.h"
#include "solver/mesh/far_field.h"
#include "solver/mesh/triangle_math.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sinew::solver {
namespace {

/// A node is taken from afar when its distance exceeds this many radii. With three terms the error of the
/// winding number stays below SurfaceTree::winding_error.
constexpr double far_ratio = 3;

} // namespace

struct SurfaceTree::Impl {
    std::vector<Triangle> triangles;
    std::vector<std::array<Vec3, 3>> corners;
    Bvh tree;
    std::vector<FarField> far;

    void build_far_fields();
    double exact_winding(const BvhNode& leaf, const Vec3& p) const {
        double sum = 0;
        for (int i = leaf.first; i < leaf.first + leaf.count; ++i) {
            const auto& c = corners[at(tree.order[at(i)])];
            sum += solid_angle(p, c[0], c[1], c[2]);
        }
        return sum / (4 * std::numbers::pi);
    }
    template <class Allowed>
    ClosestPoint closest(const Vec3& p, double max_distance, const Allowed& allowed) const;
    /// visit(leaf) for the leaves below nodes all of which opens(place of the node).
    template <class Opens, class Visit>
    void walk(const Opens& opens, const Visit& visit) const {
        int stack[64]; // the tree of 2^31 triangles is 30 levels deep
        int size = 0;
        stack[size++] = 0;
        while (size > 0) {
            const std::size_t n = at(stack[--size]);
            const BvhNode& node = tree.nodes[n];
            if (!opens(n)) continue;
            if (node.count > 0)
                visit(node);
            else
                stack[size++] = node.first, stack[size++] = static_cast<int>(n) + 1;
        }
    }
};

void SurfaceTree::Impl::build_far_fields() {
    far.resize(tree.nodes.size());
    struct Sums {
        double area = 0;
        Vec3 weighted = Vec3::Zero();
        int first = 0, last = 0; ///< range in tree.order
    };
    std::vector<Sums> sums(tree.nodes.size());
    // Children stand behind their parents, so one sweep from the back sees children first.
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
        const BvhNode& node = tree.nodes[n];
        if (node.count == 0) {
            const Sums &a = sums[n + 1], &b = sums[at(node.first)];
            sums[n] = {a.area + b.area, a.weighted + b.weighted, a.first, b.last};
        } else {
            sums[n].first = node.first, sums[n].last = node.first + node.count;
            for (int i = node.first; i < node.first + node.count; ++i) {
                const auto& c = corners[at(tree.order[at(i)])];
                const double area = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
                sums[n].area += area;
                sums[n].weighted += area * (c[0] + c[1] + c[2]) / 3;
            }
        }
        FarField& f = far[n];
        f.centre = sums[n].area > 0 ? Vec3(sums[n].weighted / sums[n].area) : Vec3(0.5 * (node.min + node.max));
        if (node.count == 0) {
            for (std::size_t child : {n + 1, at(node.first)}) f.add(far[child]);
        }
        double radius2 = 0;
        for (int i = sums[n].first; i < sums[n].last; ++i) {
            const auto& c = corners[at(tree.order[at(i)])];
            for (const Vec3& corner : c) radius2 = std::max(radius2, (corner - f.centre).squaredNorm());
            if (node.count > 0) f.add(c);
        }
        f.radius = std::sqrt(radius2);
    }
}

SurfaceTree::SurfaceTree(const Points& points, const std::vector<Triangle>& triangles)
    : impl_(std::make_unique<Impl>()) {
    impl_->triangles = triangles;
    impl_->corners.reserve(triangles.size());
    Points low, high;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (int v : triangles[t]) {
            if (v < 0 || at(v) >= points.size())
                throw Error("FE203", "triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " +
                                         std::to_string(points.size()));
            if (!is_within_reach(points[at(v)])) check_coordinates(points);
        }
        const Vec3 &a = points[at(triangles[t][0])], &b = points[at(triangles[t][1])], &c = points[at(triangles[t][2])];
        impl_->corners.push_back({a, b, c});
        low.push_back(a.cwiseMin(b).cwiseMin(c));
        high.push_back(a.cwiseMax(b).cwiseMax(c));
    }
    impl_->tree = build_bvh(low, high);
    impl_->build_far_fields();
}

SurfaceTree::~SurfaceTree() = default;
SurfaceTree::SurfaceTree(SurfaceTree&&) noexcept = default;

template <class Allowed>
ClosestPoint SurfaceTree::Impl::closest(const Vec3& p, double max_distance, const Allowed& allowed) const {
    ClosestPoint best;
    best.distance = std::numeric_limits<double>::infinity();
    if (tree.nodes.empty() || !p.allFinite()) return best;
    if (!is_within_reach(p)) // squared distances would overflow and find nothing where there is something
        throw Error("FE224", "a point that is looked for lies more than 1e60 from the origin");
    double best2 = max_distance * max_distance;
    struct Entry {
        int node;
        double distance2;
    };
    Entry stack[64]; // the tree of 2^31 triangles is 30 levels deep
    int size = 0;
    stack[size++] = {0, squared_distance(tree.nodes[0], p)};
    while (size > 0) {
        const Entry entry = stack[--size];
        // A hair of slack: boxes at the same distance must be opened, or a tie could miss its lowest
        // triangle.
        if (entry.distance2 * (1 - 1e-12) > best2) continue;
        const BvhNode& node = tree.nodes[at(entry.node)];
        if (node.count == 0) {
            const int children[2] = {entry.node + 1, node.first};
            const double d[2] = {squared_distance(tree.nodes[at(children[0])], p),
                                 squared_distance(tree.nodes[at(children[1])], p)};
            const int near = d[1] < d[0] ? 1 : 0;
            stack[size++] = {children[1 - near], d[1 - near]};
            stack[size++] = {children[near], d[near]};
            continue;
        }
        for (int i = node.first; i < node.first + node.count; ++i) {
            const int t = tree.order[at(i)];
            if (!allowed(t)) continue;
            const TrianglePoint candidate = closest_on_triangle(p, corners[at(t)], triangles[at(t)]);
            const double distance2 = (candidate.point - p).squaredNorm();
            if (distance2 < best2 || (distance2 == best2 && best.triangle >= 0 && t < best.triangle)) {
                best2 = distance2;
                best.triangle = t;
                best.point = candidate.point;
                best.barycentric = candidate.barycentric;
            }
        }
    }
    if (best.triangle >= 0) best.distance = std::sqrt(best2);
    return best;
}

ClosestPoint SurfaceTree::closest(const Vec3& p, double max_distance) const {
    return impl_->closest(p, max_distance, [](int) { return true; });
}

ClosestPoint SurfaceTree::closest(const Vec3& p, const std::vector<char>& allowed, double max_distance) const {
    if (allowed.size() != impl_->triangles.size())
        throw Error("FE204", std::to_string(allowed.size()) + " flags for " + std::to_string(impl_->triangles.size()) +
                                 " triangles");
    return impl_->closest(p, max_distance, [&](int t) { return allowed[at(t)] != 0; });
}

std::vector<double> SurfaceTree::distances(const Points& points, double most) const {
    std::vector<double> out;
    out.reserve(points.size());
    const auto ask_one_by_one = [&] {
        for (const Vec3& p : points) {
            const ClosestPoint nearest = closest(p, most);
            out.push_back(nearest.triangle >= 0 ? nearest.distance : most);
        }
        return out;
    };
    const bool is_within = std::all_of(points.begin(), points.end(), [](const Vec3& p) { return is_within_reach(p); });
    if (points.empty() || impl_->tree.nodes.empty() || !is_within) return ask_one_by_one();
    Vec3 low = points[0], high = points[0];
    for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Vec3 middle = 0.5 * (low + high);
    double radius2 = 0;
    for (const Vec3& p : points) radius2 = std::max(radius2, (p - middle).squaredNorm());
    // A little more, so that rounding leaves none out.
    const double reach = (std::sqrt(radius2) + most) * (1 + 1e-6), reach2 = reach * reach;
    const auto distance2 = [&](const Vec3& p, int t) {
        return (closest_on_triangle(p, impl_->corners[at(t)], impl_->triangles[at(t)]).point - p).squaredNorm();
    };
    struct Near {
        double distance; ///< from the middle
        int triangle;
    };
    std::vector<Near> near;
    impl_->walk([&](std::size_t n) { return squared_distance(impl_->tree.nodes[n], middle) <= reach2; },
                [&](const BvhNode& leaf) {
                    for (int i = leaf.first; i < leaf.first + leaf.count; ++i)
                        if (const double d2 = distance2(middle, impl_->tree.order[at(i)]); d2 <= reach2)
                            near.push_back({std::sqrt(d2), impl_->tree.order[at(i)]});
                });
    constexpr std::size_t several = 64; // of more, the tree leaves most out
    if (near.size() > several) return ask_one_by_one();
    std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.triangle < b.triangle;
    });
    for (const Vec3& p : points) {
        const double from_middle = (p - middle).norm() * (1 + 1e-6);
        double best2 = most * most, best = most;
        for (const Near& n : near) {
            if (n.distance * (1 - 1e-6) - from_middle > best) break; // and the others are no nearer
            if (const double d2 = distance2(p, n.triangle); d2 < best2) best2 = d2, best = std::sqrt(d2);
        }
        out.push_back(best);
    }
    return out;
}

std::vector<int> SurfaceTree::all_closest(const Vec3& p, double slack) const {
    const ClosestPoint nearest = closest(p);
    std::vector<int> found;
    if (nearest.triangle < 0) return found;
    const double reach2 = (nearest.distance + slack) * (nearest.distance + slack);
    impl_->walk([&](std::size_t n) { return squared_distance(impl_->tree.nodes[n], p) <= reach2; },
                [&](const BvhNode& leaf) {
                    for (int i = leaf.first; i < leaf.first + leaf.count; ++i) {
                        const int t = impl_->tree.order[at(i)];
                        const Vec3 place = closest_on_triangle(p, impl_->corners[at(t)], impl_->triangles[at(t)]).point;
                        if ((place - p).squaredNorm() <= reach2) found.push_back(t);
                    }
                });
    std::sort(found.begin(), found.end());
    return found;
}

double SurfaceTree::winding_number(const Vec3& p) const {
    if (impl_->tree.nodes.empty() || !p.allFinite()) return 0;
    double sum = 0;
    impl_->walk(
        [&](std::size_t n) {
            const FarField& f = impl_->far[n];
            if (!((p - f.centre).squaredNorm() > far_ratio * far_ratio * f.radius * f.radius)) return true;
            sum += f.winding(p);
            return false;
        },
        [&](const BvhNode& leaf) { sum += impl_->exact_winding(leaf, p); });
    return sum;
}

std::vector<double> SurfaceTree::winding_numbers(const Points& points) const {
    const Bvh& tree = impl_->tree;
    const bool is_finite = std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
    if (tree.nodes.empty() || points.empty() || !is_finite) {
        std::vector<double> result;
        for (const Vec3& p : points) result.push_back(winding_number(p));
        return result;
    }
    Vec3 low = points[0], high = points[0];
    for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Vec3 middle = 0.5 * (low + high);
    double radius2 = 0;
    for (const Vec3& p : points) radius2 = std::max(radius2, (p - middle).squaredNorm());
    const double radius = std::sqrt(radius2);
    WindingSums sums(points);
    impl_->walk(
        [&](std::size_t n) {
            const FarField& f = impl_->far[n];
            if (!((middle - f.centre).norm() - radius > far_ratio * f.radius)) return true;
            sums.add(f);
            return false;
        },
        [&](const BvhNode& leaf) {
            for (int i = leaf.first; i < leaf.first + leaf.count; ++i) sums.add(impl_->corners[at(tree.order[at(i)])]);
        });
    return sums.finish();
}

bool SurfaceTree::inside(const Vec3& p) const {
    const double fast = winding_number(p);
    return (std::abs(fast - 0.5) > winding_error ? fast : winding_number_exact(p)) > 0.5;
}

bool SurfaceTree::inside_either_way(const Vec3& p) const {
    const double fast = winding_number(p);
    const bool is_clear = std::abs(std::abs(fast) - 0.5) > winding_error;
    return std::abs(is_clear ? fast : winding_number_exact(p)) > 0.5;
}

double SurfaceTree::winding_number_exact(const Vec3& p) const {
    double sum = 0;
    for (const auto& c : impl_->corners) sum += solid_angle(p, c[0], c[1], c[2]);
    return sum / (4 * std::numbers::pi);
}

} // namespace sinew::solver
