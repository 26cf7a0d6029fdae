// Which points and faces, and which edges, may meet within a step. Boxes of where things are, and of the ways that they
// go: what moves along with its neighbours is as far from them as it was, however far all go.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/segment_math.h"
#include "solver/mesh/triangle_math.h"
#include "solver/parallel.h"
#include "solver/term/closest_feature.h"
#include "solver/terms/contact/cloth_contact.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace sinew::solver {

namespace {

/// Things are looked for as if they came nearer by this share of the mean edge.
constexpr double resting_share = 0.25;
/// Points or edges that are one piece of work.
constexpr std::size_t piece = 64;
/// What balls do not meet within is surely too far away, whatever rounding does.
constexpr double more = 1 + 1e-9;

double triple(const Vec3& a, const Vec3& b, const Vec3& c) { return a.cross(b).dot(c); }
int sign_of(double v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

/// Whether things in a box, that go ways in another box, may come within reach of those of a node.
bool may_meet(const BvhNode& node, const BvhNode& ways, const Vec3& low, const Vec3& high, const Vec3& least_way,
              const Vec3& most_way, double reach) {
    const double apart2 = (node.min - high).cwiseMax(low - node.max).cwiseMax(0.0).squaredNorm();
    if (apart2 <= reach * reach) return true;
    const double nearer2 = (most_way - ways.min).cwiseMax(ways.max - least_way).cwiseMax(0.0).squaredNorm();
    if (apart2 > 2 * (reach * reach + nearer2)) return false; // more than the square of the sum: no root for most
    const double far = reach + std::sqrt(nearer2);
    return apart2 <= far * far;
}

/// Calls visit(item) for those of a tree that something in a box may meet, but for nodes that are left out.
template <class LeaveOut, class Visit>
void visit_near(const Bvh& tree, const std::vector<BvhNode>& boxes, const std::vector<BvhNode>& ways, const Vec3& low,
                const Vec3& high, const Vec3& least_way, const Vec3& most_way, double reach, const LeaveOut& leave_out,
                const Visit& visit) {
    int stack[128]; // the tree of 2^31 items is 30 levels deep
    int depth = 0;
    if (!boxes.empty()) stack[depth++] = 0;
    while (depth > 0) {
        const int n = stack[--depth];
        if (leave_out(n)) continue;
        const BvhNode& node = boxes[at(n)];
        if (!may_meet(node, ways[at(n)], low, high, least_way, most_way, reach)) continue;
        if (node.count == 0) stack[depth++] = n + 1, stack[depth++] = node.first;
        for (int i = node.first; i < node.first + node.count; ++i) visit(tree.order[at(i)]);
    }
}

/// Of points and faces, or of edges, that may meet within a step: a gigabyte.
constexpr std::size_t most_items = 10'000'000;

/// make(i, items) for i below a count on any number of threads, and what was made in order. `parts` is room to keep:
/// one thread works at a time on those of one piece.
/// Throws Error FE308 if there are more than `most_items`.
template <class Item, class Make>
void gather_in_order(std::size_t count, std::vector<std::vector<Item>>& parts, std::vector<Item>& out,
                     const Make& make) {
    parts.resize((count + piece - 1) / piece);
    std::atomic<std::size_t> made = 0;
    parallel_for(parts.size(), 1, [&](std::size_t k) {
        parts[k].clear();
        for (std::size_t i = k * piece; i < std::min(count, (k + 1) * piece) && made <= most_items; ++i) {
            const std::size_t before = parts[k].size();
            make(i, parts[k]);
            made += parts[k].size() - before;
        }
    });
    out.clear();
    if (made > most_items) {
        parts.clear();
        throw Error("FE308",
                    "more than " + std::to_string(most_items) +
                        " pairs of points and faces, or of edges, of cloth and what it meets are in reach of each "
                        "other within one step",
                    "Choose a smaller thickness, larger faces, or more substeps where things move fast.");
    }
    for (const auto& part : parts) out.insert(out.end(), part.begin(), part.end());
}

/// Of a face's or an edge's corners.
template <std::size_t n>
double radius_about(const Vec3& middle, const std::array<Vec3, n>& corners) {
    double most = 0;
    for (const Vec3& c : corners) most = std::max(most, (c - middle).squaredNorm());
    return std::sqrt(most);
}

void grow(BvhNode& node, const Vec3& p) { node.min = node.min.cwiseMin(p), node.max = node.max.cwiseMax(p); }

} // namespace

ClothContact::ClothContact(const Scene&, const CollisionBodies& bodies)
    : bodies_(bodies) {
    const auto is_thick = [&](std::size_t b) { return bodies.rest(static_cast<int>(b)).thickness > 0; };
    bool any = false;
    for (std::size_t b = 0; b < bodies.count(); ++b) any = any || is_thick(b);
    double edges = 0, count = 0;
    for (std::size_t b = 0; b < bodies.count() && any; ++b) {
        const int body = static_cast<int>(b);
        const CollisionBody& surface = bodies[body];
        const int first = static_cast<int>(modelled_.size());
        members_.push_back({body, first, static_cast<int>(faces_.size())});
        member_of_.resize(member_of_.size() + surface.point_count(), body);
        modelled_.insert(modelled_.end(), surface.modelled().begin(), surface.modelled().end());
        for (const Triangle& t : surface.triangles()) faces_.push_back({t[0] + first, t[1] + first, t[2] + first});
        if (!is_thick(b)) continue;
        edges += surface.mean_edge() * static_cast<double>(surface.triangles().size());
        count += static_cast<double>(surface.triangles().size());
    }
    mean_edge_ = count > 0 ? edges / count : 0;
    areas_.assign(modelled_.size(), 0.0);
    std::vector<std::pair<std::array<int, 2>, double>> sides;
    Points low, high;
    for (const auto& [a, b, c] : faces_) {
        const Vec3 &p = modelled_[at(a)], &q = modelled_[at(b)], &r = modelled_[at(c)];
        const double third = (q - p).cross(r - p).norm() / 6;
        for (const int v : {a, b, c}) areas_[at(v)] += third;
        for (const auto& [v, w] : {std::pair(a, b), {b, c}, {c, a}})
            sides.push_back({{std::min(v, w), std::max(v, w)}, third});
        low.push_back(p.cwiseMin(q).cwiseMin(r)), high.push_back(p.cwiseMax(q).cwiseMax(r));
    }
    for (const auto& [a, b, c] : faces_) face_points_.push_back((areas_[at(a)] + areas_[at(b)] + areas_[at(c)]) / 3);
    // The mean over its surface.
    std::vector<double> sums(members_.size()), squares(members_.size());
    for (std::size_t p = 0; p < areas_.size(); ++p)
        sums[at(member_of_[p])] += areas_[p], squares[at(member_of_[p])] += areas_[p] * areas_[p];
    for (std::size_t m = 0; m < members_.size(); ++m) members_[m].usual_area = sums[m] > 0 ? squares[m] / sums[m] : 0;
    face_tree_ = build_bvh(low, high);
    std::sort(sides.begin(), sides.end());
    low.clear(), high.clear();
    for (const auto& [edge, area] : sides) {
        if (edges_.empty() || edges_.back() != edge) {
            edges_.push_back(edge), edge_areas_.push_back(0);
            low.push_back(modelled_[at(edge[0])].cwiseMin(modelled_[at(edge[1])]));
            high.push_back(modelled_[at(edge[0])].cwiseMax(modelled_[at(edge[1])]));
        }
        edge_areas_.back() += area;
    }
    edge_tree_ = build_bvh(low, high);
    for (std::size_t e = 0; e < edges_.size(); ++e)
        if (e == 0 || edges_[e][0] != edges_[e - 1][0]) edge_fans_.push_back(e);
    edge_fans_.push_back(edges_.size());
    last_edges_.resize(edge_tree_.nodes.size());
    for (std::size_t n = edge_tree_.nodes.size(); n-- > 0;) {
        const BvhNode& node = edge_tree_.nodes[n];
        int& last = last_edges_[n] = -1;
        if (node.count == 0) last = std::max(last_edges_[n + 1], last_edges_[at(node.first)]);
        for (int i = node.first; i < node.first + node.count; ++i) last = std::max(last, edge_tree_.order[at(i)]);
    }
}

void ClothContact::gather(const std::vector<Points>& places, Points& out) const {
    out.resize(modelled_.size());
    for (const Member& m : members_)
        std::copy(places[at(m.body)].begin(), places[at(m.body)].end(), out.begin() + m.first_point);
}

void ClothContact::begin(const std::vector<ContactPair>& pairs,
                         const std::vector<std::array<std::vector<char>, 2>>& held, const std::vector<Points>& places,
                         const std::vector<Lost>& lost) {
    pairs_ = pairs, held_ = held, lost_ = lost, start_places_ = places;
    pair_of_members_.assign(members_.size() * members_.size(), -1);
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        const std::size_t a = at(pairs_[p].source), b = at(pairs_[p].target); // all bodies are members
        pair_of_members_[a * members_.size() + b] = pair_of_members_[b * members_.size() + a] = static_cast<int>(p);
    }
    gather(places, start_);
    seen_ = start_;
    margin_ = resting_share * mean_edge_;
}

bool ClothContact::is_lost(int point, int target_member) const {
    const Lost lost{body_of(point), point_of(point), members_[at(target_member)].body};
    return std::binary_search(lost_.begin(), lost_.end(), lost);
}

bool ClothContact::is_held(int pair, int corner) const {
    const ContactPair& p = pairs_[at(pair)];
    const std::vector<char>& flags = held_[at(pair)][body_of(corner) == p.source ? 0 : 1];
    return !flags.empty() && flags[at(point_of(corner))];
}

bool ClothContact::covers(const std::vector<Points>& places) const {
    gather(places, now_);
    return closed_in(later_) <= margin_;
}

void ClothContact::search(const std::vector<Points>& later) {
    gather(later, later_);
    accepted_.clear();
    point_faces_.clear(), edge_pairs_.clear();
    double range = 0;
    for (const ContactPair& p : pairs_) range = std::max(range, p.range);
    if (!pairs_.empty()) find_point_faces(range + margin_), find_edge_pairs(0.5 * range + margin_);
    point_starts_.clear();
    for (std::size_t i = 0; i < point_faces_.size(); ++i)
        if (i == 0 || point_faces_[i].point != point_faces_[i - 1].point) point_starts_.push_back(i);
    point_starts_.push_back(point_faces_.size());
}

void ClothContact::find_point_faces(double reach) {
    refit(face_tree_, boxes_, [&](int f, BvhNode& node) {
        for (const int v : faces_[at(f)]) grow(node, start_[at(v)]);
    });
    refit(face_tree_, ways_, [&](int f, BvhNode& node) {
        for (const int v : faces_[at(f)]) grow(node, way_of(v));
    });
    balls_.resize(faces_.size());
    parallel_for(faces_.size(), 512, [&](std::size_t f) {
        std::array<Vec3, 3> at_start, ways;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t v = at(faces_[f][c]);
            at_start[c] = start_[v], ways[c] = later_[v] - start_[v];
        }
        Ball& b = balls_[f];
        b.middle = (at_start[0] + at_start[1] + at_start[2]) / 3, b.way = (ways[0] + ways[1] + ways[2]) / 3;
        b.radius = radius_about(b.middle, at_start), b.spread = radius_about(b.way, ways);
    });
    inside_.assign(modelled_.size(), 0);
    gather_in_order(modelled_.size(), face_parts_, point_faces_, [&](std::size_t p, std::vector<PointFace>& out) {
        const Vec3 &here = start_[p], way = later_[p] - here;
        const std::size_t first = out.size();
        const int point = static_cast<int>(p);
        const auto none = [](int) { return false; };
        visit_near(face_tree_, boxes_, ways_, here, here, way, way, reach, none, [&](int f) {
            const Ball& ball = balls_[at(f)];
            const double most = reach + (way - ball.way).norm() + ball.spread + ball.radius;
            if ((here - ball.middle).squaredNorm() > more * most * most) return;
            const Triangle& t = faces_[at(f)];
            const int pair = pair_of(point, t[0]);
            if (pair < 0 || has_vertex(t, point)) return;
            double nearer = 0;
            for (const int v : t) nearer = std::max(nearer, (way - way_of(v)).squaredNorm());
            const double far = reach + std::sqrt(nearer);
            const std::array<Vec3, 3> c{start_[at(t[0])], start_[at(t[1])], start_[at(t[2])]};
            if ((here - closest_on_triangle(here, c, t).point).squaredNorm() > far * far) return;
            if (is_held(pair, point)) return;
            if (is_lost(point, member_of_[at(t[0])])) return;
            if (member_of_[p] == member_of_[at(t[0])]) {
                // Meshes finer than the sheet is thick: neighbours are no layers.
                const double r = pairs_[at(pair)].range;
                const std::array<Vec3, 3> m{modelled_[at(t[0])], modelled_[at(t[1])], modelled_[at(t[2])]};
                if ((modelled_[p] - closest_on_triangle(modelled_[p], m, t).point).squaredNorm() < r * r) return;
            }
            PointFace& found = out.emplace_back();
            found.point = point, found.face = f, found.pair = pair;
            found.side = sign_of(triple(c[1] - c[0], c[2] - c[0], here - c[0]));
        });
        std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                  [](const PointFace& a, const PointFace& b) { return a.face < b.face; });
        judge_by_nearest(point, out, first);
    });
}

/// The area that a point stands for against a body: the points of both sheets press, and each counts in part, as those
/// of solids do. By the points about the place that is nearest at the start of the step, if that is near enough to
/// press, else by the body's usual ones: the same on all of its faces, else the energy would jump where the point goes
/// from one face to the next, and a solve that ends there has no lower place and no balance; and the same however far
/// was searched.
double ClothContact::share(int point, const PointFace& nearest, double distance2) const {
    const double range = pairs_[at(nearest.pair)].range;
    const double others = distance2 < range * range
                              ? face_points_[at(nearest.face)]
                              : members_[at(member_of_[at(faces_[at(nearest.face)][0])])].usual_area;
    const double own = areas_[at(point)];
    return own * others * others / (own * own + others * others);
}

/// By the place of each body that is nearest at the start of the step. What of a solid is near to a point that is
/// inside of it then says nothing: it got there otherwise, and leaves where it likes.
void ClothContact::judge_by_nearest(int point, std::vector<PointFace>& found, std::size_t first) {
    const Vec3& p = start_[at(point)];
    for (std::size_t i = first; i < found.size();) {
        const int member = member_of_[at(faces_[at(found[i].face)][0])];
        const int body = members_[at(member)].body;
        std::size_t end = i;
        double nearest2 = std::numeric_limits<double>::infinity();
        TrianglePoint there;
        std::size_t nearest = i;
        for (; end < found.size() && member_of_[at(faces_[at(found[end].face)][0])] == member; ++end) {
            const Triangle& t = faces_[at(found[end].face)];
            const TrianglePoint q = closest_on_triangle(p, {start_[at(t[0])], start_[at(t[1])], start_[at(t[2])]}, t);
            const double distance2 = (p - q.point).squaredNorm();
            if (distance2 < nearest2) nearest2 = distance2, there = q, nearest = end;
        }
        if (bodies_.rest(body).is_volume && is_inside(found[nearest].face, there, p)) {
            found.erase(found.begin() + static_cast<std::ptrdiff_t>(i),
                        found.begin() + static_cast<std::ptrdiff_t>(end));
            inside_[at(point)] = 1;
        } else {
            const double area = share(point, found[nearest], nearest2);
            for (; i < end; ++i) found[i].area = area;
        }
    }
}

/// By the mean normal of the faces about the nearest place.
bool ClothContact::is_inside(int face, const TrianglePoint& there, const Vec3& p) const {
    const Member& m = members_[at(member_of_[at(faces_[at(face)][0])])];
    const NearestPlace nearest{face - m.first_face, there.barycentric, there.point, (p - there.point).squaredNorm()};
    return feature_of(bodies_[m.body], start_places_[at(m.body)], nearest, p).inside();
}

void ClothContact::find_edge_pairs(double reach) {
    refit(edge_tree_, boxes_, [&](int e, BvhNode& node) {
        for (const int v : edges_[at(e)]) grow(node, start_[at(v)]);
    });
    refit(edge_tree_, ways_, [&](int e, BvhNode& node) {
        for (const int v : edges_[at(e)]) grow(node, way_of(v));
    });
    balls_.resize(edges_.size());
    parallel_for(edges_.size(), 512, [&](std::size_t e) {
        const auto [a, b] = edges_[e];
        const Vec3 &p = start_[at(a)], &q = start_[at(b)], one = way_of(a), two = way_of(b);
        balls_[e] = {0.5 * (p + q), 0.5 * (one + two), 0.5 * (p - q).norm(), 0.5 * (one - two).norm()};
    });
    const std::size_t fans = edge_fans_.empty() ? 0 : edge_fans_.size() - 1;
    near_edges_.resize((fans + piece - 1) / piece);
    // The edges from one vertex lie so near to each other that they look for others together.
    gather_in_order(fans, edge_parts_, edge_pairs_, [&](std::size_t f, std::vector<EdgePair>& out) {
        const std::size_t first_edge = edge_fans_[f], end_edge = edge_fans_[f + 1];
        const int hub = edges_[first_edge][0];
        BvhNode box{start_[at(hub)], start_[at(hub)]}, ways{way_of(hub), way_of(hub)};
        for (std::size_t e = first_edge; e < end_edge; ++e)
            grow(box, start_[at(edges_[e][1])]), grow(ways, way_of(edges_[e][1]));
        std::vector<int>& others = near_edges_[f / piece];
        others.clear();
        visit_near(
            edge_tree_, boxes_, ways_, box.min, box.max, ways.min, ways.max, reach,
            [&](int node) { return last_edges_[at(node)] <= static_cast<int>(first_edge); },
            [&](int other) { others.push_back(other); });
        std::sort(others.begin(), others.end());
        for (std::size_t e = first_edge; e < end_edge; ++e)
            for (auto other = std::upper_bound(others.begin(), others.end(), static_cast<int>(e));
                 other != others.end(); ++other)
                if (const auto pair = pair_within(static_cast<int>(e), *other, reach)) out.push_back(*pair);
    });
}

/// Two edges, if they may meet within the step.
std::optional<ClothContact::EdgePair> ClothContact::pair_within(int e, int other, double reach) const {
    const Ball &own = balls_[at(e)], &ball = balls_[at(other)];
    const double most = reach + (own.way - ball.way).norm() + own.spread + ball.spread + own.radius + ball.radius;
    if ((own.middle - ball.middle).squaredNorm() > more * most * most) return {};
    const auto [a, b] = edges_[at(e)];
    const auto [c, d] = edges_[at(other)];
    const int pair = pair_of(a, c);
    if (pair < 0 || a == c || a == d || b == c || b == d) return {};
    double nearer = 0;
    for (const int u : {a, b})
        for (const int v : {c, d}) nearer = std::max(nearer, (way_of(u) - way_of(v)).squaredNorm());
    const double far = reach + std::sqrt(nearer);
    const Vec3 &p = start_[at(a)], &q = start_[at(b)], &r = start_[at(c)], &s = start_[at(d)];
    if (closest_of_segments(p, q, r, s).away.squaredNorm() > far * far) return {};
    if (is_held(pair, a) || is_held(pair, b) || is_held(pair, c) || is_held(pair, d)) return {};
    const bool same = member_of_[at(a)] == member_of_[at(c)];
    if (!same && (inside_[at(a)] || inside_[at(b)] || inside_[at(c)] || inside_[at(d)])) return {};
    if (same) {
        const double range = 0.5 * pairs_[at(pair)].range;
        if (closest_of_segments(modelled_[at(a)], modelled_[at(b)], modelled_[at(c)], modelled_[at(d)])
                .away.squaredNorm() < range * range)
            return {};
    }
    return EdgePair{e, other, pair, sign_of(triple(q - p, s - r, r - p))};
}

} // namespace sinew::solver
