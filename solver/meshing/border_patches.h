// The border of a layer in smooth parts, each of which goes on beyond its own edge: what tets are split along.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/triangle_finder.h"

namespace sinew::solver {

/// The corners of a flat part of a tet, in its barycentric coordinates.
using BarycentricPolygon = std::vector<Barycentric>;

/// Triangles of a solid that join without a crease.
class BorderPatch {
  public:
    BorderPatch(const Solid& solid, std::vector<int> triangles);
    /// Height above the plane of the closest triangle, which goes on where the patch ends; the mean of several that are
    /// equally near.
    double height(const Vec3& p) const;
    /// Unit normal of the closest triangle, or the mean direction of those of several.
    Vec3 normal(const Vec3& p) const;
    /// Where between a and b, 0 to 1, the height is zero. Those at a and b have opposite signs.
    double crossing(const Vec3& a, const Vec3& b) const;
    /// Triangles of the solid that are of the patch and touch the tet.
    std::vector<int> touching(const std::array<Vec3, 4>& corners) const { return finder_.touching(corners); }
    /// The part of one of them that lies in the tet; empty where there is none.
    BarycentricPolygon part_in_tet(const std::array<Vec3, 4>& corners, int triangle) const;

  private:
    std::vector<int> nearest_to(const Vec3& p) const;
    const Solid* solid_;
    std::vector<int> triangles_;
    SurfaceTree tree_;
    TriangleFinder finder_;
};

/// The surface of a solid, cut apart where it bends by more than 50 degrees; without what lies inside of it where parts
/// overlap. A surface with more than 24 parts, which is rough rather than creased, is one.
std::vector<BorderPatch> border_patches(const Solid& solid);

} // namespace sinew::solver
