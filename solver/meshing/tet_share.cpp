// Exact share of a tet inside a closed surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/tet_share.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace sinew::solver {
namespace {

using Barycentric = std::array<double, 4>;

/// A convex polygon in the tet. `tag[i]` says where the edge from corner i to the next one lies: on the tet's
/// face opposite corner 0…3, or -1 for an edge of the triangle itself.
struct Polygon {
    static constexpr int capacity = 24; // rounding may add a corner or two to the seven of exact arithmetic
    Barycentric corner[capacity];
    int tag[capacity];
    int size = 0;
    void add(const Barycentric& c, int t) {
        if (size < capacity) corner[size] = c, tag[size] = t, ++size;
    }
};

/// The point where the way from `in` to `out` leaves through face k. Always walked from inside to outside, so
/// that the two triangles at an edge compute the same point.
Barycentric cut(const Barycentric& in, const Barycentric& out, std::size_t k, double slack) {
    const double t = (in[k] + slack) / (in[k] - out[k]);
    Barycentric point;
    for (std::size_t i = 0; i < 4; ++i) point[i] = in[i] + t * (out[i] - in[i]);
    point[k] = -slack;
    return point;
}

/// Sutherland and Hodgman's clipping by the half-space where coordinate k is at least -slack.
Polygon clip(const Polygon& polygon, int k, double slack) {
    const std::size_t face = static_cast<std::size_t>(k);
    Polygon result;
    for (int i = 0; i < polygon.size; ++i) {
        const int next = i + 1 < polygon.size ? i + 1 : 0;
        const Barycentric &a = polygon.corner[i], &b = polygon.corner[next];
        const bool a_in = a[face] >= -slack, b_in = b[face] >= -slack;
        if (a_in) result.add(a, polygon.tag[i]);
        if (a_in && !b_in) result.add(cut(a, b, face, slack), k);
        if (!a_in && b_in) result.add(cut(b, a, face, slack), polygon.tag[i]);
    }
    return result;
}

Polygon clip_to_tet(const BarycentricTriangle& triangle, double slack) {
    Polygon polygon;
    for (const Barycentric& c : triangle) polygon.add(c, -1);
    // Faces 0 and 3 first: their common edge is the one whose crossings are counted.
    for (int k : {0, 3, 1, 2}) {
        polygon = clip(polygon, k, slack);
        if (polygon.size == 0) break;
    }
    return polygon;
}

double determinant(const Barycentric& p, const Barycentric& q, const Barycentric& r) {
    return p[1] * (q[2] * r[3] - q[3] * r[2]) + p[2] * (q[3] * r[1] - q[1] * r[3]) + p[3] * (q[1] * r[2] - q[2] * r[1]);
}

} // namespace

bool touches_tet(const BarycentricTriangle& triangle, double slack) {
    for (std::size_t k = 0; k < 4; ++k)
        if (triangle[0][k] < -slack && triangle[1][k] < -slack && triangle[2][k] < -slack) return false;
    return clip_to_tet(triangle, slack).size > 0;
}

double share_of_triangle(const BarycentricTriangle& triangle, int reference_corner) {
    // Even permutations that bring the reference corner to place 1: the counted edge runs from corner 1 to
    // corner 2.
    constexpr std::size_t order[4][4] = {{1, 0, 3, 2}, {0, 1, 2, 3}, {3, 2, 1, 0}, {2, 3, 0, 1}};
    const auto& o = order[reference_corner];
    BarycentricTriangle turned;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < 4; ++k) turned[c][k] = triangle[c][o[k]];

    const Polygon polygon = clip_to_tet(turned, 0);
    double share = 0;
    for (int i = 1; i + 1 < polygon.size; ++i)
        share += determinant(polygon.corner[0], polygon.corner[i], polygon.corner[i + 1]);
    for (int i = 0; i < polygon.size; ++i) {
        const int next = i + 1 < polygon.size ? i + 1 : 0;
        const Barycentric &p = polygon.corner[i], &q = polygon.corner[next];
        if (polygon.tag[i] != 0) continue;
        // The face's piece runs along the same segment in the opposite direction.
        share += q[1] * p[2] - q[2] * p[1];
        if (polygon.tag[next] == 3) share -= 1 - q[2]; // the counted edge leaves the solid here
        const int before = i > 0 ? i - 1 : polygon.size - 1;
        if (polygon.tag[before] == 3) share += 1 - p[2]; // and here it enters
    }
    return share;
}

namespace {

constexpr int deepest_split = 3;

/// Maps points to the barycentric coordinates of one tet.
class TetFrame {
  public:
    explicit TetFrame(const std::array<Vec3, 4>& c)
        : origin_(c[0]) {
        Mat3 edges;
        edges << c[1] - c[0], c[2] - c[0], c[3] - c[0];
        inverse_ = edges.inverse();
    }
    Barycentric operator()(const Vec3& p) const {
        const Vec3 l = inverse_ * (p - origin_);
        return {1 - l[0] - l[1] - l[2], l[0], l[1], l[2]};
    }
    BarycentricTriangle operator()(const Solid& solid, int triangle) const {
        const Triangle& t = solid.triangles[static_cast<std::size_t>(triangle)];
        const auto corner = [&](int v) { return (*this)(solid.points[static_cast<std::size_t>(v)]); };
        return {corner(t[0]), corner(t[1]), corner(t[2])};
    }

  private:
    Vec3 origin_;
    Mat3 inverse_;
};

/// Integral of the winding number over the tet, per volume; NaN if every corner lies on the surface.
double winding_integral(const Solid& solid, const std::array<Vec3, 4>& corners, const TetFrame& frame,
                        const std::vector<int>& triangles) {
    const double near = 1e-7 * (corners[1] - corners[0]).norm();
    for (int reference = 0; reference < 4; ++reference) {
        const Vec3& corner = corners[static_cast<std::size_t>(reference)];
        if (solid.tree.closest(corner, near).triangle >= 0) continue;
        double integral = std::round(solid.winding_number(corner));
        for (int t : triangles) integral += share_of_triangle(frame(solid, t), reference);
        return integral;
    }
    return std::nan("");
}

/// The eight tets between the corners and the midpoints of the edges. The inner octahedron is cut along the
/// shortest of its diagonals, which keeps the parts of a lattice tet alike.
std::array<std::array<Vec3, 4>, 8> split(const std::array<Vec3, 4>& c) {
    const auto m = [&](std::size_t i, std::size_t j) -> Vec3 { return 0.5 * (c[i] + c[j]); };
    const Vec3 m01 = m(0, 1), m02 = m(0, 2), m03 = m(0, 3), m12 = m(1, 2), m13 = m(1, 3), m23 = m(2, 3);
    // Ends of the diagonal, and the ring of the other four about it.
    Vec3 a = m01, b = m23;
    std::array<Vec3, 4> ring{m02, m12, m13, m03};
    if ((m02 - m13).squaredNorm() < (a - b).squaredNorm()) a = m02, b = m13, ring = {m01, m03, m23, m12};
    if ((m03 - m12).squaredNorm() < (a - b).squaredNorm()) a = m03, b = m12, ring = {m01, m13, m23, m02};
    std::array<std::array<Vec3, 4>, 8> parts{
        {{c[0], m01, m02, m03}, {m01, c[1], m12, m13}, {m02, m12, c[2], m23}, {m03, m13, m23, c[3]}, {}, {}, {}, {}}};
    for (std::size_t k = 0; k < 4; ++k) {
        std::array<Vec3, 4> part{a, b, ring[k], ring[(k + 1) % 4]};
        if ((part[1] - part[0]).dot((part[2] - part[0]).cross(part[3] - part[0])) < 0) std::swap(part[0], part[1]);
        parts[4 + k] = part;
    }
    return parts;
}

/// The winding numbers on both sides of all of the triangles, if they are known and the same for all.
Solid::Sides common_sides(const Solid& solid, const std::vector<int>& triangles) {
    const Solid::Sides first = solid.sides[static_cast<std::size_t>(triangles[0])];
    const bool is_same = std::all_of(triangles.begin(), triangles.end(),
                                     [&](int t) { return solid.sides[static_cast<std::size_t>(t)] == first; });
    return is_same ? first : Solid::Sides{};
}

/// The share inside from the integral, where only the two winding numbers of `sides` occur, so that the
/// integral tells the share of each. Nothing if it lies outside of what they allow: then other numbers occur.
std::optional<double> share_between(const Solid::Sides& sides, double integral) {
    const double below = (integral - sides.above) / (sides.below - sides.above);
    const double share = sides.below != 0 ? below : 1 - below;
    if (!(share > -1e-7 && share < 1 + 1e-7)) return {};
    return share > 1 - 1e-12 ? 1.0 : std::max(share, 0.0);
}

double split_share(const Solid& solid, const std::array<Vec3, 4>& corners, const std::vector<int>& triangles,
                   int depth) {
    const auto inside_middle = [&] {
        const Vec3 middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
        return solid.tree.inside_either_way(middle) ? 1.0 : 0.0;
    };
    if (triangles.empty()) return inside_middle();
    const Solid::Sides sides = common_sides(solid, triangles);
    const bool is_simple = sides.are_known();
    if (is_simple && sides.below != 0 && sides.above != 0) return 1;
    const TetFrame frame(corners);
    if (is_simple || depth == deepest_split) {
        const double integral = winding_integral(solid, corners, frame, triangles);
        if (is_simple)
            if (const auto share = share_between(sides, integral)) return *share;
        if (depth == deepest_split)
            return std::isfinite(integral) ? std::min(std::abs(integral), 1.0) : inside_middle();
    }
    double sum = 0;
    for (const std::array<Vec3, 4>& part : split(corners)) {
        const TetFrame part_frame(part);
        std::vector<int> touching;
        for (int t : triangles)
            if (touches_tet(part_frame(solid, t), 1e-9)) touching.push_back(t);
        sum += split_share(solid, part, touching, depth + 1);
    }
    return sum / 8;
}

} // namespace

double closed_share(const Solid& solid, const std::array<Vec3, 4>& corners, const std::vector<int>& triangles) {
    return split_share(solid, corners, triangles, 0);
}

std::optional<double> share_away_from_holes(const Solid& solid, const std::array<Vec3, 4>& corners,
                                            const std::vector<int>& triangles) {
    if (triangles.empty()) return {};
    const Solid::Sides sides = common_sides(solid, triangles);
    if (!sides.are_known()) return {};
    constexpr double near_whole = 0.2;
    const auto is_whole = [&](const Vec3& p) {
        const double w = solid.winding_number(p);
        return std::abs(w - std::round(w)) < near_whole;
    };
    if (!std::all_of(corners.begin(), corners.end(), is_whole)) return {};
    if (sides.below != 0 && sides.above != 0) return 1;
    return share_between(sides, winding_integral(solid, corners, TetFrame(corners), triangles));
}

} // namespace sinew::solver
