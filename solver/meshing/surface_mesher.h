// Delaunay refinement of a level set: the one place that knows CGAL's surface mesher.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <functional>

namespace sinew::solver {

/// What `field` throws to end a refinement that has no end; comes out of mesh_level_set with the place where
/// vertices are densest.
struct Endless {
    Vec3 densest = Vec3::Zero();
};

struct SurfaceMesherInput {
    std::function<double(const Vec3&)> field; ///< negative inside; may throw, which ends the meshing
    std::function<void()> watch;              ///< called now and then while the field is not; may throw
    Points seeds;                             ///< points on the level set, about one a triangle's size apart
    Vec3 inside = Vec3::Zero();               ///< a point with field < 0
    double reach = 1;                         ///< everything lies within this distance of `inside`
    double least_angle = 30;                  ///< degrees; refinement may not end above 30
    double radius = 1;                        ///< upper bound of a triangle's Delaunay ball
    double distance = 0.1;   ///< upper bound from a triangle's circumcentre to the ball's centre on the surface
    bool is_manifold = true; ///< refine until every edge has two triangles and every vertex one fan
};

struct SurfaceMesherOutput {
    Points points;
    std::vector<Triangle> triangles; ///< facing outwards, alike over edges with two triangles
    std::vector<int> vertex_of_seed; ///< -1: the seed is no corner of a triangle
};

/// Boissonnat and Oudot's refinement, by CGAL 5.5: the triangles of the points' Delaunay triangulation whose
/// dual edges the surface crosses, refined until all criteria hold. The same bits on every run.
SurfaceMesherOutput mesh_level_set(const SurfaceMesherInput& input);

} // namespace sinew::solver
