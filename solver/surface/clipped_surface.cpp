// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/surface/clipped_surface.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/parallel.h"
#include "solver/surface/sampled_surface.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sinew::solver {
namespace {

/// Barycentric coordinates in a tet that count as zero.
constexpr double face_slack = 1e-12;
/// Shares of a triangle's area: what may be missing when its pieces are summed up, and what is no piece.
constexpr double missing = 1e-10, nothing = 1e-16;
constexpr std::size_t most_pieces = 4'000'000;
constexpr int most_halvings = 24;

/// Convex, by corners' barycentric coordinates in a triangle.
using Polygon = std::vector<Vec3>;
/// A barycentric coordinate of a tet, as a linear function over the triangle: its values at the triangle's corners.
using Side = Vec3;

double doubled_area(const Vec3& a, const Vec3& b, const Vec3& c) {
    return (b.y() - a.y()) * (c.z() - a.z()) - (b.z() - a.z()) * (c.y() - a.y());
}

/// As a share of the triangle's.
double area(const Polygon& polygon) {
    double sum = 0;
    for (std::size_t i = 2; i < polygon.size(); ++i) sum += doubled_area(polygon[0], polygon[i - 1], polygon[i]);
    return sum;
}

/// Parts `polygon` where `side` changes its sign. What lies on the side as a whole is positive.
void split(const Polygon& polygon, const Side& side, Polygon& positive, Polygon& negative) {
    positive.clear(), negative.clear();
    if (std::all_of(polygon.begin(), polygon.end(), [&](const Vec3& p) { return side.dot(p) >= -face_slack; })) {
        positive = polygon;
        return;
    }
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double at_a = side.dot(a), at_b = side.dot(b);
        const bool a_on = std::abs(at_a) <= face_slack, b_on = std::abs(at_b) <= face_slack;
        if (a_on || at_a > 0) positive.push_back(a);
        if (a_on || at_a < 0) negative.push_back(a);
        if (a_on || b_on || (at_a > 0) == (at_b > 0)) continue;
        const Vec3 crossing = (at_a * b - at_b * a) / (at_a - at_b);
        positive.push_back(crossing), negative.push_back(crossing);
    }
}

class Clipper {
  public:
    Clipper(const Points& points, const std::vector<Triangle>& triangles, const CarrierTets& tets)
        : points_(points)
        , triangles_(triangles)
        , tets_(tets)
        , density_{{{&tets, ElementKind::linear}}} {
        Points low, high;
        for (const Tet& t : mesh().tets) {
            Vec3 a = mesh().vertices[at(t[0])], b = a;
            for (const int v : t) a = a.cwiseMin(mesh().vertices[at(v)]), b = b.cwiseMax(mesh().vertices[at(v)]);
            const double slack = 1e-9 * (b - a).maxCoeff();
            low.emplace_back(a.array() - slack), high.emplace_back(b.array() + slack);
        }
        tree_ = build_bvh(low, high);
    }

    /// Appends the pieces of a triangle; true: a part of it lies outside.
    bool clip(int triangle, std::vector<SurfacePiece>& out) const {
        const Polygon whole{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
        struct Candidate {
            int tet;
            std::array<Side, 4> sides;
        };
        std::vector<Candidate> candidates;
        for (const int tet : near(triangle)) {
            Candidate c{tet, {}};
            if (!sides_of(triangle, tet, c.sides)) continue;
            bool reaches = true, covers = true;
            for (const Side& s : c.sides)
                reaches = reaches && s.maxCoeff() > -face_slack, covers = covers && s.minCoeff() >= -face_slack;
            if (covers) {
                add(triangle, tet, whole, out);
                return false;
            }
            if (reaches) candidates.push_back(c);
        }
        // Every tet's part. If they do not add up to the triangle, it lies on faces between tets or reaches out of
        // them.
        Polygon inside, outside, next;
        std::vector<std::pair<int, Polygon>> parts;
        double sum = 0;
        for (const Candidate& c : candidates) {
            inside = whole;
            for (const Side& s : c.sides) {
                split(inside, s, next, outside);
                std::swap(inside, next);
            }
            if (const double share = area(inside); share > nothing) sum += share, parts.emplace_back(c.tet, inside);
        }
        if (std::abs(sum - 1) <= missing) {
            for (const auto& [tet, part] : parts) add(triangle, tet, part, out);
            return false;
        }
        // What one tet has taken the next does not get.
        std::vector<Polygon> left{whole}, kept;
        for (const Candidate& c : candidates) {
            kept.clear();
            for (const Polygon& polygon : left) {
                inside = polygon;
                for (const Side& s : c.sides) {
                    split(inside, s, next, outside);
                    if (area(outside) > nothing) kept.push_back(outside);
                    std::swap(inside, next);
                }
                if (area(inside) > nothing) add(triangle, c.tet, inside, out);
            }
            std::swap(left, kept);
        }
        sum = 0;
        for (const Polygon& polygon : left) sum += area(polygon);
        for (const Polygon& polygon : left)
            for (std::size_t i = 2; i < polygon.size(); ++i)
                add_outside(triangle, {polygon[0], polygon[i - 1], polygon[i]}, most_halvings, out);
        return sum > missing;
    }

  private:
    const TetMesh& mesh() const { return tets_.mesh(); }
    Vec3 place(int triangle, const Vec3& b) const {
        const Triangle& t = triangles_[at(triangle)];
        return b[0] * points_[at(t[0])] + b[1] * points_[at(t[1])] + b[2] * points_[at(t[2])];
    }

    /// Tets whose boxes touch the triangle's, by number.
    std::vector<int> near(int triangle) const {
        const Triangle& t = triangles_[at(triangle)];
        Vec3 low = points_[at(t[0])], high = low;
        for (const int v : t) low = low.cwiseMin(points_[at(v)]), high = high.cwiseMax(points_[at(v)]);
        std::vector<int> out, stack{0};
        while (!stack.empty()) {
            const int n = stack.back();
            stack.pop_back();
            const BvhNode& node = tree_.nodes[at(n)];
            if ((high.array() < node.min.array()).any() || (low.array() > node.max.array()).any()) continue;
            if (node.count == 0)
                stack.push_back(node.first), stack.push_back(n + 1);
            else
                out.insert(out.end(), tree_.order.begin() + node.first, tree_.order.begin() + node.first + node.count);
        }
        std::sort(out.begin(), out.end());
        return out;
    }

    /// False: the tet is flat.
    bool sides_of(int triangle, int tet, std::array<Side, 4>& sides) const {
        const Tet& corners = mesh().tets[at(tet)];
        const auto corner = [&](std::size_t k) { return mesh().vertices[at(corners[k])]; };
        Mat3 edges;
        edges << corner(1) - corner(0), corner(2) - corner(0), corner(3) - corner(0);
        if (edges.determinant() == 0) return false;
        const Mat3 inverse = edges.inverse();
        for (int i = 0; i < 3; ++i) {
            const Vec3 b = inverse * (points_[at(triangles_[at(triangle)][at(i)])] - corner(0));
            sides[0][i] = 1 - b.sum();
            for (int k = 0; k < 3; ++k) sides[at(k + 1)][i] = b[k];
        }
        return true;
    }

    void add(int triangle, int tet, const Polygon& polygon, std::vector<SurfacePiece>& out) const {
        std::array<Side, 4> sides;
        sides_of(triangle, tet, sides);
        for (std::size_t i = 2; i < polygon.size(); ++i) {
            SurfacePiece piece{triangle, tet, {polygon[0], polygon[i - 1], polygon[i]}, {}};
            if (!(doubled_area(piece.place[0], piece.place[1], piece.place[2]) > nothing)) continue;
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t k = 0; k < 4; ++k) piece.inside[c][k] = sides[k].dot(piece.place[c]);
            out.push_back(piece);
        }
    }

    /// Outside of all tets: in parts that are not longer than the nearest tets are wide.
    void add_outside(int triangle, const std::array<Vec3, 3>& corners, int halvings,
                     std::vector<SurfacePiece>& out) const {
        for (std::size_t i = 0; halvings > 0 && i < 3; ++i) {
            const Vec3 &a = corners[i], &b = corners[(i + 1) % 3], &c = corners[(i + 2) % 3];
            const double length = (place(triangle, a) - place(triangle, b)).norm();
            if (length < (place(triangle, b) - place(triangle, c)).norm() ||
                length < (place(triangle, c) - place(triangle, a)).norm() ||
                !density_.too_long(place(triangle, a), place(triangle, b)))
                continue;
            const Vec3 middle = 0.5 * (a + b);
            add_outside(triangle, {a, middle, c}, halvings - 1, out);
            add_outside(triangle, {middle, b, c}, halvings - 1, out);
            return;
        }
        std::array<double, 4> ignored;
        const int tet = tets_.locate(place(triangle, (corners[0] + corners[1] + corners[2]) / 3), ignored);
        add(triangle, tet, {corners[0], corners[1], corners[2]}, out);
    }

    const Points& points_;
    const std::vector<Triangle>& triangles_;
    const CarrierTets& tets_;
    SurfaceDensity density_;
    Bvh tree_;
};

} // namespace

ClippedSurface clip_surface(const Points& points, const std::vector<Triangle>& triangles, const CarrierTets& tets) {
    const Clipper clipper(points, triangles, tets);
    std::vector<std::vector<SurfacePiece>> parts(triangles.size());
    ClippedSurface out;
    out.is_outside.assign(triangles.size(), 0);
    parallel_for(triangles.size(), 16,
                 [&](std::size_t t) { out.is_outside[t] = clipper.clip(static_cast<int>(t), parts[t]); });
    std::size_t count = 0;
    for (const auto& part : parts) count += part.size();
    if (count > most_pieces)
        throw Error("FE232",
                    "cutting a surface along the tets that carry it gives " + std::to_string(count) +
                        " pieces; there may be " + std::to_string(most_pieces),
                    "choose larger tets or a coarser surface");
    out.pieces.reserve(count);
    for (const auto& part : parts) out.pieces.insert(out.pieces.end(), part.begin(), part.end());
    return out;
}

} // namespace sinew::solver
