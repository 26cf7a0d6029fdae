// Points that press near an edge of a surface. Two things go wrong there. Faces that are folded back to back, as skin
// that its tets crumple, do not tell inside from outside: with the fold all but closed, a point millimetres away from
// it goes from one to the other at once. And where two faces meet in a dent, the edge is nearest to hardly more than a
// line of places: Newton's step from one face ends on the other and the step from there back here, and a point that
// should come to rest between them cuts the steps of all.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

using Edge = std::array<int, 2>;
constexpr Edge no_edge{-1, -1};

bool on_face(const ClosestFeature& f) { return f.triangle >= 0 && (f.place.array() != 0).all(); }

Edge shared_edge(const Triangle& one, const Triangle& other) {
    Edge out = no_edge;
    std::size_t count = 0;
    for (const int v : one)
        if (has_vertex(other, v)) {
            if (count == 2) return no_edge; // the same one
            out[count++] = v;
        }
    return count == 2 ? out : no_edge;
}

/// That a place lies on, between its ends.
Edge edge_of(const ClosestFeature& f, const Triangle& t) {
    const auto share = [&](std::size_t corner) { return f.place[static_cast<Eigen::Index>(corner)]; };
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
        if (share(c) == 0 && share(d) != 0 && share(e) != 0) return {t[d], t[e]};
    }
    return no_edge;
}

} // namespace

/// Whether a point is inside by an edge or vertex alone about which faces lay back to back as the step began. Asked of
/// then, it is the same for all that the step tries.
bool Contacts::on_fold(std::size_t i, const ClosestFeature& f) const {
    constexpr double sharpest = 0.2; // the mean of the normals: two faces at 23 degrees
    const Touch& t = touches_[i];
    if (f.triangle < 0 || on_face(f) || t.side < 0 || pair_of(i).two_sided || !f.inside()) return false;
    const CollisionBody& target = bodies_[t.target];
    const Triangle& corners = target.triangles()[at(f.triangle)];
    Edge on = no_edge; // a vertex: its first alone
    std::size_t count = 0;
    for (std::size_t c = 0; c < 3; ++c)
        if (f.place[static_cast<Eigen::Index>(c)] != 0) on[count++] = corners[c];
    Vec3 sum = Vec3::Zero();
    double all = 0;
    for (const int n : target.fan(on[0])) {
        const Triangle& about = target.triangles()[at(n)];
        if (count == 2 && !has_vertex(about, on[1])) continue;
        std::array<Vec3, 3> x;
        std::size_t k = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            x[c] = target.place(about[c], before_[at(t.target)]);
            if (about[c] == on[0]) k = c;
        }
        const Vec3 u = x[(k + 1) % 3] - x[k], v = x[(k + 2) % 3] - x[k], normal = u.cross(v);
        const double length = normal.norm(), weight = count == 2 ? 1 : std::atan2(length, u.dot(v));
        if (length > 0) sum += weight / length * normal;
        all += weight;
    }
    return sum.norm() < sharpest * all;
}

/// The edge to a face that the first trial of the last iteration, which was refused, or the iteration before ended on.
std::array<int, 2> Contacts::edge_passed(std::size_t i) const {
    const ClosestFeature& here = now_[i];
    const auto& triangles = bodies_[touches_[i].target].triangles();
    const auto beyond = [&](const ClosestFeature& there) {
        if (there.triangle < 0) return no_edge;
        const Triangle& own = triangles[at(here.triangle)];
        if (const Edge e = edge_of(there, triangles[at(there.triangle)]); e != no_edge)
            return has_vertex(own, e[0]) && has_vertex(own, e[1]) ? e : no_edge;
        return on_face(there) ? shared_edge(own, triangles[at(there.triangle)]) : no_edge;
    };
    if (const Edge e = beyond(tried_[i]); e != no_edge) return e;
    const bool returned = i < two_ago_.size() && two_ago_[i].triangle == here.triangle;
    return returned ? beyond(one_ago_[i]) : no_edge;
}

/// Whether there are places on the point's side to which the edge is nearer than both of its faces.
bool Contacts::has_room(std::size_t i, const std::array<int, 2>& edge) const {
    const Touch& t = touches_[i];
    const CollisionBody& target = bodies_[t.target];
    const Points& places = places_[at(t.target)];
    const Vec3 &start = places[at(edge[0])], along = (places[at(edge[1])] - start).normalized();
    Vec3 into_faces = Vec3::Zero();
    int faces = 0;
    for (const int n : target.fan(edge[0]))
        for (const int v : target.triangles()[at(n)])
            if (has_vertex(target.triangles()[at(n)], edge[1]) && v != edge[0] && v != edge[1]) {
                const Vec3 way = places[at(v)] - start;
                into_faces += (way - way.dot(along) * along).normalized(), ++faces;
            }
    return faces == 2 && into_faces.dot(now_[i].away) < 0;
}

/// As an iteration begins: who went to and fro over an edge.
void Contacts::watch_features() {
    edges_.clear();
    if (tried_.size() == touches_.size() && one_ago_.size() == touches_.size()) {
        edges_.assign(touches_.size(), no_edge);
        for (std::size_t i = 0; i < touches_.size(); ++i) {
            if (!on_face(now_[i]) || !presses(i, press(i, now_[i]).depth)) continue;
            if (const Edge e = edge_passed(i); e != no_edge && has_room(i, e)) edges_[i] = e;
        }
        if (std::ranges::count(edges_, no_edge) == std::ssize(edges_)) edges_.clear();
    }
    two_ago_.swap(one_ago_), one_ago_ = now_, tries_ = true;
}

ClosestFeature Contacts::on_edge(std::size_t i) const {
    const Touch& t = touches_[i];
    const Points& places = places_[at(t.target)];
    const auto [v, w] = edges_[i];
    const Vec3 &a = places[at(v)], way = places[at(w)] - a, p = point_at(t);
    const double length2 = way.squaredNorm(), s = length2 > 0 ? std::clamp((p - a).dot(way) / length2, 0.0, 1.0) : 0;
    ClosestFeature out = now_[i]; // the normal of its face goes on to tell the side
    const Triangle& corners = bodies_[t.target].triangles()[at(out.triangle)];
    for (std::size_t c = 0; c < 3; ++c)
        out.place[static_cast<Eigen::Index>(c)] = corners[c] == v ? 1 - s : corners[c] == w ? s : 0;
    out.away = p - a - s * way;
    return out;
}

bool Contacts::keep_to_edges(bool on) {
    if (edges_.empty() || edges_.size() != touches_.size()) return false;
    if (on != on_edges_) looked_at_.clear();
    on_edges_ = on;
    return true;
}

} // namespace sinew::solver
