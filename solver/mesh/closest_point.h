// Closest point and inside tests on a triangle surface, by a bounding volume hierarchy in double precision.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <memory>
#include <vector>

namespace sinew::solver {

struct ClosestPoint {
    int triangle = -1;
    Vec3 point = Vec3::Zero();
    Vec3 barycentric = Vec3::Zero(); ///< of the triangle's corners
    double distance = 0;             ///< infinite if there is none
};

/// Immutable; queries are thread-safe and depend on the input alone. A query that is not finite finds
/// nothing; with a finite one the closest point of a tree that is not empty is always found.
class SurfaceTree {
  public:
    /// Throws Error FE202, FE203, FE224.
    SurfaceTree(const Points& points, const std::vector<Triangle>& triangles);
    ~SurfaceTree();
    SurfaceTree(SurfaceTree&&) noexcept;
    /// `max_distance`: search radius; triangle = -1 if nothing is nearer. Ties go to the lowest triangle
    /// index. Throws Error FE224 for a finite point beyond largest_coordinate.
    ClosestPoint closest(const Vec3& p, double max_distance = 1e300) const;
    /// The same, over triangles whose `allowed` flag is set. Throws Error FE204 if the count differs.
    ClosestPoint closest(const Vec3& p, const std::vector<char>& allowed, double max_distance = 1e300) const;
    /// Distances at points that lie together; `most` where the surface is not nearer. As by `closest`, but what is near
    /// of any of the points is looked for once.
    std::vector<double> distances(const Points& points, double most) const;
    /// All triangles that come as near as the closest one, but for `slack`, in increasing order.
    std::vector<int> all_closest(const Vec3& p, double slack) const;
    /// Generalised winding number (Jacobson 2013, fast version Barill 2018): about 1 inside, 0 outside; works
    /// on soups. Error below `winding_error`.
    double winding_number(const Vec3& p) const;
    /// Bound of the error of winding_number; the worst measured on 106 meshes, whole, torn and with triangles
    /// turned at random, is 0.0016.
    static constexpr double winding_error = 0.005;
    /// The same for points that lie together, several times faster: what is far is decided once for all.
    std::vector<double> winding_numbers(const Points& points) const;
    /// The same by summing every triangle: slow, error near rounding.
    double winding_number_exact(const Vec3& p) const;
    /// Whether the winding number exceeds one half; summed exactly where the fast one cannot tell.
    bool inside(const Vec3& p) const;
    /// Whether its size does: for surfaces whose parts may be turned inside out.
    bool inside_either_way(const Vec3& p) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sinew::solver
