// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/paint_pieces.h"

#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/parallel.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <set>

namespace sinew::solver {
namespace {

using Barycentric4 = Eigen::Vector4d;

/// Corner of a polygon: where it is in its triangle and in a tet.
struct Corner {
    Vec3 shares;
    Barycentric4 in_tet;
};

/// In barycentric coordinates, so that neighbours leave no gap to speak of. What both take is as thin.
constexpr double slack = 1e-13;
/// A piece that is nowhere farther than this from a side lies in it.
constexpr double on_side = 1e-9;
/// Pieces with less of their triangle are what rounding leaves.
constexpr double least_piece = 1e-9;
/// Share of a triangle that may be missing.
constexpr double missing = 1e-6;

Bvh tree_of_boxes(const TetMesh& mesh) {
    Points low, high;
    for (const Tet& t : mesh.tets) {
        Vec3 least = mesh.vertices[at(t[0])], most = least;
        for (const int v : t) least = least.cwiseMin(mesh.vertices[at(v)]), most = most.cwiseMax(mesh.vertices[at(v)]);
        const Vec3 margin = Vec3::Constant(slack * (most - least).maxCoeff());
        low.push_back(least - margin), high.push_back(most + margin);
    }
    return build_bvh(low, high);
}

/// What of a polygon lies on the inner side of a tet's side.
std::vector<Corner> clipped(const std::vector<Corner>& polygon, Eigen::Index side) {
    std::vector<Corner> out;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double from = a.in_tet[side] + slack, to = b.in_tet[side] + slack;
        if (from >= 0) out.push_back(a);
        if ((from < 0) != (to < 0)) {
            const double share = from / (from - to);
            out.push_back({a.shares + share * (b.shares - a.shares), a.in_tet + share * (b.in_tet - a.in_tet)});
        }
    }
    return out;
}

/// The part of one triangle in one tet.
struct Piece {
    int tet;
    double share; ///< of the triangle's area
    Barycentric4 centroid;
};

class TriangleCutter {
  public:
    explicit TriangleCutter(const TetMesh& mesh)
        : mesh_(mesh)
        , boxes_(tree_of_boxes(mesh)) {}

    std::vector<Piece> cut(const std::array<Vec3, 3>& triangle) const {
        Vec3 low = triangle[0], high = low;
        for (const Vec3& p : triangle) low = low.cwiseMin(p), high = high.cwiseMax(p);
        std::vector<Piece> out;
        std::set<std::array<int, 3>> taken; // sides of tets
        for (const int tet : items_near(boxes_, low, high)) {
            const std::vector<Corner> polygon = part_in(tet, triangle);
            if (polygon.size() < 3 || lies_in_a_taken_side(tet, polygon, taken)) continue;
            if (const Piece piece = made(tet, polygon); piece.share > least_piece) out.push_back(piece);
        }
        return out;
    }

  private:
    std::vector<Corner> part_in(int tet, const std::array<Vec3, 3>& triangle) const {
        const Tet& t = mesh_.tets[at(tet)];
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = mesh_.vertices[at(t[at(k + 1)])] - mesh_.vertices[at(t[0])];
        const Mat3 inverse = edges.inverse();
        if (!inverse.allFinite()) return {};
        std::vector<Corner> polygon;
        for (int k = 0; k < 3; ++k) {
            const Vec3 l = inverse * (triangle[at(k)] - mesh_.vertices[at(t[0])]);
            polygon.push_back({Vec3::Unit(k), Barycentric4(1 - l.sum(), l[0], l[1], l[2])});
        }
        for (Eigen::Index side = 0; side < 4 && polygon.size() >= 3; ++side) polygon = clipped(polygon, side);
        return polygon;
    }

    bool lies_in_a_taken_side(int tet, const std::vector<Corner>& polygon, std::set<std::array<int, 3>>& taken) const {
        for (Eigen::Index side = 0; side < 4; ++side) {
            if (!std::all_of(polygon.begin(), polygon.end(),
                             [&](const Corner& c) { return std::abs(c.in_tet[side]) <= on_side; }))
                continue;
            std::array<int, 3> corners{};
            std::size_t n = 0;
            for (std::size_t k = 0; k < 4; ++k)
                if (static_cast<Eigen::Index>(k) != side) corners[n++] = mesh_.tets[at(tet)][k];
            std::sort(corners.begin(), corners.end());
            if (!taken.insert(corners).second) return true;
        }
        return false;
    }

    static Piece made(int tet, const std::vector<Corner>& polygon) {
        Piece out{tet, 0, Barycentric4::Zero()};
        // Twice the areas in the plane of the first two shares, of which the whole triangle has 1.
        const Corner& a = polygon[0];
        for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
            const Corner &b = polygon[i], &c = polygon[i + 1];
            const Vec3 u = b.shares - a.shares, v = c.shares - a.shares;
            const double area = std::abs(u[0] * v[1] - u[1] * v[0]);
            out.share += area;
            out.centroid += area / 3 * (a.in_tet + b.in_tet + c.in_tet);
        }
        if (out.share > 0) out.centroid /= out.share;
        return out;
    }

    const TetMesh& mesh_;
    Bvh boxes_;
};

void add(PaintPieces& out, int tet, const std::array<double, 4>& barycentric, double area, double value) {
    out.embedding.tet.push_back(tet);
    out.embedding.barycentric.push_back(barycentric);
    out.areas.push_back(area);
    out.values.push_back(value);
}

/// Triangles that leave the tets, by samples.
void add_samples(PaintPieces& out, const TetMesh& mesh, const PaintedSurface& surface,
                 const std::vector<double>& values, const std::vector<Triangle>& triangles) {
    if (triangles.empty()) return;
    const PaintSamples samples = sample_paint(mesh, {surface.points, triangles, surface.embedding, surface.locator},
                                              std::vector<char>(surface.points.size(), 1));
    const std::vector<double> painted = samples.values(values);
    for (std::size_t i = 0; i < samples.areas.size(); ++i)
        if (samples.areas[i] > 0)
            add(out, samples.embedding.tet[i], samples.embedding.barycentric[i], samples.areas[i], painted[i]);
}

} // namespace

PaintPieces cut_paint(const TetMesh& mesh, const PaintedSurface& surface, const std::vector<double>& values,
                      const std::vector<char>& painted) {
    sample_paint(mesh, surface, std::vector<char>(painted.size(), 0)).values(values); // for what they refuse
    std::vector<Triangle> whole;
    std::vector<char> is_alone = painted;
    for (const Triangle& t : surface.triangles) {
        const std::size_t a = at(t[0]), b = at(t[1]), c = at(t[2]);
        if (!(painted[a] && painted[b] && painted[c]) || values[a] != values[b] || values[a] != values[c]) continue;
        whole.push_back(t);
        is_alone[a] = is_alone[b] = is_alone[c] = 0;
    }
    const TriangleCutter cutter(mesh);
    std::vector<std::vector<Piece>> pieces(whole.size());
    const auto corners = [&](const Triangle& t) {
        return std::array<Vec3, 3>{surface.points[at(t[0])], surface.points[at(t[1])], surface.points[at(t[2])]};
    };
    parallel_for(whole.size(), 4, [&](std::size_t i) { pieces[i] = cutter.cut(corners(whole[i])); });

    PaintPieces out;
    std::vector<Triangle> beyond;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        double share = 0;
        for (const Piece& p : pieces[i]) share += p.share;
        if (share < 1 - missing) {
            beyond.push_back(whole[i]);
            continue;
        }
        const auto c = corners(whole[i]);
        const double area = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
        for (const Piece& p : pieces[i])
            add(out, p.tet, {p.centroid[0], p.centroid[1], p.centroid[2], p.centroid[3]}, p.share * area,
                values[at(whole[i][0])]);
    }
    add_samples(out, mesh, surface, values, beyond);
    const std::vector<double> areas = vertex_areas(surface.points, surface.triangles);
    for (std::size_t v = 0; v < is_alone.size(); ++v)
        if (is_alone[v]) add(out, surface.embedding.tet[v], surface.embedding.barycentric[v], areas[v], values[v]);
    return out;
}

} // namespace sinew::solver
