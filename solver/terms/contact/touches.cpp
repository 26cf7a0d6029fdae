// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/touches.h"

#include "solver/mesh/closest_point.h"
#include "solver/parallel.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace sinew::solver {

namespace {

/// How far along the surface at rest a point and what it may touch of its own body must be from each other, in mean
/// edges and in spacings of the points.
constexpr double own_edges = 3;
/// Nearer than this share of the mean edge a point lies on a surface, and rounding says on which side: it has not
/// come in.
constexpr double on_surface = 1e-7;
/// Up to this share of the mean edge of what it is inside of, a point's nearest place is surely of the side that it
/// came in by; from twice this on it may be of any.
constexpr double surely_its_side = 0.25;
/// Searches look so much farther than is asked, so that most points need none at the next steps.
constexpr double look_farther = 4;

/// Of a cloth, see KeptContact.
int side_of(const CollisionBody& cloth, const ClosestFeature& f) {
    return cloth.is_at_rim(f.triangle, f.place) ? 0 : f.inside() ? -1 : 1;
}

} // namespace

Press press_of(const CollisionBody& target, const ContactPair& pair, int side, const ClosestFeature& f) {
    Press out;
    out.behind = side >= 0 ? f.inside() : f.away.dot(f.normal) > 0;
    // Beyond the rim of a cloth neither side is the wrong one.
    if (pair.two_sided && (side == 0 || target.is_at_rim(f.triangle, f.place))) out.behind = false;
    const double distance = f.away.norm(), length = f.normal.norm();
    out.depth = pair.range + (out.behind ? distance : -distance);
    if (distance > 0)
        out.out = (out.behind ? -1 : 1) / distance * f.away;
    else if (length > 0)
        out.out = (side < 0 ? -1 : 1) / length * f.normal;
    return out;
}

TouchSearch::TouchSearch(const CollisionBodies& bodies)
    : bodies_(bodies)
    , boxes_(bodies.count())
    , areas_(bodies.count())
    , known_(bodies.count() * bodies.count())
    , elsewhere_(bodies.count())
    , inside_(bodies.count())
    , last_(bodies.count())
    , later_(bodies.count())
    , behind_(bodies.count())
    , ahead_(bodies.count()) {}

void TouchSearch::begin(const std::vector<const double*>& carriers) {
    ++step_;
    std::fill(inside_.begin(), inside_.end(), nullptr);
    parallel_for(bodies_.count(), 1, [&](std::size_t b) {
        const CollisionBody& body = bodies_[static_cast<int>(b)];
        last_[b] = boxes_[b].places();
        boxes_[b].fit(body, carriers[b]);
        if (last_[b].size() == body.point_count()) behind_[b].set(last_[b], boxes_[b].places());
        body.areas(boxes_[b].places(), areas_[b]);
    });
}

void TouchSearch::sweep(const std::vector<const double*>& later) {
    parallel_for(bodies_.count(), 1, [&](std::size_t b) {
        const CollisionBody& body = bodies_[static_cast<int>(b)];
        later_[b].resize(body.point_count());
        for (std::size_t p = 0; p < later_[b].size(); ++p) later_[b][p] = body.place(static_cast<int>(p), later[b]);
        ahead_[b].set(boxes_[b].places(), later_[b]);
        ahead_[b].fit_boxes(body, boxes_[b].places());
    });
}

/// Takes off what was known about distances what the pair has moved against each other since the step before.
void TouchSearch::bring_up_to_date(const ContactPair& pair) {
    KnownOfPair& of_pair = known_[at(pair.source) * bodies_.count() + at(pair.target)];
    if (of_pair.step == step_) return;
    if (of_pair.step + 1 < step_) of_pair.points.clear(); // nobody has watched how they moved
    of_pair.step = step_;
    const Points &now = boxes_[at(pair.source)].places(), &last = last_[at(pair.source)];
    const BodyMotion& target = behind_[at(pair.target)];
    parallel_for(of_pair.points.size(), 256, [&](std::size_t p) {
        of_pair.points[p].distance -= (target.seen(now[p]) - last[p]).norm() + target.farthest();
    });
    of_pair.points.resize(now.size());
}

/// Where both bodies' points press into each other, each counts in part: the finer sampled one for more. The parts of
/// two that meet sum to 1, so that the force per area is that of the pair's stiffness however they are sampled.
double TouchSearch::area(const ContactPair& pair, const Touch& touch) const {
    const int point = touch.point;
    const ClosestFeature& feature = touch.feature;
    const double own = areas_[at(pair.source)][at(point)];
    // The nearest place of a point deep inside may be of any side: what it looks past counts no more there.
    const double depth = feature.away.norm() / (surely_its_side * bodies_[pair.target].mean_edge());
    const double facing =
        bodies_[pair.source].facing_area(point, touch.side < 0 ? Vec3(-feature.normal) : feature.normal,
                                         std::clamp(2 - depth, 0.0, 1.0), own, boxes_[at(pair.source)].places());
    if (!pair.both_ways) return facing;
    double others = 0;
    for (const int v : bodies_[pair.target].triangles()[at(feature.triangle)])
        others += areas_[at(pair.target)][at(v)] / 3;
    return facing * others * others / (own * own + others * others);
}

std::uint64_t TouchSearch::take_kept(const ContactPair& pair, const std::vector<KeptContact>& kept,
                                     const std::vector<char>& held, std::vector<Touch>& out) const {
    std::uint64_t dropped = 0;
    const auto by_pair = [](const auto& a, const auto& b) {
        return std::tie(a.source, a.target) < std::tie(b.source, b.target);
    };
    auto it = std::lower_bound(kept.begin(), kept.end(), pair, by_pair);
    for (; it != kept.end() && it->source == pair.source && it->target == pair.target; ++it) {
        const KeptContact& c = *it;
        if (!held.empty() && held[at(c.point)]) continue;
        Touch t{c.source, c.point, c.target, static_cast<int>(it - kept.begin()), 1, {}};
        const CollisionBody& target = bodies_[c.target];
        const Points& where = boxes_[at(c.target)].places();
        const Vec3 p = boxes_[at(c.source)].places()[at(c.point)];
        // It may have slid around an edge in the meantime, but not to the far side.
        const Vec3 side = face_normal(target, where, c.triangle);
        t.feature = follow_feature(target, where, c.triangle, p);
        if (face_normal(target, where, t.feature.triangle).dot(side) < -least_facing)
            t.feature = follow_feature(target, where, c.triangle, p, side);
        if (pair.two_sided) t.side = c.side != 0 ? c.side : side_of(target, t.feature);
        if (is_too_deep(pair, t.feature))
            ++dropped;
        else
            out.push_back(t);
    }
    return dropped;
}

void TouchSearch::find_near(const ContactPair& pair, double margin, const std::vector<char>& held, std::size_t first,
                            std::vector<Touch>& out) {
    if (pair.only_kept) return;
    const CollisionBody &source = bodies_[pair.source], &target = bodies_[pair.target];
    has_.assign(source.point_count(), 0);
    std::copy(held.begin(), held.end(), has_.begin());
    for (std::size_t i = first; i < out.size(); ++i)
        if (const Touch& t = out[i]; t.source == pair.source && t.target == pair.target) has_[at(t.point)] = 1;
    bring_up_to_date(pair);
    std::vector<Known>& known = known_[at(pair.source) * bodies_.count() + at(pair.target)].points;
    const Points &now = boxes_[at(pair.source)].places(), &later = later_[at(pair.source)];
    const BodyMotion& sweep = ahead_[at(pair.target)];
    const double edge = target.mean_edge();
    const double apart = own_edges * std::max(source.mean_edge(), bodies_.rest(pair.source).spacing);
    const std::vector<std::vector<int>>* elsewhere = nullptr;
    if (pair.source == pair.target) {
        std::vector<std::vector<int>>& of_body = elsewhere_[at(pair.source)];
        if (of_body.empty()) of_body = source.elsewhere(apart);
        elsewhere = &of_body;
    }
    found_.resize(source.point_count());
    parallel_for(found_.size(), 64, [&](std::size_t p) {
        found_[p].triangle = -1;
        if (has_[p]) return;
        const Vec3 end = sweep.seen(later[p]);
        const double distance = (end - now[p]).norm() + sweep.farthest() + margin + pair.range;
        if (known[p].distance > distance) return;
        if (!sweep.meets(now[p], end, margin + pair.range)) return;
        const Vec3& modelled = source.modelled(static_cast<int>(p));
        double turned_away = std::numeric_limits<double>::infinity(); // to what may turn to it until later
        const auto far_along = [&](int triangle) {
            if (!elsewhere) return true;
            const bool is_near = std::ranges::any_of(target.triangles()[at(triangle)], [&](int v) {
                return (target.modelled(v) - modelled).squaredNorm() < apart * apart;
            });
            if (is_near && !std::binary_search((*elsewhere)[p].begin(), (*elsewhere)[p].end(), triangle)) return false;
            // The far side of a thin part is nearer than what the part may meet.
            const Points& places = boxes_[at(pair.target)].places();
            const auto [a, b, c] = target.corners(triangle, places);
            if ((b - a).cross(c - a).dot(now[p] - a) > 0) return true;
            NearestPlace there;
            there.distance2 = turned_away;
            there.offer(target, places, triangle, now[p]);
            turned_away = there.distance2;
            return false;
        };
        const double look = std::max(look_farther * distance, 2 * target.mean_edge());
        const ClosestFeature f =
            find_feature(target, boxes_[at(pair.target)], now[p], look, far_along, known[p].triangle);
        const bool inside =
            !pair.two_sided && f.inside() && f.away.squaredNorm() > on_surface * on_surface * edge * edge;
        const double far = f.triangle < 0 ? look : inside ? 0 : f.away.norm();
        known[p] = {std::min(far, std::sqrt(turned_away)), f.triangle};
        if (f.triangle >= 0 && far <= distance && !inside) found_[p] = f;
    });
    for (std::size_t p = 0; p < found_.size(); ++p)
        if (found_[p].triangle >= 0)
            out.push_back({pair.source, static_cast<int>(p), pair.target, -1,
                           pair.two_sided ? side_of(target, found_[p]) : 1, found_[p]});
}

std::uint64_t TouchSearch::find_inside(const ContactPair& pair, std::vector<Touch>& out) {
    const CollisionBody &source = bodies_[pair.source], &target = bodies_[pair.target];
    if (pair.source == pair.target || pair.two_sided) return 0;
    const SurfaceBoxes &own = boxes_[at(pair.source)], &boxes = boxes_[at(pair.target)];
    if ((own.low().array() > boxes.high().array()).any() || (own.high().array() < boxes.low().array()).any()) return 0;
    const auto may_be_inside = [&](const Vec3& place) {
        return (place.array() >= boxes.low().array()).all() && (place.array() <= boxes.high().array()).all();
    };
    if (!std::any_of(own.places().begin(), own.places().end(), may_be_inside)) return 0;
    std::shared_ptr<const SurfaceTree>& tree = inside_[at(pair.target)];
    if (!tree) tree = std::make_shared<SurfaceTree>(boxes.places(), target.triangles());
    std::vector<ClosestFeature> found(source.point_count());
    parallel_for(found.size(), 64, [&](std::size_t p) {
        const Vec3& place = own.places()[p];
        if (may_be_inside(place) && tree->inside(place)) found[p] = find_feature(target, boxes, place, 1e300);
    });
    std::uint64_t dropped = 0;
    for (std::size_t p = 0; p < found.size(); ++p) {
        if (found[p].triangle < 0) continue;
        if (is_too_deep(pair, found[p]))
            ++dropped;
        else
            out.push_back({pair.source, static_cast<int>(p), pair.target, -1, 1, found[p]});
    }
    return dropped;
}

} // namespace sinew::solver
