// The place of a surface that is nearest to a point: a face, an edge or a vertex, found anew or followed from where it
// was. Following stays with the part of the surface where the point came in, however deep it is.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/contact/collision_body.h"

#include <functional>

namespace sinew::solver {

struct ClosestFeature {
    int triangle = -1;
    Vec3 place = Vec3::Zero(); ///< barycentric coordinates; zeros say that it is an edge or a vertex
    Vec3 away = Vec3::Zero();  ///< from the surface to the point [m]
    Vec3 normal =
        Vec3::Zero(); ///< outwards, of the face, or the mean of those about the edge or vertex; not of length 1
    bool inside() const { return away.dot(normal) < 0; }
};

/// Down from a triangle to the nearest place that has none nearer about it. `carriers` of the surface.
ClosestFeature follow_feature(const CollisionBody& surface, const double* carriers, int from_triangle, const Vec3& p);
/// The same where the point has moved far: along the way from `from` to `to`, both relative to where the surface is
/// now, in steps no longer than `step`.
ClosestFeature follow_feature(const CollisionBody& surface, const double* carriers, int from_triangle, const Vec3& from,
                              const Vec3& to, double step);
/// The nearest of all triangles that `allowed` does not refuse, up to a distance; triangle = -1 if there is none. Ties
/// go to the lower number. `boxes` were fitted to the same carriers.
ClosestFeature find_feature(const CollisionBody& surface, const double* carriers, const CollisionBoxes& boxes,
                            const Vec3& p, double max_distance, const std::function<bool(int)>* allowed = nullptr);
/// Unit normal of a triangle; zero if it has no area.
Vec3 face_normal(const CollisionBody& surface, const double* carriers, int triangle);

} // namespace sinew::solver
