// What presses between cloth and what it meets, and its derivatives.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/cloth_contact.h"

#include "solver/mesh/segment_math.h"
#include "solver/mesh/triangle_math.h"
#include "solver/parallel.h"
#include "solver/terms/contact/crossed.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace sinew::solver {

namespace {

/// Points or edges that are one piece of work.
constexpr std::size_t piece = 256;
/// Edges are held apart from this share of the range on: the points of sheets that lie on each other keep them farther
/// apart than that.
constexpr double edge_share = 0.5;
/// Barycentric coordinates below this are rounding's.
constexpr double none = 1e-10;

/// Whether two sides that are so far apart may have met on the straight ways of their corners: whether any corner of
/// the first `split` has gone that far as one of the others sees it. Far cheaper to tell than whether they have.
bool may_have_met(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to, std::size_t split, double distance) {
    constexpr double rounding = 1e-6; // what crossed.cpp lets pass at borders, too
    const double least = (1 - rounding) * distance;
    std::array<Vec3, 4> way;
    for (std::size_t c = 0; c < 4; ++c) way[c] = to[c] - from[c];
    for (std::size_t c = 0; c < split; ++c)
        for (std::size_t d = split; d < 4; ++d)
            if (!((way[c] - way[d]).squaredNorm() < least * least)) return true;
    return false;
}

/// The farthest that one of the first `split` corners has gone as one of the others sees it.
double farthest_way(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to, std::size_t split) {
    std::array<Vec3, 4> way;
    for (std::size_t c = 0; c < 4; ++c) way[c] = to[c] - from[c];
    double most = 0;
    for (std::size_t c = 0; c < split; ++c)
        for (std::size_t d = split; d < 4; ++d) most = std::max(most, (way[c] - way[d]).squaredNorm());
    return std::sqrt(most);
}

/// Whether the foot of a point on a triangle's plane is on the triangle, its border taken in.
bool is_above(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 u = b - a, v = c - a, w = p - a, n = u.cross(v);
    const double n2 = n.squaredNorm(), one = w.cross(v).dot(n), other = u.cross(w).dot(n);
    return std::min({one, other, n2 - one - other}) >= -none * n2;
}

} // namespace

std::array<Vec3, 4> ClothContact::corners_of(const PointFace& c, const Points& x) const {
    const Triangle& t = faces_[at(c.face)];
    return {x[at(c.point)], x[at(t[0])], x[at(t[1])], x[at(t[2])]};
}

std::array<Vec3, 4> ClothContact::corners_of(const EdgePair& c, const Points& x) const {
    const auto &one = edges_[at(c.one)], &other = edges_[at(c.other)];
    return {x[at(one[0])], x[at(one[1])], x[at(other[0])], x[at(other[1])]};
}

std::span<const RideTerm> ClothContact::ride(int corner) const {
    return bodies_[body_of(corner)].free_ride(point_of(corner));
}

ClothContact::Press ClothContact::press_of_point(int point, const Near& f, double count, const Vec3& place,
                                                 const Vec3& away, double distance) const {
    const Triangle& t = faces_[at(f.face)];
    const ContactPair& pair = pairs_[at(f.pair)];
    Press p;
    p.corners = {point, t[0], t[1], t[2]};
    p.weights = corner_weights_of(place);
    p.pair = f.pair, p.range = pair.range;
    p.face = f.face, p.side = f.side, p.through = f.through;
    p.stiffness = count * pair.stiffness * f.area;
    p.gap = f.through ? -distance : distance, p.away = away;
    if (distance > 0) p.out = (f.through ? -1 : 1) / distance * away;
    return p;
}

/// Of a pair that does not press. `distance`: by its nearest places, or 0 where only its plane is known.
double ClothContact::standoff_of(const PointFace& c, const std::array<Vec3, 4>& at_x, const Vec3& normal, double height,
                                 double distance) const {
    const Vec3 u = at_x[2] - at_x[1], v = at_x[3] - at_x[1], w = at_x[0] - at_x[1];
    const double area = normal.norm(), lever = w.norm();
    if (distance == 0) {
        // Not nearer than to the plane, nor than to a ball about the face.
        const Vec3 middle = (1.0 / 3) * (u + v);
        const double ball =
            std::sqrt(std::max({middle.squaredNorm(), (u - middle).squaredNorm(), (v - middle).squaredNorm()}));
        distance = std::max(std::abs(height) / area, (w - middle).norm() - ball);
    }
    const double range = pairs_[at(c.pair)].range;
    // Bones stay where they are within a stage, and their planes with them.
    const bool turns = bodies_[body_of(faces_[at(c.face)][0])].deforms();
    const PlaneStandoff plane{c.side * height / area, turns ? lever : 0, u.norm() + v.norm(), area};
    const double by_plane = c.side == 0 ? std::numeric_limits<double>::infinity() : plane.left();
    return standoff(distance, range, by_plane, [&] { return farthest_way(corners_of(c, start_), at_x, 1); });
}

double ClothContact::standoff_of(const EdgePair& c, const std::array<Vec3, 4>& at_x, const Vec3& normal, double height,
                                 double distance) const {
    const Vec3 u = at_x[1] - at_x[0], v = at_x[3] - at_x[2], w = at_x[2] - at_x[0];
    const double area = normal.norm(), u_length = u.norm(), v_length = v.norm();
    if (distance == 0)
        distance = std::max(std::abs(height) / area, (w + 0.5 * (v - u)).norm() - 0.5 * (u_length + v_length));
    const PlaneStandoff plane{c.side * height / area, w.norm(), u_length + v_length, area};
    const double by_plane = c.side == 0 ? std::numeric_limits<double>::infinity() : plane.left();
    return standoff(distance, edge_share * pairs_[at(c.pair)].range, by_plane,
                    [&] { return farthest_way(corners_of(c, start_), at_x, 2); });
}

/// Whether two sides have gone through each other, by the way from the start of the step: the straight one, or where
/// nothing has moved as far as any pair is apart since the solve went on from somewhere, as it was there. All pairs by
/// the same way: by different ones a point could be through two faces of a sheet at once, or through none behind it.
template <class Pair>
bool ClothContact::is_through(const Pair& c, const std::array<Vec3, 4>& at_x, bool turned, double distance) const {
    if (holds_) return c.passage.was_through();
    if (!turned) return false;
    const std::array<Vec3, 4> from = corners_of(c, start_);
    if constexpr (std::is_same_v<Pair, PointFace>)
        return may_have_met(from, at_x, 1, distance) && crosses_face(from, at_x);
    else
        return may_have_met(from, at_x, 2, distance) && crosses_edge(from, at_x);
}

void ClothContact::accept() {
    least_apart_ = std::numeric_limits<double>::infinity();
    for (PointFace& c : point_faces_) least_apart_ = std::min(least_apart_, c.passage.accept());
    for (EdgePair& c : edge_pairs_) least_apart_ = std::min(least_apart_, c.passage.accept());
    accepted_ = now_;
}

double ClothContact::closed_in(const Points& from) const {
    double most = 0;
    for (std::size_t p = 0; p < now_.size(); ++p) most = std::max(most, (now_[p] - from[p]).squaredNorm());
    return 2 * std::sqrt(most); // both sides may have moved so far
}

/// Whether all has moved less, since the solve went on from somewhere, than any pair was apart there: a straight way
/// that comes to pass by the end of an edge meanwhile would change who is through, though nothing has met.
bool ClothContact::holds() const { return !accepted_.empty() && closed_in(accepted_) < least_apart_; }

/// From where pairs were looked at last to now_.
void ClothContact::watch_moves() {
    moves_.resize(now_.size()), face_moves_.resize(faces_.size()), edge_moves_.resize(edges_.size());
    parallel_for(now_.size(), 1024, [&](std::size_t p) { moves_[p] = (now_[p] - seen_[p]).norm(); });
    parallel_for(faces_.size(), 2048, [&](std::size_t f) {
        const auto [a, b, c] = faces_[f];
        face_moves_[f] = std::max({moves_[at(a)], moves_[at(b)], moves_[at(c)]});
    });
    parallel_for(edges_.size(), 2048,
                 [&](std::size_t e) { edge_moves_[e] = std::max(moves_[at(edges_[e][0])], moves_[at(edges_[e][1])]); });
    seen_ = now_;
}

void ClothContact::presses_of_point(std::size_t first, std::size_t end, const Points& x, Scratch& s) {
    s.near.clear();
    bool any_through = false;
    const int point = point_faces_[first].point;
    const bool at_start = &x == &start_;
    const double own_move = at_start ? 0 : moves_[at(point)];
    for (std::size_t i = first; i < end; ++i) {
        PointFace& c = point_faces_[i];
        const ContactPair& pair = pairs_[at(c.pair)];
        c.passage.leave(pair.range);
        if (!at_start && c.standoff.outlasts(own_move + face_moves_[at(c.face)])) continue;
        const std::array<Vec3, 4> at_x = corners_of(c, x);
        const Vec3 n = (at_x[2] - at_x[1]).cross(at_x[3] - at_x[1]);
        const double height = n.dot(at_x[0] - at_x[1]);
        const bool turned = c.side * height < 0 && !at_start;
        if (!turned && !c.passage.was_through() && height * height >= pair.range * pair.range * n.squaredNorm()) {
            if (!at_start) c.standoff.set(standoff_of(c, at_x, n, height, 0));
            continue;
        }
        const TrianglePoint there = closest_on_triangle(at_x[0], {at_x[1], at_x[2], at_x[3]}, faces_[at(c.face)]);
        const Vec3 away = at_x[0] - there.point;
        const double distance = away.norm();
        const bool through = !at_start && is_through(c, at_x, turned, distance);
        if (!through && distance >= pair.range) {
            if (!at_start && !c.passage.was_through()) c.standoff.set(standoff_of(c, at_x, n, height, distance));
            continue;
        }
        c.standoff.forget(), c.passage.meet(through ? -distance : distance);
        s.near.push_back({c.face, c.pair, c.side, through, there.barycentric, away, distance, c.area});
        any_through = any_through || through;
    }
    if (any_through) {
        // What it has gone through draws it back; what lies about that is on the wrong side of it and says nothing.
        for (const Near& f : s.near) {
            const auto beside = [&](const Near& other) {
                const Triangle& t = faces_[at(f.face)];
                return other.through &&
                       std::ranges::any_of(faces_[at(other.face)], [&](int v) { return has_vertex(t, v); });
            };
            if (f.through || std::none_of(s.near.begin(), s.near.end(), beside))
                s.presses.push_back(press_of_point(point, f, 1, f.place, f.away, f.distance));
        }
    } else if (s.near.size() == 1) {
        const Near& f = s.near.front();
        s.presses.push_back(press_of_point(point, f, 1, f.place, f.away, f.distance));
    } else if (s.near.size() > 1) {
        count_once(point, x, s);
    }
}

/// Faces less the edges between them plus the vertices, each where it is nearest. What is nearest at the same place
/// adds up, and mostly to 1 or nothing.
void ClothContact::count_once(int point, const Points& x, Scratch& s) const {
    s.places.clear(), s.sides.clear(), s.vertices.clear();
    const auto add = [&](const Near& f, const Vec3& place, const Vec3& away, double distance, double count) {
        // What rounding leaves of a coordinate counts as none, else the places of a vertex right below would not add
        // up.
        std::array<int, 3> vertices{-1, -1, -1};
        for (std::size_t c = 0; c < 3; ++c)
            if (std::abs(place[static_cast<Eigen::Index>(c)]) > none) vertices[c] = faces_[at(f.face)][c];
        std::sort(vertices.begin(), vertices.end());
        const auto known = std::ranges::find(s.places, vertices, &Place::vertices);
        if (known == s.places.end())
            s.places.push_back({vertices, count, &f, place, away, distance});
        else
            known->count += count;
    };
    const auto count_of = [&](int v) -> double& {
        for (auto& [w, count] : s.vertices)
            if (w == v) return count;
        return s.vertices.emplace_back(v, 1.0).second;
    };
    for (const Near& f : s.near) {
        add(f, f.place, f.away, f.distance, 1);
        const Triangle& t = faces_[at(f.face)];
        for (std::size_t c = 0; c < 3; ++c) {
            count_of(t[c]) -= 1;
            const auto [v, w] = std::minmax(t[c], t[(c + 1) % 3]);
            const std::array<int, 2> edge{v, w};
            const auto known = std::ranges::find(s.sides, edge, &Side::edge);
            if (known == s.sides.end())
                s.sides.push_back({edge, 0});
            else
                known->count -= 1;
        }
    }
    for (const Side& side : s.sides)
        for (const int v : side.edge) count_of(v) -= side.count;
    const Vec3& p = x[at(point)];
    /// At a share along an edge, or a vertex alone.
    const auto add_place = [&](int v, int w, double t, const Vec3& away, double count) {
        const auto face = std::ranges::find_if(s.near, [&](const Near& f) {
            return has_vertex(faces_[at(f.face)], v) && has_vertex(faces_[at(f.face)], w);
        });
        const double distance = away.norm();
        if (distance >= pairs_[at(face->pair)].range) return;
        Vec3 place = Vec3::Zero();
        for (std::size_t c = 0; c < 3; ++c) {
            const int corner = faces_[at(face->face)][c];
            if (corner == v) place[static_cast<Eigen::Index>(c)] = 1 - t;
            if (corner == w && w != v) place[static_cast<Eigen::Index>(c)] = t;
        }
        add(*face, place, away, distance, count);
    };
    for (const auto& [edge, count] : s.sides) {
        if (count == 0) continue;
        // As closest_on_triangle walks it, so that the places are the same to the last bit.
        const Vec3 &a = x[at(edge[0])], &b = x[at(edge[1])], way = b - a;
        const double length2 = way.squaredNorm();
        const double t = length2 > 0 ? std::clamp((p - a).dot(way) / length2, 0.0, 1.0) : 0.0;
        add_place(edge[0], edge[1], t, p - (t == 0 ? a : t == 1 ? b : Vec3(a + t * way)), count);
    }
    for (const auto& [v, count] : s.vertices)
        if (count != 0) add_place(v, v, 0, p - x[at(v)], count);
    for (const Place& q : s.places)
        if (q.count != 0) {
            s.presses.push_back(press_of_point(point, *q.face, q.count, q.place, q.away, q.distance));
            s.presses.back().bends = std::ranges::none_of(s.near, [&](const Near& f) {
                const Triangle& t = faces_[at(f.face)];
                const bool meets = std::ranges::all_of(q.vertices, [&](int v) { return v < 0 || has_vertex(t, v); });
                return q.count > 0 && q.vertices.front() < 0 && meets &&
                       is_above(p, x[at(t[0])], x[at(t[1])], x[at(t[2])]);
            });
        }
}

void ClothContact::press_of_edges(EdgePair& c, const Points& x, std::vector<Press>& out) const {
    const bool at_start = &x == &start_;
    const double range = edge_share * pairs_[at(c.pair)].range;
    c.passage.leave(range);
    if (!at_start && c.standoff.outlasts(edge_moves_[at(c.one)] + edge_moves_[at(c.other)])) return;
    const std::array<Vec3, 4> at_x = corners_of(c, x);
    const Vec3 one = at_x[1] - at_x[0], other = at_x[3] - at_x[2], n = one.cross(other);
    const double height = n.dot(at_x[2] - at_x[0]);
    const bool turned = c.side * height < 0 && !at_start;
    constexpr double parallel = 1e-12; // squared sine: no plane between them says how far apart they are
    const bool askew = n.squaredNorm() > parallel * one.squaredNorm() * other.squaredNorm();
    if (!turned && !c.passage.was_through() && askew && height * height >= range * range * n.squaredNorm()) {
        if (!at_start) c.standoff.set(standoff_of(c, at_x, n, height, 0));
        return;
    }
    const SegmentPair there = closest_of_segments(at_x[0], at_x[1], at_x[2], at_x[3]);
    const double distance = there.away.norm();
    const bool through = !at_start && is_through(c, at_x, turned, distance);
    if (!through && distance >= range) {
        if (!at_start && !c.passage.was_through()) c.standoff.set(standoff_of(c, at_x, n, height, distance));
        return;
    }
    c.standoff.forget(), c.passage.meet(through ? -distance : distance);
    Press p;
    const auto &e = edges_[at(c.one)], &f = edges_[at(c.other)];
    p.corners = {e[0], e[1], f[0], f[1]};
    p.weights = {1 - there.s, there.s, there.t - 1, -there.t};
    p.split = 2, p.pair = c.pair, p.range = range, p.through = through;
    const double area = edge_areas_[at(c.one)], other_area = edge_areas_[at(c.other)];
    // Of faces without area there may be nothing on either side.
    p.stiffness = area > 0 ? pairs_[at(c.pair)].stiffness * 2 * area * other_area / (area + other_area) : 0;
    p.gap = through ? -distance : distance, p.away = there.away;
    if (distance > 0) p.out = (through ? -1 : 1) / distance * there.away;
    out.push_back(p);
}

void ClothContact::find_presses(const Points& x, std::vector<Press>& out) {
    const std::size_t points = point_starts_.empty() ? 0 : point_starts_.size() - 1;
    const std::size_t of_points = (points + piece - 1) / piece, of_edges = (edge_pairs_.size() + piece - 1) / piece;
    if (scratch_.size() < of_points + of_edges) scratch_.resize(of_points + of_edges);
    parallel_for(of_points + of_edges, 1, [&](std::size_t k) {
        Scratch& s = scratch_[k];
        s.presses.clear();
        const std::size_t first = (k < of_points ? k : k - of_points) * piece;
        if (k < of_points)
            for (std::size_t i = first; i < std::min(points, first + piece); ++i)
                presses_of_point(point_starts_[i], point_starts_[i + 1], x, s);
        else
            for (std::size_t i = first; i < std::min(edge_pairs_.size(), first + piece); ++i)
                press_of_edges(edge_pairs_[i], x, s.presses);
    });
    out.clear();
    for (std::size_t k = 0; k < of_points + of_edges; ++k)
        out.insert(out.end(), scratch_[k].presses.begin(), scratch_[k].presses.end());
}

void ClothContact::find_presses(const std::vector<Points>& places, std::vector<Press>& out) {
    gather(places, now_);
    watch_moves();
    holds_ = holds();
    find_presses(now_, out);
}

void ClothContact::find_presses_at_start(std::vector<Press>& out) { find_presses(start_, out); }

/// With the gap's own second derivatives g'': rise n n^T - force g''.
PointTriangleBlocks ClothContact::hessian(const Press& p, const std::vector<Points>& places, bool project) const {
    constexpr double least_gap = 1e-6; // of the range; nearer than that rounding is all that g'' would be made of
    PointTriangleBlocks out;
    std::size_t entry = 0;
    const Mat3 square = p.out * p.out.transpose();
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t d = c; d < 4; ++d, ++entry) out[entry] = p.weights[c] * p.weights[d] * square;
    const auto without_bend = [&] {
        for (Mat3& block : out) block *= p.rise();
        return out;
    };
    if (project || !p.bends || std::abs(p.gap) < least_gap * p.range) return without_bend();
    // Of half the squared distance, f(x, s) at its minimum over the places s: f_xx - f_xs f_ss^-1 f_sx.
    std::array<Vec3, 4> x;
    for (std::size_t c = 0; c < 4; ++c) x[c] = place(p.corners[c], places);
    PointTriangleBlocks whole;
    if (p.split == 1) {
        const Vec3 at_face(-p.weights[1], -p.weights[2], -p.weights[3]);
        whole = point_triangle_hessian({x[1], x[2], x[3]}, at_face, p.away, false);
    } else {
        const std::array<double, 4> by[2] = {{-1, 1, 0, 0}, {0, 0, 1, -1}}; // of the weights, by the places
        Vec3 along[2];
        const std::array<double, 4>* moves[2];
        Eigen::Index ways = 0;
        for (std::size_t w = 0; w < 2; ++w) {
            if (p.weights[2 * w] == 0 || p.weights[2 * w + 1] == 0) continue; // at an end of the edge
            moves[ways] = &by[w];
            along[ways++] = by[w][0] * x[0] + by[w][1] * x[1] + by[w][2] * x[2] + by[w][3] * x[3];
        }
        Eigen::Matrix2d inner = Eigen::Matrix2d::Identity();
        for (Eigen::Index v = 0; v < ways; ++v)
            for (Eigen::Index w = 0; w < ways; ++w) inner(v, w) = along[v].dot(along[w]);
        const double det = inner.determinant();
        if (!(det > 1e-12 * inner(0, 0) * inner(1, 1))) return without_bend(); // parallel
        const Eigen::Matrix2d inverse = inner.inverse();
        entry = 0;
        const auto mixed = [&](std::size_t c, Eigen::Index w) {
            return Vec3(p.weights[c] * along[w] + (*moves[w])[c] * p.away);
        };
        for (std::size_t c = 0; c < 4; ++c)
            for (std::size_t d = c; d < 4; ++d, ++entry) {
                whole[entry] = p.weights[c] * p.weights[d] * Mat3::Identity();
                for (Eigen::Index v = 0; v < ways; ++v)
                    for (Eigen::Index w = 0; w < ways; ++w)
                        whole[entry] -= inverse(v, w) * mixed(c, v) * mixed(d, w).transpose();
            }
    }
    // The gap's own second derivatives are (whole - n n^T)/gap.
    for (std::size_t b = 0; b < out.size(); ++b) out[b] = p.rise() * out[b] - p.force() / p.gap * (whole[b] - out[b]);
    return out;
}

} // namespace sinew::solver
