// The surface that an attachment slides on, and the height of points over it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/closest_feature.h"
#include "solver/term/point_triangle.h"
#include "solver/term/surface_hessian.h"

#include <optional>

namespace sinew::solver {

/// How far a point is above a surface, below it less than 0, and where that is measured: along a unit normal from a
/// place of a triangle, which may lie beyond its corners.
struct Height {
    double value = 0; ///< [m]
    int triangle = -1;
    Vec3 place = Vec3::Zero(), normal = Vec3::Zero();
};

/// A face, edge or vertex, by the corners of a triangle that carry it.
struct Feature {
    int triangle = -1;
    std::array<bool, 3> on{};
    bool inside = false; ///< the point is below the surface there
    bool rim = false;    ///< of an open surface
    friend bool operator==(const Feature&, const Feature&) = default;
};

class SlidingTarget {
  public:
    SlidingTarget(const Scene& scene, int body);
    const CarriedSurface& surface() const { return surface_; }
    /// Of a target that deforms.
    SurfaceHessian& hessian() { return *hessian_; }
    const SurfaceHessian& hessian() const { return *hessian_; }
    /// Flags of the triangles that may be slid on, by the painted map of an attachment's target; empty: all. Throws
    /// Error FE204, FE240.
    std::vector<char> allowed(const Scene& scene, const AttachmentRest& attachment) const;

    /// Vertices that carry the triangles which share a corner with this one, each once, sorted. Found when it is first
    /// asked for, and kept.
    const std::vector<int>& carriers_about(int triangle) const;

    /// Takes where the points are.
    void place(const double* carriers);
    const Points& places() const { return places_; }
    Feature feature_of(const ClosestFeature& nearest) const;
    /// The place nearest to p on the feature's plane, line or vertex, which go on beyond it.
    ClosestFeature place_on(const Feature& feature, const Vec3& p) const;
    /// Over the nearest feature of the whole surface: a face goes on beyond its border, an edge or a vertex stands for
    /// all faces about it, or with `alone` for itself. Alone it is smooth over faces that turn inwards, about them not
    /// where the point comes through the surface: there the distance has a cone. Over the rim of an open surface it is
    /// that over the plane of the triangle at the rim.
    Height height_over(const Feature& nearest, const Vec3& p, bool alone) const;
    /// Second derivatives of the height times the height, by the point and the corners; 0 where it is too small to
    /// tell. `project`: of them a part that is positive semi-definite.
    PointTriangleBlocks bend(const Height& h, bool project) const;

  private:
    bool on_rim(int triangle, const Vec3& place) const;
    CarriedSurface surface_;
    std::optional<SurfaceHessian> hessian_;
    bool is_open_;
    mutable std::vector<std::vector<int>> carriers_about_; ///< of triangles; empty: not asked for yet
    Points places_;
};

} // namespace sinew::solver
