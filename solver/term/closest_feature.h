// The place of a surface that is nearest to a point: a face, an edge or a vertex, found anew or followed from where it
// was. Following stays with the part of the surface where the point came in, however deep it is.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/carried_surface.h"

#include <utility>

namespace sinew::solver {

struct ClosestFeature {
    int triangle = -1;
    Vec3 place = Vec3::Zero(); ///< barycentric coordinates; zeros say that it is an edge or a vertex
    Vec3 away = Vec3::Zero();  ///< from the surface to the point [m]
    Vec3 normal =
        Vec3::Zero(); ///< outwards, of the face, or the mean of those about the edge or vertex; not of length 1
    bool inside() const { return away.dot(normal) < 0; }
};

/// Coordinates of what of p lies in the plane of a triangle, none exactly 0, which would mean a border; of one without
/// area those of its first corner.
Vec3 place_in_plane(const std::array<Vec3, 3>& corners, const Vec3& p);

/// Faces that look so far away from a side (the cosine) belong to another one, but for those that are nearer than
/// near_share of a mean edge: there a point slides around a sharp edge. Those that look back by as much always do.
constexpr double least_facing = 0.3, near_share = 0.5;

/// Down from a triangle to the nearest place that has none nearer about it, over faces that look to the same `side`
/// alone: a point that has passed the middle of a bone is not drawn to the far side of it. Zero: over all faces.
/// `places` of the surface's points. `allowed`: flags of the triangles that it may lie on, from_triangle among them;
/// null: all.
ClosestFeature follow_feature(const CarriedSurface& surface, const Points& places, int from_triangle, const Vec3& p,
                              const Vec3& side = Vec3::Zero(), const std::vector<char>* allowed = nullptr);
/// Where following begins: a feature, and in terms of two edges and the normal of its triangle, and so moving along
/// with it, the way from there to the point and the side that it looks to.
struct FeatureStart {
    ClosestFeature feature;
    Vec3 away = Vec3::Zero(), normal = Vec3::Zero();
};
/// `corners` of the feature's triangle when it was found.
FeatureStart start_of(const ClosestFeature& feature, const std::array<Vec3, 3>& corners);
/// One of start's directions, turned along with its triangle.
Vec3 turned_along(const CarriedSurface& surface, const Points& places, const FeatureStart& start,
                  const Vec3& in_triangle);
/// Where the point would be had it moved along with the surface.
Vec3 moved_along(const CarriedSurface& surface, const Points& places, const FeatureStart& start);
/// From where the point was at the start, moved along with the surface, straight to p, in steps so short that it does
/// not jump over faces, nor, where it ends deep inside, past an edge that it slides around: a function of where things
/// are now alone.
ClosestFeature follow_feature(const CarriedSurface& surface, const Points& places, const FeatureStart& start,
                              const Vec3& p, const std::vector<char>* allowed = nullptr);
/// The nearest place on triangles that are allowed, for a point that is beyond their rim: of those that one reaches
/// from `nearest`, the nearest feature of the whole surface, over triangles no farther from p than `known`, an allowed
/// feature. Where the rim turns inwards that is not always the one that `known` was followed to.
ClosestFeature nearest_allowed(const CarriedSurface& surface, const Points& places, const ClosestFeature& nearest,
                               const ClosestFeature& known, const Vec3& p, const std::vector<char>& allowed);
/// The nearest place of one triangle, and whether it is nearer than `nearest` is, to which it is put then. Of two that
/// are as near, the lower number wins.
struct NearestPlace {
    int triangle = -1;
    Vec3 place = Vec3::Zero(), point = Vec3::Zero();
    double distance2 = 0;
    void offer(const CarriedSurface& surface, const Points& places, int triangle, const Vec3& p);
};
/// That place as a feature.
ClosestFeature feature_of(const CarriedSurface& surface, const Points& places, const NearestPlace& nearest,
                          const Vec3& p);

/// The nearest of all triangles that `allowed` lets pass, up to a distance; triangle = -1 if there is none. `boxes`
/// were fitted to the same places.
template <class Allowed>
ClosestFeature find_feature(const CarriedSurface& surface, const SurfaceBoxes& boxes, const Vec3& p,
                            double max_distance, const Allowed& allowed, int guess = -1) {
    NearestPlace best;
    best.distance2 = max_distance * max_distance;
    const std::vector<BvhNode>& nodes = boxes.nodes();
    if (nodes.empty()) return {};
    if (guess >= 0 && allowed(guess)) best.offer(surface, boxes.places(), guess, p);
    int stack[128]; // the tree of 2^31 triangles is 30 levels deep
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const int n = stack[--depth];
        const BvhNode& node = nodes[at(n)];
        if (squared_distance(node, p) > best.distance2) continue;
        if (node.count > 0) {
            for (int i = node.first; i < node.first + node.count; ++i)
                if (const int t = surface.bvh().order[at(i)]; allowed(t)) best.offer(surface, boxes.places(), t, p);
            continue;
        }
        // The nearer child is looked at first.
        int one = n + 1, other = node.first;
        if (squared_distance(nodes[at(one)], p) < squared_distance(nodes[at(other)], p)) std::swap(one, other);
        stack[depth++] = one, stack[depth++] = other;
    }
    if (best.triangle < 0) return {};
    return feature_of(surface, boxes.places(), best, p);
}
inline ClosestFeature find_feature(const CarriedSurface& surface, const SurfaceBoxes& boxes, const Vec3& p,
                                   double max_distance) {
    return find_feature(surface, boxes, p, max_distance, [](int) { return true; });
}

/// Unit normal of a triangle; zero if it has no area.
Vec3 face_normal(const CarriedSurface& surface, const Points& places, int triangle);

} // namespace sinew::solver
