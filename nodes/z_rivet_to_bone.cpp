// zRivetToBone: chosen points of a curve ride on a bone, or move by a matrix.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/limits.h"
#include "nodes/matrices.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/coordinates.h"
#include "solver/terms/attachment/ride_on_bone.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<CurvePoints> curve{
    .name = "curve",
    .doc = "The curve, from curve.outCurve or from another zRivetToBone.",
};
const Input<double> envelope{
    .name = "envelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "How far the points follow: 0 leaves them where the curve has them, 1 takes them along.",
};
const Input<NumberList> cv_indices{
    .name = "cvIndices",
    .limits = within_reach,
    .doc = "The points that follow, counted from 0; none: all of them.",
};
const Wire<Body> bone{
    .name = "bone",
    .doc = "The bone that they follow. A point keeps its place beside the face of the bone that is nearest to it where "
           "both are modelled, and turns with that face; so it moves as a rigid bone does, exactly.",
    .required = false,
};
const Wire<Mesh> bone_as_modelled{
    .name = "boneAsModelled",
    .doc = "The bone's mesh where the curve was drawn. Needed where zBone.mesh itself moves; a bone that its matrix "
           "moves is known as it is modelled.",
    .required = false,
};
const Input<Matrix4> matrix{
    .name = "matrix",
    .def = identity_matrix,
    .limits = within_reach,
    .doc = "Moves the points instead of a bone; connect transform.outMatrix.",
};
const Output<CurvePoints> out_curve{
    .name = "outCurve",
    .doc = "The curve with its points moved, for zLineOfAction.curves or another zRivetToBone.",
};

/// Triangles flatter than this have no direction to turn with: height over longest edge.
constexpr double flat = 1e-6;

std::vector<std::size_t> chosen_points(const Reads& in, std::size_t count) {
    std::vector<std::size_t> out;
    for (const double index : in[cv_indices]) {
        char text[32];
        std::snprintf(text, sizeof text, "%g", index);
        if (!(index >= 0 && index < static_cast<double>(count)) || index != std::floor(index))
            in.fail(cv_indices.name, "FE283",
                    in.source_name(curve.name) + " has no point " + text + "; its " + std::to_string(count) +
                        " points count from 0 to " + std::to_string(count - 1),
                    "List points that the curve has.");
        out.push_back(static_cast<std::size_t>(index));
    }
    if (!out.empty()) return out;
    for (std::size_t i = 0; i < count; ++i) out.push_back(i);
    return out;
}

/// Where points are bound to a bone: one anchor a chosen point, and which of them lie far off.
struct Bound {
    std::vector<solver::Anchor> anchors;
    double farthest = 0, size = 0; ///< scene units: from the bone's surface; of the bone
    std::size_t farthest_point = 0;
};

Bound bind_points(const Mesh& modelled, const solver::Points& points, const std::vector<std::size_t>& chosen) {
    const solver::Points& surface = *modelled.points;
    const std::vector<solver::Triangle>& triangles = modelled.topology->triangles;
    const solver::SurfaceTree tree(surface, triangles);
    std::vector<char> allowed;
    for (const solver::Triangle& t : triangles) {
        const auto p = [&](std::size_t i) -> const solver::Vec3& { return surface[static_cast<std::size_t>(t[i])]; };
        const solver::Vec3 a = p(1) - p(0), b = p(2) - p(0), c = p(2) - p(1);
        const double longest = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
        allowed.push_back(a.cross(b).norm() > flat * longest);
    }
    Bound out;
    out.size = solver::bounding_box(surface).size().norm();
    for (const std::size_t i : chosen) {
        const solver::ClosestPoint nearest = tree.closest(points[i], allowed);
        if (nearest.triangle < 0)
            throw solver::Error("FE201", "the bone has no face with an area", "Give a bone that has a surface.");
        out.anchors.push_back(solver::ride_on_bone(triangles[static_cast<std::size_t>(nearest.triangle)],
                                                   nearest.barycentric, surface, points[i]));
        if (nearest.distance > out.farthest) out.farthest = nearest.distance, out.farthest_point = i;
    }
    return out;
}

void warn_if_far(const Reads& in, const Bound& bound) {
    if (!(bound.farthest > bound.size)) return;
    char text[160];
    std::snprintf(text, sizeof text, "point %zu of the curve lies %.3g from the bone, which is %.3g large",
                  bound.farthest_point, bound.farthest, bound.size);
    in.warn(
        cv_indices.name, "FE284", text,
        "Model the curve where the bone is modelled, in the same units, and list the points that are at this bone.");
}

void compute(const Reads& in, Writes& out) {
    CurvePoints c = in[curve];
    const Body* body = in.find(bone);
    const Mesh* modelled = in.find(bone_as_modelled);
    const bool by_matrix = in[matrix] != identity_matrix;
    if (body && by_matrix)
        in.fail(matrix.name, "DG110", "both a matrix and a bone shall move the points", "Connect one of the two.");
    if (modelled && !body)
        in.fail(bone_as_modelled.name, "DG110", "a bone as modelled is given, but no bone", "Connect the bone too.");
    if (body && !body->is_bone())
        in.fail(bone.name, "FE218", in.source_name(bone.name) + " is a tissue, which moves by what the line does to it",
                "Connect a zBone.");
    check_affine(in, matrix.name, in[matrix]);
    const std::vector<std::size_t> chosen = chosen_points(in, c.points.size());
    Hasher bound_to;
    bound_to.add(c.bound).add_doubles(in[cv_indices]).add(body != nullptr);
    solver::Points riding;
    if (body) {
        if (!modelled) modelled = &body->rest->mesh;
        const solver::Points& now = *std::get<Mesh>(body->values).points;
        if (modelled->topology->digest != body->rest->mesh.topology->digest || modelled->points->size() != now.size())
            in.fail(bone_as_modelled.name, "FE217",
                    "the bone as modelled has " + std::to_string(modelled->points->size()) +
                        " vertices and other faces than the bone, which has " + std::to_string(now.size()),
                    "Connect the very mesh that moves into zBone.mesh, before it is moved.");
        Hasher key;
        key.add("zRivetToBone").add(modelled->topology->digest).add(modelled->points_digest);
        for (const std::size_t i : chosen)
            key.add_doubles(std::span<const double>(c.modelled[i].data(), 3)).add(static_cast<std::uint64_t>(i));
        const Digest bind_key = key.finish();
        auto kept = in.lease<Bound>(bind_key, [&] {
            return guarded(in, bone.name,
                           [&] { return std::make_shared<Bound>(bind_points(*modelled, c.modelled, chosen)); });
        });
        warn_if_far(in, *kept);
        for (const solver::Anchor& anchor : kept->anchors) riding.push_back(solver::bone_anchor(anchor, now));
        bound_to.add(bind_key);
    } else {
        for (const std::size_t i : chosen) riding.push_back(c.modelled[i]);
        riding = guarded(in, matrix.name, [&] { return moved(riding, in[matrix]); });
    }
    for (std::size_t k = 0; k < chosen.size(); ++k) {
        solver::Vec3& p = c.points[chosen[k]];
        p = in[envelope] == 1 ? riding[k] : solver::Vec3(p + in[envelope] * (riding[k] - p));
    }
    c.bound = bound_to.finish();
    out.set(out_curve, std::move(c));
}

} // namespace

void add_z_rivet_to_bone(Registry& registry) {
    NodeType type;
    type.name = "zRivetToBone";
    type.doc = "Ties points of a curve to a bone, so that a muscle's path follows the skeleton.";
    type.inputs = {describe(curve), describe(envelope),         describe(cv_indices),
                   describe(bone),  describe(bone_as_modelled), describe(matrix)};
    type.outputs = {describe(out_curve)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
