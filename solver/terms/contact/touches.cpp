// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/touches.h"

#include "solver/mesh/closest_point.h"
#include "solver/parallel.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>

namespace sinew::solver {

namespace {

bool share_a_set(const ContactRest& a, const ContactRest& b) {
    if (a.sets.empty() || b.sets.empty()) return true;
    return std::any_of(a.sets.begin(), a.sets.end(),
                       [&](int s) { return std::find(b.sets.begin(), b.sets.end(), s) != b.sets.end(); });
}

/// A switch is a number between two times of which one has it on: on from halfway.
bool on(double value) { return value >= 0.5; }

/// How far along the surface at rest a point and what it may touch of its own body must be from each other, in mean
/// edges and in spacings of the points.
constexpr double own_edges = 3;
/// Searches look so much farther than is asked, so that most points need none at the next steps.
constexpr double look_farther = 4;

} // namespace

CollisionBodies::CollisionBodies(const Scene& scene) {
    const std::vector<Part>& parts = scene.description().parts;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (parts[k].type != &contact_type) continue;
        const auto* rest = static_cast<const ContactRest*>(parts[k].rest.get());
        bodies_.emplace_back(scene, parts[k].bodies.front(), *rest);
        rests_.push_back(rest);
        parts_.push_back(k);
    }
}

void CollisionBodies::find_pairs(const std::vector<PartValues>& values, std::vector<ContactPair>& out) const {
    out.clear();
    const auto values_of = [&](std::size_t body) { return get_fields<ContactValues>(values[parts_[body]]); };
    for (std::size_t a = 0; a < bodies_.size(); ++a)
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const ContactValues one = values_of(a), other = values_of(b);
            const bool itself = a == b;
            if (!bodies_[a].deforms() && !bodies_[b].deforms()) continue;
            if (!on(one.collides) || !on(other.collides) || (itself && !on(one.collides_with_itself))) continue;
            if (!rests_[b]->is_volume || (!itself && !share_a_set(*rests_[a], *rests_[b]))) continue;
            if (one.stiffness <= 0 || other.stiffness <= 0) continue;
            ContactPair pair;
            pair.source = static_cast<int>(a), pair.target = static_cast<int>(b);
            pair.stiffness = 2 * one.stiffness * other.stiffness / (one.stiffness + other.stiffness);
            pair.friction = std::sqrt(one.friction * other.friction);
            pair.damping = std::max(one.damping, other.damping);
            pair.longest = std::max(one.longest, other.longest);
            pair.slides = on(one.slides) && on(other.slides);
            pair.both_ways = rests_[a]->is_volume;
            out.push_back(pair);
        }
}

TouchSearch::TouchSearch(const CollisionBodies& bodies)
    : bodies_(bodies)
    , boxes_(bodies.count())
    , fitted_(bodies.count())
    , areas_(bodies.count())
    , known_(bodies.count() * bodies.count())
    , travel_(bodies.count(), 0.0)
    , last_(bodies.count()) {}

void TouchSearch::begin(const std::vector<const double*>& carriers) {
    carriers_ = carriers;
    for (std::size_t b = 0; b < bodies_.count(); ++b) {
        const CollisionBody& body = bodies_[static_cast<int>(b)];
        const auto [first, count] = body.carrier_range();
        const std::span<const double> now(carriers[b] + 3 * first, 3 * count);
        if (last_[b].empty()) {
            last_[b].assign(now.begin(), now.end());
            continue;
        }
        double farthest = 0;
        for (std::size_t i = 0; i < now.size(); i += 3) {
            const Vec3 move(now[i] - last_[b][i], now[i + 1] - last_[b][i + 1], now[i + 2] - last_[b][i + 2]);
            farthest = std::max(farthest, move.squaredNorm());
        }
        travel_[b] += body.leverage() * std::sqrt(farthest);
        std::copy(now.begin(), now.end(), last_[b].begin());
    }
    std::fill(fitted_.begin(), fitted_.end(), 0);
}

void TouchSearch::fit(int body) {
    if (fitted_[at(body)]) return;
    fitted_[at(body)] = 1;
    boxes_[at(body)].fit(bodies_[body], carriers_[at(body)]);
    bodies_[body].areas(boxes_[at(body)].places(), areas_[at(body)]);
}

/// Where both bodies' points press into each other, each counts in part: the finer sampled one for more. The parts of
/// two that meet sum to 1, so that the force per area is that of the pair's stiffness however they are sampled.
double TouchSearch::area(const ContactPair& pair, const Touch& touch) const {
    const int point = touch.point;
    const ClosestFeature& feature = touch.feature;
    const double own = areas_[at(pair.source)][at(point)];
    const double facing =
        bodies_[pair.source].facing_area(point, feature.normal, own, boxes_[at(pair.source)].places());
    if (!pair.both_ways) return facing;
    double others = 0;
    for (const int v : bodies_[pair.target].triangles()[at(feature.triangle)])
        others += areas_[at(pair.target)][at(v)] / 3;
    return facing * others * others / (own * own + others * others);
}

void TouchSearch::take_kept(const ContactPair& pair, const std::vector<KeptContact>& kept,
                            std::vector<Touch>& out) const {
    for (std::size_t k = 0; k < kept.size(); ++k) {
        const KeptContact& c = kept[k];
        if (c.source != pair.source || c.target != pair.target) continue;
        Touch t{c.source, c.point, c.target, static_cast<int>(k), {}};
        t.feature = follow_feature(bodies_[c.target], carriers(c.target), c.triangle,
                                   bodies_[c.source].place(c.point, carriers(c.source)));
        if (pair.longest > 0 && t.feature.away.norm() > pair.longest) continue;
        out.push_back(t);
    }
}

void TouchSearch::find_near(const ContactPair& pair, double distance, std::size_t first, std::vector<Touch>& out) {
    const CollisionBody &source = bodies_[pair.source], &target = bodies_[pair.target];
    fit(pair.source), fit(pair.target);
    has_.assign(source.point_count(), 0);
    for (std::size_t i = first; i < out.size(); ++i)
        if (const Touch& t = out[i]; t.source == pair.source && t.target == pair.target) has_[at(t.point)] = 1;
    const Vec3 low = boxes_[at(pair.target)].low() - Vec3::Constant(distance),
               high = boxes_[at(pair.target)].high() + Vec3::Constant(distance);
    const CollisionBoxes& own = boxes_[at(pair.source)];
    if ((own.low().array() > high.array()).any() || (own.high().array() < low.array()).any()) {
        return;
    }
    found_.resize(source.point_count());
    std::vector<Known>& known = known_[at(pair.source) * bodies_.count() + at(pair.target)];
    known.resize(source.point_count());
    const double travel = travel_[at(pair.source)] + travel_[at(pair.target)];
    const double look = std::max(look_farther * distance, 2 * target.mean_edge());
    const double apart = own_edges * std::max(source.mean_edge(), bodies_.rest(pair.source).spacing);
    const auto keep = [&](std::size_t p, const ClosestFeature& f) {
        const double far = f.triangle < 0 ? look : f.inside() ? 0 : f.away.norm();
        known[p] = {far, travel, f.triangle};
        if (f.triangle >= 0 && far <= distance && !f.inside()) found_[p] = f;
    };
    parallel_for(found_.size(), 64, [&](std::size_t p) {
        found_[p].triangle = -1;
        if (has_[p] || known[p].distance - (travel - known[p].travel) > distance) return;
        const Vec3& place = own.places()[p];
        if ((place.array() < low.array()).any() || (place.array() > high.array()).any()) return;
        if (pair.source != pair.target) {
            keep(p, find_feature(
                        target, carriers(pair.target), boxes_[at(pair.target)], place, look, [](int) { return true; },
                        known[p].triangle));
            return;
        }
        const Vec3& modelled = source.modelled(static_cast<int>(p));
        const auto far_along = [&](int triangle) {
            for (const int v : target.triangles()[at(triangle)])
                if ((target.modelled(v) - modelled).squaredNorm() < apart * apart) return false;
            return true;
        };
        keep(p, find_feature(target, carriers(pair.target), boxes_[at(pair.target)], place, look, far_along,
                             known[p].triangle));
    });
    for (std::size_t p = 0; p < found_.size(); ++p)
        if (found_[p].triangle >= 0) out.push_back({pair.source, static_cast<int>(p), pair.target, -1, found_[p]});
}

void TouchSearch::find_inside(const ContactPair& pair, std::vector<Touch>& out) {
    const CollisionBody &source = bodies_[pair.source], &target = bodies_[pair.target];
    if (pair.source == pair.target) return;
    fit(pair.source), fit(pair.target);
    const CollisionBoxes &own = boxes_[at(pair.source)], &boxes = boxes_[at(pair.target)];
    if ((own.low().array() > boxes.high().array()).any() || (own.high().array() < boxes.low().array()).any()) return;
    const SurfaceTree tree(boxes.places(), target.triangles());
    std::vector<ClosestFeature> found(source.point_count());
    parallel_for(found.size(), 64, [&](std::size_t p) {
        const Vec3& place = own.places()[p];
        if ((place.array() < boxes.low().array()).any() || (place.array() > boxes.high().array()).any()) return;
        if (!tree.inside(place)) return;
        found[p] = find_feature(target, carriers(pair.target), boxes, place, 1e300);
    });
    for (std::size_t p = 0; p < found.size(); ++p)
        if (found[p].triangle >= 0 && (pair.longest <= 0 || found[p].away.norm() <= pair.longest))
            out.push_back({pair.source, static_cast<int>(p), pair.target, -1, found[p]});
}

} // namespace sinew::solver
