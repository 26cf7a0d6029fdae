// Points that press near an edge of a surface. Two things go wrong there. Faces that are folded back to back, as skin
// that its tets crumple, do not tell inside from outside: with the fold all but closed, a point millimetres away from
// it goes from one to the other at once. And where two faces meet in a dent, the edge is nearest to hardly more than a
// line of places: Newton's step from one face ends on the other and the step from there back here, and a point that
// should come to rest between them cuts the steps of all.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>

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

/// The two faces at an edge, and the ways into them from it, across it.
struct FacesAtEdge {
    std::array<int, 2> face{-1, -1};
    std::array<Vec3, 2> into{Vec3::Zero(), Vec3::Zero()};
    bool are_two = false;
};

/// `place_of` a point of the surface.
template <class PlaceOf>
FacesAtEdge faces_at(const CollisionBody& surface, const Edge& edge, const PlaceOf& place_of) {
    FacesAtEdge out;
    const Vec3 start = place_of(edge[0]), along = (place_of(edge[1]) - start).normalized();
    std::size_t count = 0;
    for (const int n : surface.fan(edge[0])) {
        const Triangle& corners = surface.triangles()[at(n)];
        if (!has_vertex(corners, edge[1])) continue;
        if (count == 2) return out;
        for (const int v : corners)
            if (v != edge[0] && v != edge[1]) {
                const Vec3 way = place_of(v) - start;
                out.into[count] = (way - way.dot(along) * along).normalized();
            }
        out.face[count++] = n;
    }
    out.are_two = count == 2;
    return out;
}

} // namespace

/// Where the faces at an edge lay back to back as the step began, they tell which side is which by how they lay then,
/// for all that the step tries. By the bottom of a crack a point is inside, as deep as below the nearer wall's plane,
/// so that nothing changes at once where a wall ends; around a blade it is outside. Other features are what they are.
ClosestFeature Contacts::unfolded(std::size_t i, const ClosestFeature& f) const {
    constexpr double sharpest = 0.2; // half the sum of the normals: faces at 23 degrees
    const Touch& t = touches_[i];
    // What is held by an anchor, or by a thickness, asks for no side here.
    if (f.triangle < 0 || t.side < 0 || pair_of(i).range > 0 || (t.kept >= 0 && !pair_of(i).slides)) return f;
    const CollisionBody& target = bodies_[t.target];
    const Edge on = edge_of(f, target.triangles()[at(f.triangle)]);
    if (on == no_edge) return f;
    const auto was = [&](int point) -> Vec3 { return target.place(point, before_[at(t.target)]); };
    const FacesAtEdge about = faces_at(target, on, was);
    if (!about.are_two) return f;
    const auto normal_then = [&](int face) {
        const Triangle& c = target.triangles()[at(face)];
        const Vec3 a = was(c[0]);
        return Vec3((was(c[1]) - a).cross(was(c[2]) - a).normalized());
    };
    const Vec3 one = normal_then(about.face[0]), other = normal_then(about.face[1]);
    if (!((one + other).norm() < 2 * sharpest)) return f;
    ClosestFeature out = f;
    out.triangle = -1;
    // In a crack each wall lies before the other one.
    if (!(one.dot(about.into[1]) > 0)) return out;
    const Points& places = places_[at(t.target)];
    double deepest = 0;
    for (const int n : about.face) {
        const Vec3 normal = face_normal(target, places, n);
        const double depth = -f.away.dot(normal);
        if (!(depth > deepest)) continue;
        deepest = depth;
        out = {n, place_in_plane(target.corners(n, places), point_at(t)), -depth * normal, normal};
    }
    return out;
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
    const FacesAtEdge about = faces_at(target, edge, [&](int point) -> Vec3 { return places[at(point)]; });
    return about.are_two && (about.into[0] + about.into[1]).dot(now_[i].away) < 0;
}

/// As an iteration begins: who went to and fro over an edge.
void Contacts::watch_features() {
    edges_.clear(), on_edges_ = false;
    // Where edges were kept to, trials end at them by themselves.
    if (by_edges_) tried_.assign(tried_.size(), ClosestFeature{});
    by_edges_ = false;
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
    on_edges_ = on, by_edges_ = true;
    return true;
}

} // namespace sinew::solver
