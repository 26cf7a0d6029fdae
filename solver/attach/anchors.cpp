// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/attach/anchors.h"

#include "solver/error.h"
#include "solver/mesh/closest_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <string>

namespace sinew::solver {

namespace {

const std::vector<Triangle>& triangles_of(const Scene& scene, int body) {
    const TissueRest* t = scene.tissue(body);
    return t ? t->triangles : scene.bone(body)->triangles;
}

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

std::vector<double> weights_for(const std::vector<double>& weights, std::size_t count, const char* which) {
    if (weights.empty()) return std::vector<double>(count, 1.0);
    if (weights.size() == 1) return std::vector<double>(count, weights.front());
    if (weights.size() != count)
        throw Error("FE204",
                    std::string(which) + " weights: " + std::to_string(weights.size()) + " for a mesh of " +
                        std::to_string(count) + " vertices",
                    "give one weight per vertex, or one for all");
    return weights;
}

/// First triangle that uses each vertex; -1 where none does.
std::vector<int> triangle_of_vertex(const std::vector<Triangle>& triangles, std::size_t vertex_count) {
    std::vector<int> first(vertex_count, -1);
    for (std::size_t t = triangles.size(); t-- > 0;)
        for (const int v : triangles[t]) first[static_cast<std::size_t>(v)] = static_cast<int>(t);
    return first;
}

/// A point of the source that holds on to the target: a vertex of its surface, or the middle of an edge.
struct Holder {
    int vertex, other; ///< other = -1: the vertex itself
    double area_weight;
    Vec3 place; ///< at the start frame
};

/// Longest edge of a surface, in edges of the tets it rides on, whose vertices hold everything that quadratic tets can
/// do.
constexpr double fine_enough = 0.5;

/// Takes edges of the source's surface whose ends both hold, where the tets are quadratic and no larger than the
/// triangles: the nodes in the middles of the tets' edges would be free otherwise. What an edge holds, three quarters,
/// is taken from its ends, so the sum stays that of the vertices.
void add_edges(const TissueRest& tissue, const std::vector<double>& weights, const Points& source,
               std::vector<Holder>& holders) {
    std::vector<int> holder(source.size(), -1);
    for (std::size_t h = 0; h < holders.size(); ++h)
        holder[static_cast<std::size_t>(holders[h].vertex)] = static_cast<int>(h);
    std::map<std::pair<int, int>, double> edges; // area x weight
    for (const Triangle& t : tissue.triangles) {
        const auto rest = [&](int i) -> const Vec3& {
            return tissue.surface[static_cast<std::size_t>(t[static_cast<std::size_t>(i)])];
        };
        const double area = 0.5 * (rest(1) - rest(0)).cross(rest(2) - rest(0)).norm();
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [a, b] = std::minmax(t[i], t[(i + 1) % 3]);
            if (holder[static_cast<std::size_t>(a)] < 0 || holder[static_cast<std::size_t>(b)] < 0) continue;
            const Tet& tet =
                tissue.tets.tets[static_cast<std::size_t>(tissue.embedding.tet[static_cast<std::size_t>(a)])];
            double longest = 0;
            for (std::size_t p = 0; p < 4; ++p)
                for (std::size_t q = 0; q < p; ++q)
                    longest = std::max(longest, (tissue.tets.vertices[static_cast<std::size_t>(tet[p])] -
                                                 tissue.tets.vertices[static_cast<std::size_t>(tet[q])])
                                                    .norm());
            if ((tissue.surface[static_cast<std::size_t>(a)] - tissue.surface[static_cast<std::size_t>(b)]).norm() <
                fine_enough * longest)
                continue;
            for (const int v : {a, b}) {
                const double share = area / 3 * 0.375 * weights[static_cast<std::size_t>(v)];
                holders[static_cast<std::size_t>(holder[static_cast<std::size_t>(v)])].area_weight -= share;
                edges[{a, b}] += share;
            }
        }
    }
    for (const auto& [edge, area_weight] : edges)
        holders.push_back(
            {edge.first, edge.second, area_weight,
             0.5 * (source[static_cast<std::size_t>(edge.first)] + source[static_cast<std::size_t>(edge.second)])});
}

/// Closest points of the target to each source point: triangle and barycentric coordinates.
std::vector<ClosestPoint> find_targets(const AttachmentRest& attachment, const std::vector<Holder>& holders,
                                       const Points& target, const std::vector<Triangle>& triangles) {
    const std::vector<double> weights = weights_for(attachment.target_weights, target.size(), "target");
    std::vector<ClosestPoint> found;
    found.reserve(holders.size());
    if (attachment.correspondence == Correspondence::vertex_id) {
        const std::vector<int> triangle = triangle_of_vertex(triangles, target.size());
        for (const Holder& h : holders) {
            const int v = h.vertex, t = triangle[static_cast<std::size_t>(v)];
            if (t < 0) throw Error("FE208", "vertex " + std::to_string(v) + " of the target belongs to no face");
            ClosestPoint c;
            c.triangle = t;
            c.point = target[static_cast<std::size_t>(v)];
            for (int i = 0; i < 3; ++i)
                c.barycentric[i] = triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(i)] == v ? 1.0 : 0.0;
            found.push_back(c);
        }
        return found;
    }
    std::vector<char> allowed(triangles.size(), 1);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (const int v : triangles[t])
            if (!(weights[static_cast<std::size_t>(v)] > 0)) allowed[t] = 0;
    if (std::find(allowed.begin(), allowed.end(), 1) == allowed.end())
        throw Error("FE212", "no face of the target has a target weight above 0 at all its vertices",
                    "paint the target where the source may attach");
    const SurfaceTree tree(target, triangles);
    for (const Holder& h : holders) found.push_back(tree.closest(h.place, allowed));
    return found;
}

} // namespace

Vec3 bone_anchor(const Anchor& anchor, const std::vector<Triangle>& triangles, const Points& positions) {
    const Triangle& t = triangles[static_cast<std::size_t>(anchor.target_triangle)];
    const Vec3 &a = positions[static_cast<std::size_t>(t[0])], &b = positions[static_cast<std::size_t>(t[1])],
               &c = positions[static_cast<std::size_t>(t[2])];
    const Vec3 point = anchor.coordinates[0] * a + anchor.coordinates[1] * b + anchor.coordinates[2] * c;
    if (anchor.offset == std::array<double, 3>{}) return point;
    return point + triangle_frame(a, b, c) * Vec3(anchor.offset[0], anchor.offset[1], anchor.offset[2]);
}

std::vector<Anchor> make_anchors(const Scene& scene, const AttachmentRest& attachment,
                                 const std::vector<Points>& surfaces) {
    std::vector<Anchor> anchors;
    if (attachment.mode == AttachmentMode::none) return anchors;
    const Points& source = surfaces[static_cast<std::size_t>(attachment.source)];
    const Points& target = surfaces[static_cast<std::size_t>(attachment.target)];
    if (attachment.correspondence == Correspondence::vertex_id && source.size() != target.size())
        throw Error("FE204",
                    "vertex correspondence between meshes of " + std::to_string(source.size()) + " and " +
                        std::to_string(target.size()) + " vertices",
                    "both meshes need the same vertices; use worldSpace otherwise");
    const std::vector<double> weights = weights_for(attachment.source_weights, source.size(), "source");
    const TissueRest* source_tissue = scene.tissue(attachment.source);
    // Areas at rest, so that the spring a vertex gets does not depend on the pose of the start frame.
    const std::vector<double> areas =
        vertex_areas(source_tissue ? source_tissue->surface : source, triangles_of(scene, attachment.source));
    std::vector<Holder> holders;
    for (std::size_t v = 0; v < weights.size(); ++v)
        if (weights[v] > 0) holders.push_back({static_cast<int>(v), -1, areas[v] * weights[v], source[v]});
    if (holders.empty())
        throw Error("FE212", "no source vertex has a weight above 0", "paint at least one vertex of the source");
    if (source_tissue && source_tissue->element == ElementKind::quadratic &&
        attachment.correspondence != Correspondence::vertex_id)
        add_edges(*source_tissue, weights, source, holders);

    const std::vector<Triangle>& target_triangles = triangles_of(scene, attachment.target);
    const std::vector<ClosestPoint> found = find_targets(attachment, holders, target, target_triangles);
    const TissueRest* target_tissue = scene.tissue(attachment.target);
    Embedding hosts, edge_hosts; // of the target's points, and of the source's edges
    if (target_tissue) {
        Points on_target;
        for (const ClosestPoint& c : found) on_target.push_back(c.point);
        hosts = embed(target_tissue->tets, on_target);
    }
    if (holders.back().other >= 0) {
        Points middles;
        for (const Holder& h : holders)
            if (h.other >= 0) middles.push_back(h.place);
        edge_hosts = embed(source_tissue->tets, middles);
    }
    const std::size_t vertex_count = holders.size() - edge_hosts.size();
    for (std::size_t i = 0; i < holders.size(); ++i) {
        Anchor anchor;
        anchor.source_vertex = holders[i].vertex;
        anchor.area_weight = holders[i].area_weight;
        if (i >= vertex_count) {
            anchor.source_tet = edge_hosts.tet[i - vertex_count];
            anchor.source_coordinates = edge_hosts.barycentric[i - vertex_count];
        }
        const Vec3& from = holders[i].place;
        if (target_tissue) {
            anchor.target_tet = hosts.tet[i];
            anchor.coordinates = hosts.barycentric[i];
            if (attachment.maintain_offset) {
                const Tet& tet = target_tissue->tets.tets[static_cast<std::size_t>(anchor.target_tet)];
                const Points& x = target_tissue->tets.vertices;
                Mat3 edges;
                for (int a = 1; a < 4; ++a)
                    edges.col(a - 1) = x[static_cast<std::size_t>(tet[static_cast<std::size_t>(a)])] -
                                       x[static_cast<std::size_t>(tet[0])];
                const Vec3 b = edges.inverse() * (from - x[static_cast<std::size_t>(tet[0])]);
                anchor.coordinates = {1 - b.sum(), b[0], b[1], b[2]};
            }
        } else {
            anchor.target_triangle = found[i].triangle;
            anchor.coordinates = {found[i].barycentric[0], found[i].barycentric[1], found[i].barycentric[2], 0};
            if (attachment.maintain_offset) {
                const Triangle& t = target_triangles[static_cast<std::size_t>(anchor.target_triangle)];
                const Vec3 local =
                    triangle_frame(target[static_cast<std::size_t>(t[0])], target[static_cast<std::size_t>(t[1])],
                                   target[static_cast<std::size_t>(t[2])])
                        .transpose() *
                    (from - found[i].point);
                anchor.offset = {local[0], local[1], local[2]};
            }
        }
        anchors.push_back(anchor);
    }
    return anchors;
}

} // namespace sinew::solver
