// Exact share of a tet inside a closed surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/tet_share.h"

#include "solver/ties.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace sinew::solver {
namespace {

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

namespace {

/// Calls add(signed volume, four corners) for each of the tets that a triangle's term is made of.
template <class Add>
void add_pieces(const BarycentricTriangle& triangle, int reference_corner, const Add& add) {
    // Even permutations that bring the reference corner to place 1: the counted edge runs from corner 1 to
    // corner 2.
    constexpr std::size_t order[4][4] = {{1, 0, 3, 2}, {0, 1, 2, 3}, {3, 2, 1, 0}, {2, 3, 0, 1}};
    const auto& o = order[reference_corner];
    BarycentricTriangle turned;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < 4; ++k) turned[c][k] = triangle[c][o[k]];

    const Polygon polygon = clip_to_tet(turned, 0);
    const auto add_turned = [&](double volume, const Barycentric& a, const Barycentric& b, const Barycentric& c,
                                const Barycentric& d) {
        std::array<Barycentric, 4> piece;
        for (std::size_t k = 0; k < 4; ++k) piece[0][o[k]] = a[k], piece[1][o[k]] = b[k];
        for (std::size_t k = 0; k < 4; ++k) piece[2][o[k]] = c[k], piece[3][o[k]] = d[k];
        add(volume, piece);
    };
    constexpr Barycentric origin{1, 0, 0, 0}, face_origin{0, 0, 0, 1}, edge_end{0, 0, 1, 0};
    for (int i = 1; i + 1 < polygon.size; ++i) {
        const Barycentric &p = polygon.corner[0], &q = polygon.corner[i], &r = polygon.corner[i + 1];
        add_turned(determinant(p, q, r), origin, p, q, r);
    }
    for (int i = 0; i < polygon.size; ++i) {
        const int next = i + 1 < polygon.size ? i + 1 : 0;
        const Barycentric &p = polygon.corner[i], &q = polygon.corner[next];
        if (polygon.tag[i] != 0) continue;
        // The face's piece runs along the same segment in the opposite direction.
        add_turned(q[1] * p[2] - q[2] * p[1], origin, face_origin, p, q);
        if (polygon.tag[next] == 3) // the counted edge leaves the solid here
            add_turned(-(1 - q[2]), origin, face_origin, q, edge_end);
        const int before = i > 0 ? i - 1 : polygon.size - 1;
        if (polygon.tag[before] == 3) // and here it enters
            add_turned(1 - p[2], origin, face_origin, p, edge_end);
    }
}

} // namespace

double share_of_triangle(const BarycentricTriangle& triangle, int reference_corner, TetMoments* moments) {
    double share = 0;
    add_pieces(triangle, reference_corner, [&](double volume, const std::array<Barycentric, 4>& piece) {
        share += volume;
        if (moments) moments->add(piece, volume);
    });
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

/// Where a corner tells nothing; `edge` is the length of one of a tet there.
bool is_on_surface(const Solid& solid, const Vec3& corner, double edge) {
    return solid.tree.closest(corner, 1e-7 * edge).triangle >= 0;
}

/// The winding number at a corner, whole; NaN on the surface.
double corner_winding(const Solid& solid, const Vec3& corner, double edge) {
    return is_on_surface(solid, corner, edge) ? std::nan("") : std::round(solid.winding_number(corner));
}

/// Integral of the winding number over the tet, per volume; NaN if every corner lies on the surface. Adds to
/// `moments`, where wanted, those of the winding number. `known`: corner_winding of each, where it is known.
double winding_integral(const Solid& solid, const std::array<Vec3, 4>& corners, const TetFrame& frame,
                        const std::vector<int>& triangles, TetMoments* moments,
                        const std::array<double, 4>* known = nullptr) {
    const double edge = (corners[1] - corners[0]).norm();
    for (int reference = 0; reference < 4; ++reference) {
        const auto i = static_cast<std::size_t>(reference);
        double integral = known ? (*known)[i] : corner_winding(solid, corners[i], edge);
        if (std::isnan(integral)) continue;
        if (moments) moments->add(whole_moments(moments->degree), integral);
        for (int t : triangles) integral += share_of_triangle(frame(solid, t), reference, moments);
        return integral;
    }
    return std::nan("");
}

/// A tet, and where its corners lie in the tet that it is part of.
struct Part {
    std::array<Vec3, 4> corners;
    std::array<Barycentric, 4> place{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    double volume = 1; ///< share of the tet that it is part of
};

/// The eight tets between the corners and the midpoints of the edges. The inner octahedron is cut along the
/// shortest of its diagonals, which keeps the parts of a lattice tet alike.
std::array<Part, 8> split(const Part& whole) {
    const std::array<Vec3, 4>& c = whole.corners;
    // Points 0…3 are the corners, then the middles of edges 01 02 03 12 13 23.
    constexpr std::size_t ends[10][2] = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {0, 1},
                                         {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    std::array<Vec3, 10> point;
    for (std::size_t i = 0; i < 10; ++i) point[i] = i < 4 ? c[i] : Vec3(0.5 * (c[ends[i][0]] + c[ends[i][1]]));
    enum : std::size_t { m01 = 4, m02, m03, m12, m13, m23 };
    // Ends of the diagonal, and the ring of the other four about it.
    std::size_t a = m01, b = m23;
    std::array<std::size_t, 4> ring{m02, m12, m13, m03};
    const auto length = [&](std::size_t i, std::size_t j) { return (point[i] - point[j]).squaredNorm(); };
    if (clearly_less(length(m02, m13), length(a, b))) a = m02, b = m13, ring = {m01, m03, m23, m12};
    if (clearly_less(length(m03, m12), length(a, b))) a = m03, b = m12, ring = {m01, m13, m23, m02};
    std::array<std::array<std::size_t, 4>, 8> numbers{
        {{0, m01, m02, m03}, {m01, 1, m12, m13}, {m02, m12, 2, m23}, {m03, m13, m23, 3}, {}, {}, {}, {}}};
    for (std::size_t k = 0; k < 4; ++k) {
        numbers[4 + k] = {a, b, ring[k], ring[(k + 1) % 4]};
        const Vec3 &p = point[a], &q = point[b], &r = point[ring[k]], &s = point[ring[(k + 1) % 4]];
        if ((q - p).dot((r - p).cross(s - p)) < 0) std::swap(numbers[4 + k][0], numbers[4 + k][1]);
    }
    std::array<Part, 8> parts;
    for (std::size_t part = 0; part < 8; ++part)
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t number = numbers[part][k];
            parts[part].corners[k] = point[number];
            for (std::size_t i = 0; i < 4; ++i)
                parts[part].place[k][i] = 0.5 * (whole.place[ends[number][0]][i] + whole.place[ends[number][1]][i]);
            parts[part].volume = whole.volume / 8;
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

/// Adds moments in the coordinates of a part, or `share` of the whole part, to those of the tet it belongs to.
void add_part(const Part& part, double share, TetMoments* sum) {
    if (sum && share > 0) sum->add(part.place, share * part.volume);
}
void add_part(const Part& part, const TetMoments& inside, TetMoments& sum) {
    // The part's monomials, in which each of its coordinates stands for a corner, are put together again.
    if (sum.degree == 1) {
        for (std::size_t c = 0; c < 4; ++c)
            for (std::size_t k = 0; k < 4; ++k) sum.value[c] += part.volume * part.place[k][c] * inside.value[k];
        return;
    }
    for (std::size_t m = 0; m < most_moments; ++m) {
        // Product of four coordinates of the tet, each a sum over the corners of the part.
        std::array<std::size_t, 4> factor;
        std::size_t next = 0;
        for (std::size_t c = 0; c < 4; ++c)
            for (int e = 0; e < quartic_exponents[m][c]; ++e) factor[next++] = c;
        double total = 0;
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < 4; ++j)
                for (std::size_t k = 0; k < 4; ++k)
                    for (std::size_t l = 0; l < 4; ++l)
                        total += part.place[i][factor[0]] * part.place[j][factor[1]] * part.place[k][factor[2]] *
                                 part.place[l][factor[3]] * inside.value[quartic_index(i, j, k, l)];
        sum.value[m] += part.volume * total;
    }
}

/// Moments inside, from those of the winding number where only the two numbers of `sides` occur.
void add_between(const Solid::Sides& sides, const Part& part, const TetMoments& winding, double share,
                 TetMoments& sum) {
    if (share <= 0 || share >= 1) return add_part(part, share, &sum);
    const double jump = sides.below - sides.above, sign = sides.below != 0 ? 1 : -1;
    TetMoments inside;
    inside.degree = winding.degree;
    inside.add(winding, sign / jump);
    inside.add(whole_moments(winding.degree), (sides.below != 0 ? 0 : 1) - sign * sides.above / jump);
    if (part.volume == 1) return sum.add(inside, 1);
    add_part(part, inside, sum);
}

double split_share(const Solid& solid, const Part& part, const std::vector<int>& triangles, int depth,
                   TetMoments* moments, const std::array<double, 4>* known = nullptr) {
    const std::array<Vec3, 4>& corners = part.corners;
    const auto as_whole = [&](double share) {
        add_part(part, share, moments);
        return share;
    };
    const auto inside_middle = [&] {
        const Vec3 middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
        return solid.tree.inside_either_way(middle) ? 1.0 : 0.0;
    };
    if (triangles.empty()) {
        if (known && !std::isnan((*known)[0])) return as_whole((*known)[0] != 0 ? 1 : 0);
        return as_whole(inside_middle());
    }
    const Solid::Sides sides = common_sides(solid, triangles);
    const bool is_simple = sides.are_known();
    if (is_simple && sides.below != 0 && sides.above != 0) return as_whole(1);
    const TetFrame frame(corners);
    if (is_simple || depth == deepest_split) {
        TetMoments winding;
        if (moments) winding.degree = moments->degree;
        const double integral = winding_integral(solid, corners, frame, triangles, moments ? &winding : nullptr, known);
        if (is_simple)
            if (const auto share = share_between(sides, integral)) {
                if (moments) add_between(sides, part, winding, *share, *moments);
                return *share;
            }
        if (depth == deepest_split)
            return as_whole(std::isfinite(integral) ? std::min(std::abs(integral), 1.0) : inside_middle());
    }
    double sum = 0;
    for (const Part& piece : split(part)) {
        sum += split_share(solid, piece, touching_triangles(solid, piece.corners, triangles), depth + 1, moments);
    }
    return sum / 8;
}

} // namespace

std::vector<int> touching_triangles(const Solid& solid, const std::array<Vec3, 4>& corners,
                                    const std::vector<int>& candidates) {
    const TetFrame frame(corners);
    std::vector<int> found;
    for (int t : candidates)
        if (touches_tet(frame(solid, t), touch_slack)) found.push_back(t);
    return found;
}

double closed_share(const Solid& solid, const std::array<Vec3, 4>& corners, const std::vector<int>& triangles,
                    TetMoments* moments) {
    return split_share(solid, {corners}, triangles, 0, moments);
}

double share_of_simple(const Solid& solid, const std::array<Vec3, 4>& corners, const std::vector<int>& triangles) {
    const double integral = winding_integral(solid, corners, TetFrame(corners), triangles, nullptr);
    if (triangles.empty() || std::isnan(integral)) return closed_share(solid, corners, triangles);
    return std::clamp(integral, 0.0, 1.0);
}

std::vector<double> corner_windings(const Solid& solid, const Points& corners, const std::vector<double>& edges) {
    std::vector<double> out = solid.tree.winding_numbers(corners);
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = is_on_surface(solid, corners[i], edges[i]) ? std::nan("") : std::round(out[i]);
    return out;
}

double closed_share(const Solid& solid, const std::array<Vec3, 4>& corners, const std::vector<int>& triangles,
                    const std::array<double, 4>& windings) {
    return split_share(solid, {corners}, triangles, 0, nullptr, &windings);
}

namespace {

Vec3 point_at(const std::array<Vec3, 4>& corners, const Barycentric& b) {
    return b[0] * corners[0] + b[1] * corners[1] + b[2] * corners[2] + b[3] * corners[3];
}

/// The integral over the tet of the winding number of `a` where `b` is, per volume: each of the signed tets that
/// winding_integral is a sum of counts with its own share in b. Nothing if every corner lies on a.
std::optional<double> winding_integral_in(const Solid& a, const Solid& b, const std::array<Vec3, 4>& corners,
                                          const std::vector<int>& triangles_a, const std::vector<int>& triangles_b,
                                          double share_b) {
    constexpr double least_piece = 1e-10; // of less there is nothing to be known but rounding
    const TetFrame frame(corners);
    const double edge = (corners[1] - corners[0]).norm();
    for (int reference = 0; reference < 4; ++reference) {
        double integral = corner_winding(a, corners[static_cast<std::size_t>(reference)], edge) * share_b;
        if (std::isnan(integral)) continue;
        for (int t : triangles_a)
            add_pieces(frame(a, t), reference, [&](double volume, const std::array<Barycentric, 4>& piece) {
                if (!(std::abs(volume) > least_piece)) return;
                std::array<Vec3, 4> part;
                for (std::size_t k = 0; k < 4; ++k) part[k] = point_at(corners, piece[k]);
                if ((part[1] - part[0]).dot((part[2] - part[0]).cross(part[3] - part[0])) < 0)
                    std::swap(part[2], part[3]);
                integral += volume * closed_share(b, part, touching_triangles(b, part, triangles_b));
            });
        return integral;
    }
    return {};
}

double split_share_of_both(const Solid& a, const Solid& b, const Part& part, const std::vector<int>& triangles_a,
                           const std::vector<int>& triangles_b, int depth) {
    const double share_b = closed_share(b, part.corners, triangles_b);
    if (share_b == 0) return 0;
    const double share_a = closed_share(a, part.corners, triangles_a);
    if (share_a == 0 || share_b == 1) return share_a;
    if (share_a == 1) return share_b;
    const Solid::Sides sides = common_sides(a, triangles_a);
    if (sides.are_known())
        if (const auto w = winding_integral_in(a, b, part.corners, triangles_a, triangles_b, share_b)) {
            const double below = (*w - sides.above * share_b) / (sides.below - sides.above);
            const double both = sides.below != 0 ? below : share_b - below;
            if (both > -1e-7 && both < std::min(share_a, share_b) + 1e-7)
                return std::clamp(both, 0.0, std::min(share_a, share_b));
        }
    if (depth == deepest_split) return share_a * share_b;
    double sum = 0;
    for (const Part& piece : split(part))
        sum += split_share_of_both(a, b, piece, touching_triangles(a, piece.corners, triangles_a),
                                   touching_triangles(b, piece.corners, triangles_b), depth + 1);
    return sum / 8;
}

} // namespace

double share_of_both(const Solid& a, const Solid& b, const std::array<Vec3, 4>& corners,
                     const std::vector<int>& triangles_a, const std::vector<int>& triangles_b) {
    // The signed tets are those of the surface whose triangles all part inside from outside, if one does.
    if (triangles_a.empty() || !common_sides(a, triangles_a).are_known())
        return split_share_of_both(b, a, {corners}, triangles_b, triangles_a, 0);
    return split_share_of_both(a, b, {corners}, triangles_a, triangles_b, 0);
}

std::optional<double> share_away_from_holes(const Solid& solid, const std::array<Vec3, 4>& corners,
                                            const std::vector<int>& triangles, TetMoments* moments) {
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
    TetMoments winding;
    if (moments) winding.degree = moments->degree;
    const auto share = share_between(
        sides, winding_integral(solid, corners, TetFrame(corners), triangles, moments ? &winding : nullptr));
    if (share && moments) add_between(sides, {corners}, winding, *share, *moments);
    return share;
}

} // namespace sinew::solver
