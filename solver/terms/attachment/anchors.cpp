// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/anchors.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/surface/quadrature.h"
#include "solver/terms/attachment/find_targets.h"
#include "solver/terms/attachment/ride_on_bone.h"

#include <Eigen/LU>
#include <algorithm>
#include <memory>
#include <string>

namespace sinew::solver {

namespace {

/// Rotation whose columns are the triangle's first edge, the in-plane normal to it, and the normal.
Mat3 triangle_frame(const Vec3& a, const Vec3& b, const Vec3& c) {
    Mat3 frame;
    const Vec3 edge = (b - a).normalized();
    const Vec3 normal = (b - a).cross(c - a).normalized();
    frame.col(0) = edge;
    frame.col(1) = normal.cross(edge);
    frame.col(2) = normal;
    return frame;
}

Mat3 frame_of(const AnchorEnd& end, const Points& positions) {
    return triangle_frame(positions[at(end.vertices[0])], positions[at(end.vertices[1])],
                          positions[at(end.vertices[2])]);
}

/// Barycentric coordinates in a tet, extrapolated where p lies outside.
std::array<double, 4> coordinates_in(const TetMesh& mesh, int tet, const Vec3& p) {
    const Tet& t = mesh.tets[at(tet)];
    Mat3 edges;
    for (int a = 1; a < 4; ++a) edges.col(a - 1) = mesh.vertices[at(t[at(a)])] - mesh.vertices[at(t[0])];
    const Vec3 b = edges.inverse() * (p - mesh.vertices[at(t[0])]);
    return {1 - b.sum(), b[0], b[1], b[2]};
}

/// Search structures of the bodies, made when they are needed, shared by all attachments.
class Bodies {
  public:
    Bodies(const Scene& scene, const std::vector<Points>& surfaces)
        : scene_(scene)
        , surfaces_(surfaces)
        , tets_(surfaces.size())
        , trees_(surfaces.size()) {}
    const std::vector<Triangle>& triangles(int body) const { return scene_.triangles(body); }
    /// Null for bones and cloth.
    const CarrierTets* tets(int body) {
        const TissueRest* t = scene_.tissue(body);
        if (t && !tets_[at(body)]) tets_[at(body)] = std::make_unique<CarrierTets>(t->tets);
        return tets_[at(body)].get();
    }
    const SurfaceTree& tree(int body) {
        if (!trees_[at(body)]) trees_[at(body)] = std::make_unique<SurfaceTree>(surfaces_[at(body)], triangles(body));
        return *trees_[at(body)];
    }

  private:
    const Scene& scene_;
    const std::vector<Points>& surfaces_;
    std::vector<std::unique_ptr<CarrierTets>> tets_;
    std::vector<std::unique_ptr<SurfaceTree>> trees_;
};

struct Samples {
    std::vector<SurfaceSample> all;
    double mean_edge = 0, size = 0; ///< of the painted part, cut to size [m]
};

Samples sample_source(const Scene& scene, const AttachmentRest& a, const Points& start, Bodies& bodies) {
    // Areas at rest, so that the spring a sample gets does not depend on the pose of the start frame.
    const Points& surface = scene.deforms(a.source) ? scene.surface(a.source) : start;
    const std::vector<Triangle>& triangles = bodies.triangles(a.source);
    const CornerWeights paint = corner_weights(surface, triangles, a.source_weights, a.source_painted);
    std::vector<int> painted;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (std::any_of(paint[t].begin(), paint[t].end(), [](double w) { return w > 0; }))
            painted.push_back(static_cast<int>(t));
    if (painted.empty()) throw Error("FE212", "no face of the source has a weight above 0", "paint some of them");
    SurfaceDensity density;
    for (const int body : {a.source, a.target})
        if (const TissueRest* t = scene.tissue(body)) density.carriers.push_back({bodies.tets(body), t->element});
    const SampledSurface cut = cut_surface(surface, triangles, painted, density);
    Samples out;
    out.all = quadrature_samples(cut, paint, density);
    if (out.all.empty()) throw Error("FE212", "the painted faces of the source have no area", "paint others");
    Points corners;
    for (const Triangle& t : cut.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            corners.push_back(cut.points[at(t[i])]);
            out.mean_edge += (cut.points[at(t[i])] - cut.points[at(t[(i + 1) % 3])]).norm();
        }
    out.mean_edge /= static_cast<double>(corners.size());
    out.size = bounding_box(corners).size().norm();
    // Where the samples are at the start frame.
    for (SurfaceSample& s : out.all) {
        const Triangle& t = triangles[at(s.triangle)];
        s.point = s.place[0] * start[at(t[0])] + s.place[1] * start[at(t[1])] + s.place[2] * start[at(t[2])];
    }
    return out;
}

AnchorEnd on_bone(const Triangle& triangle, const Vec3& place) {
    AnchorEnd end;
    end.vertices = triangle;
    end.coordinates = {place[0], place[1], place[2], 0};
    return end;
}

/// \param on_target where the anchor's target is while the bone stands at `positions`
void set_offset(Anchor& anchor, const Points& positions, const Vec3& on_target, const Vec3& point) {
    const Vec3 local = frame_of(anchor.target, positions).transpose() * (point - on_target);
    anchor.offset = {local[0], local[1], local[2]};
}

std::vector<Anchor> anchors_of(const Scene& scene, const AttachmentRest& a, const std::vector<Points>& surfaces,
                               Bodies& bodies, AttachmentStart& start) {
    const Points &source = surfaces[at(a.source)], &target = surfaces[at(a.target)];
    if (a.correspondence == Correspondence::vertex_id && source.size() != target.size())
        throw Error("FE217",
                    "vertex correspondence between meshes of " + std::to_string(source.size()) + " and " +
                        std::to_string(target.size()) + " vertices",
                    "both meshes need the same vertices; use worldSpace otherwise");
    const Samples samples = sample_source(scene, a, source, bodies);
    TargetSearch search{a, target, bodies.triangles(a.target), bodies.triangles(a.source), nullptr, samples.mean_edge};
    if (a.correspondence == Correspondence::closest_point) search.tree = &bodies.tree(a.target);
    const FoundTargets found = find_targets(search, samples.all);
    start.source_size = samples.size;
    start.max_distance = found.max_distance;

    const CarrierTets *source_tets = bodies.tets(a.source), *target_tets = bodies.tets(a.target);
    std::vector<Anchor> all(samples.all.size());
    parallel_for(all.size(), 64, [&](std::size_t i) {
        const SurfaceSample& s = samples.all[i];
        const TargetPoint& t = found.points[i];
        Anchor& anchor = all[i];
        if (!t.allowed) return;
        anchor.area_weight = s.area * s.weight;
        if (source_tets)
            anchor.source.tet = source_tets->locate(s.point, anchor.source.coordinates);
        else
            anchor.source = on_bone(bodies.triangles(a.source)[at(s.triangle)], s.place);
        if (target_tets) {
            anchor.target.tet = target_tets->locate(t.point, anchor.target.coordinates);
            if (a.maintain_offset)
                anchor.target.coordinates = coordinates_in(target_tets->mesh(), anchor.target.tet, s.point);
        } else {
            anchor.target = on_bone(t.vertices, t.place);
            if (a.maintain_offset) set_offset(anchor, target, t.point, s.point);
        }
    });
    std::vector<Anchor> out;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double amount = samples.all[i].area * samples.all[i].weight;
        start.painted += amount;
        if (!found.points[i].allowed) {
            start.left_out += amount;
            continue;
        }
        start.longest = std::max(start.longest, (samples.all[i].point - found.points[i].point).norm());
        out.push_back(all[i]);
    }
    return out;
}

} // namespace

Vec3 bone_point(const AnchorEnd& end, const Points& positions) {
    return end.coordinates[0] * positions[at(end.vertices[0])] + end.coordinates[1] * positions[at(end.vertices[1])] +
           end.coordinates[2] * positions[at(end.vertices[2])];
}

Vec3 modelled_point(const Scene& scene, int body, const AnchorEnd& end) {
    if (end.tet < 0) return bone_point(end, scene.surface(body));
    const PointWeights point = scene.embedded(body, end.tet, end.coordinates);
    Vec3 p = Vec3::Zero();
    for (int k = 0; k < point.count; ++k)
        p += point.weight[k] * Eigen::Map<const Vec3>(scene.numbering().rest.data() + 3 * at(point.vertex[k]));
    return p;
}

Anchor ride_on_bone(const Triangle& triangle, const Vec3& place, const Points& positions, const Vec3& point) {
    Anchor anchor;
    anchor.target = on_bone(triangle, place);
    set_offset(anchor, positions, bone_point(anchor.target, positions), point);
    return anchor;
}

Vec3 bone_anchor(const Anchor& anchor, const Points& positions) {
    const Vec3 point = bone_point(anchor.target, positions);
    if (anchor.offset == std::array<double, 3>{}) return point;
    return point + frame_of(anchor.target, positions) * Vec3(anchor.offset[0], anchor.offset[1], anchor.offset[2]);
}

PointWeights carried_end(const Scene& scene, int body, const AnchorEnd& end) {
    return end.tet < 0 ? scene.on_cloth(body, end.vertices, end.coordinates)
                       : scene.embedded(body, end.tet, end.coordinates);
}

Vec3 cloth_offset(const Scene& scene, int target, const Anchor& anchor, const std::vector<double>& x) {
    if (anchor.offset == std::array<double, 3>{}) return Vec3::Zero();
    const auto corner = [&](std::size_t c) {
        return Vec3(Eigen::Map<const Vec3>(x.data() + 3 * at(anchor.target.vertices[c] + scene.first_vertex(target))));
    };
    return triangle_frame(corner(0), corner(1), corner(2)) * Vec3(anchor.offset[0], anchor.offset[1], anchor.offset[2]);
}

AttachmentMemory make_anchors(const Scene& scene, const std::vector<AttachmentInputs>& inputs,
                              const std::vector<Points>& surfaces) {
    const auto& attachments = scene.description().attachments;
    AttachmentMemory out;
    out.anchors.resize(attachments.size()), out.starts.resize(attachments.size());
    Bodies bodies(scene, surfaces);
    for (std::size_t a = 0; a < attachments.size(); ++a) {
        if (scene.bone(attachments[a].source) && scene.bone(attachments[a].target)) continue; // has no effect
        try {
            out.anchors[a] = anchors_of(scene, attachments[a], surfaces, bodies, out.starts[a]);
        } catch (Error& e) {
            const bool needless = e.code == "FE212" || e.code == "FE240";
            if (needless && inputs[a].mode() == AttachmentMode::none) continue;
            e.attachment = static_cast<int>(a);
            throw;
        }
    }
    return out;
}

} // namespace sinew::solver
