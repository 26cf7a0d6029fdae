// Graded body-centred points inside a surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/inner_points.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace sinew::solver {
namespace {

/// Mean length of the edges at each vertex.
std::vector<double> vertex_edges(const Points& points, const std::vector<Triangle>& triangles) {
    std::vector<double> sum(points.size(), 0), count(points.size(), 0);
    for (const Triangle& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            const double length = (points[at(a)] - points[at(b)]).norm();
            for (const int v : {a, b}) sum[at(v)] += length, count[at(v)] += 1;
        }
    for (std::size_t v = 0; v < sum.size(); ++v) sum[v] /= std::max(count[v], 1.0);
    return sum;
}

class Octree {
  public:
    Octree(const Points& points, const std::vector<Triangle>& triangles, double growth, std::size_t most,
           const MeshingControl& control)
        : triangles_(triangles)
        , edge_(vertex_edges(points, triangles))
        , tree_(points, triangles)
        , growth_(growth)
        , most_(most)
        , control_(control) {
        // Leaves of the median size come out right: the sizes of the others are halves and doubles of it.
        std::vector<double> sizes;
        for (const Triangle& t : triangles) sizes.push_back((edge_[at(t[0])] + edge_[at(t[1])] + edge_[at(t[2])]) / 3);
        std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
        const double leaf = cube_per_edge * sizes[sizes.size() / 2];
        const Box box = bounding_box(points);
        const double wide = box.size().maxCoeff();
        side_ = leaf;
        while (side_ < 1.01 * wide) side_ *= 2;
        corner_ = box.centre() - Vec3::Constant(0.5 * side_);
    }

    InnerPoints make() {
        visit(0, {0, 0, 0}, 0, 1);
        return std::move(found_);
    }

  private:
    /// A body-centred lattice of cubes of side a has edges a and 0.87 a.
    static constexpr double cube_per_edge = 1.1;
    static constexpr int deepest = 19;
    using Key = std::array<std::int64_t, 3>; ///< in units of half the smallest possible leaf

    Vec3 position(const Key& k) const {
        return corner_ + side_ / static_cast<double>(std::int64_t{1} << (deepest + 1)) *
                             Vec3(static_cast<double>(k[0]), static_cast<double>(k[1]), static_cast<double>(k[2]));
    }
    double edge_at(const ClosestPoint& c) const {
        const Triangle& t = triangles_[at(c.triangle)];
        return c.barycentric[0] * edge_[at(t[0])] + c.barycentric[1] * edge_[at(t[1])] +
               c.barycentric[2] * edge_[at(t[2])];
    }

    /// A cube at `level` below the root, by its lowest corner. `from` and `to`: progress.
    void visit(int level, const Key& low, double from, double to) {
        if (level < 4) {
            if (control_.stop && control_.stop()) throw Stopped();
            if (control_.progress) control_.progress(from, "placing inner points");
        }
        const std::int64_t half = std::int64_t{1} << (deepest - level), whole = 2 * half;
        const Key middle{low[0] + half, low[1] + half, low[2] + half};
        const Vec3 c = position(middle);
        const double side = std::ldexp(side_, -level), radius = 0.5 * std::sqrt(3.0) * side;
        const ClosestPoint near = tree_.closest(c);
        if (near.distance > radius && !tree_.inside(c)) return;
        if (side > 1.0001 * cube_per_edge * (edge_at(near) + growth_ * near.distance) && level < deepest) {
            for (int k = 0; k < 8; ++k)
                visit(level + 1, {low[0] + half * (k & 1), low[1] + half * (k >> 1 & 1), low[2] + half * (k >> 2)},
                      from + (to - from) * k / 8, from + (to - from) * (k + 1) / 8);
            return;
        }
        for (int k = 0; k < 8; ++k)
            take({low[0] + whole * (k & 1), low[1] + whole * (k >> 1 & 1), low[2] + whole * (k >> 2)});
        take(middle);
    }

    void take(const Key& k) {
        const std::uint64_t number = static_cast<std::uint64_t>(k[0]) << 42 | static_cast<std::uint64_t>(k[1]) << 21 |
                                     static_cast<std::uint64_t>(k[2]);
        if (!seen_.insert(number).second) return;
        const Vec3 p = position(k);
        const ClosestPoint near = tree_.closest(p);
        if (near.distance < 0.55 * edge_at(near) || !tree_.inside(p)) return;
        if (found_.points.size() == most_)
            throw Error("FE232", "the tets would need more than " + std::to_string(most_) + " vertices inside",
                        "Choose a smaller refinementQuality, or a coarser surface.");
        found_.points.push_back(p);
        found_.edges.push_back(edge_at(near) + growth_ * near.distance);
    }

    const std::vector<Triangle>& triangles_;
    std::vector<double> edge_;
    SurfaceTree tree_;
    double growth_;
    std::size_t most_;
    const MeshingControl& control_;
    double side_ = 1;
    Vec3 corner_ = Vec3::Zero();
    std::unordered_set<std::uint64_t> seen_;
    InnerPoints found_;
};

} // namespace

InnerPoints inner_points(const Points& points, const std::vector<Triangle>& triangles, double growth, std::size_t most,
                         const MeshingControl& control) {
    return Octree(points, triangles, growth, most, control).make();
}

} // namespace sinew::solver
