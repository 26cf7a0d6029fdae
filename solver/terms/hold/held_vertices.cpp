// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/hold/held_vertices.h"

#include "solver/element/quadratic_tets.h"
#include "solver/index.h"
#include "solver/mesh/bvh.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

using Place = Eigen::Vector4d;
using Polygon = std::vector<Place>;

/// What carries less of every painted point does not carry them.
constexpr double least_weight = 1e-5;
/// Points this far outside of a tet, in its own coordinates, still touch it.
constexpr double slack = 1e-9;

/// Flags the vertices that carry points of the part.
class Carriers {
  public:
    explicit Carriers(const TissueRest& tissue)
        : tissue_(tissue) {
        std::size_t count = tissue.tets.vertices.size();
        if (tissue.element == ElementKind::quadratic) {
            const auto edges = edges_of(tissue.tets.tets);
            edge_vertices_ = edge_vertices(tissue.tets.tets, edges, static_cast<int>(count));
            count += edges.size();
        }
        carries_.assign(count, 0);
    }

    /// A point in a tet.
    void add(int tet, const Place& b) {
        const PointWeights w =
            embedded_point(tissue_.tets.tets[at(tet)], edge_vertices_.empty() ? nullptr : &edge_vertices_[at(tet)],
                           {b[0], b[1], b[2], b[3]});
        for (int k = 0; k < w.count; ++k)
            if (std::abs(w.weight[k]) > least_weight) carries_[at(w.vertex[k])] = 1;
    }

    /// The part of a triangle that lies in a tet. Shape functions are largest at its corners, those of quadratic tets
    /// may also vanish at all of them.
    void add(int tet, const Polygon& polygon) {
        Place centre = Place::Zero();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            add(tet, polygon[i]);
            if (edge_vertices_.empty()) continue;
            add(tet, Place(0.5 * (polygon[i] + polygon[(i + 1) % polygon.size()])));
            centre += polygon[i] / static_cast<double>(polygon.size());
        }
        if (!edge_vertices_.empty() && !polygon.empty()) add(tet, centre);
    }

    std::vector<int> all() const {
        std::vector<int> out;
        for (std::size_t v = 0; v < carries_.size(); ++v)
            if (carries_[v]) out.push_back(static_cast<int>(v));
        return out;
    }

  private:
    const TissueRest& tissue_;
    std::vector<std::array<int, 6>> edge_vertices_;
    std::vector<char> carries_;
};

/// Cuts off what lies on the outer side of each face (Sutherland and Hodgman 1974).
void clip(Polygon& polygon, Polygon& spare) {
    for (Eigen::Index k = 0; k < 4; ++k) {
        spare.clear();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Place &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            const double p_inside = p[k] + slack, q_inside = q[k] + slack;
            if (p_inside >= 0) spare.push_back(p);
            if ((p_inside >= 0) != (q_inside >= 0)) spare.push_back(p + p_inside / (p_inside - q_inside) * (q - p));
        }
        polygon.swap(spare);
    }
}

/// Calls `visit` with every tet whose box meets the box from `low` to `high`.
template <class Visit>
void for_each_near(const Bvh& tree, const Vec3& low, const Vec3& high, const Visit& visit) {
    int stack[64];
    int size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const int n = stack[--size];
        const BvhNode& node = tree.nodes[at(n)];
        if ((high.array() < node.min.array()).any() || (low.array() > node.max.array()).any()) continue;
        if (node.count == 0) {
            stack[size++] = node.first;
            stack[size++] = n + 1;
            continue;
        }
        for (int i = node.first; i < node.first + node.count; ++i) visit(tree.order[at(i)]);
    }
}

Bvh tree_of(const TetMesh& mesh) {
    Points low, high;
    for (const Tet& t : mesh.tets) {
        Vec3 a = mesh.vertices[at(t[0])], b = a;
        for (const int v : t) a = a.cwiseMin(mesh.vertices[at(v)]), b = b.cwiseMax(mesh.vertices[at(v)]);
        const Vec3 margin = Vec3::Constant(1e-6 * (b - a).norm());
        low.push_back(a - margin);
        high.push_back(b + margin);
    }
    return build_bvh(low, high);
}

} // namespace

PaintedPart painted_vertices(const std::vector<Triangle>& triangles, const std::vector<double>& weights) {
    PaintedPart out;
    for (const double w : weights) out.vertices.push_back(w > 0);
    for (const Triangle& t : triangles)
        out.triangles.push_back(std::all_of(t.begin(), t.end(), [&](int v) { return out.vertices[at(v)] != 0; }));
    return out;
}

PaintedPart painted_triangles(const std::vector<Triangle>& triangles, std::size_t vertex_count,
                              const std::vector<double>& weights) {
    PaintedPart out;
    out.vertices.assign(vertex_count, 0);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        out.triangles.push_back(weights[t] > 0);
        for (const int v : triangles[t])
            if (weights[t] > 0) out.vertices[at(v)] = 1;
    }
    return out;
}

std::vector<int> carriers_of(const TissueRest& tissue, const PaintedPart& part) {
    Carriers carriers(tissue);
    for (std::size_t v = 0; v < part.vertices.size(); ++v)
        if (part.vertices[v]) carriers.add(tissue.embedding.tet[v], Place(tissue.embedding.barycentric[v].data()));
    const TetMesh& mesh = tissue.tets;
    const Bvh tree = tree_of(mesh);
    Polygon polygon, spare;
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
        if (!part.triangles[t]) continue;
        const auto corner = [&](std::size_t i) -> const Vec3& { return tissue.surface[at(tissue.triangles[t][i])]; };
        const Vec3 low = corner(0).cwiseMin(corner(1)).cwiseMin(corner(2)),
                   high = corner(0).cwiseMax(corner(1)).cwiseMax(corner(2));
        for_each_near(tree, low, high, [&](int tet) {
            const Tet& c = mesh.tets[at(tet)];
            const Vec3& origin = mesh.vertices[at(c[0])];
            Mat3 edges;
            for (int k = 0; k < 3; ++k) edges.col(k) = mesh.vertices[at(c[static_cast<std::size_t>(k) + 1])] - origin;
            const Mat3 inverse = edges.inverse();
            polygon.clear();
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec3 l = inverse * (corner(i) - origin);
                polygon.emplace_back(1 - l.sum(), l.x(), l.y(), l.z());
            }
            clip(polygon, spare);
            carriers.add(tet, polygon);
        });
    }
    return carriers.all();
}

std::vector<int> carriers_of(const BodyRest& body, const PaintedPart& part) {
    if (const auto* tissue = std::get_if<std::shared_ptr<const TissueRest>>(&body)) return carriers_of(**tissue, part);
    std::vector<int> out;
    if (!std::holds_alternative<std::shared_ptr<const ClothRest>>(body)) return out;
    for (std::size_t v = 0; v < part.vertices.size(); ++v)
        if (part.vertices[v]) out.push_back(static_cast<int>(v));
    return out;
}

} // namespace sinew::solver
