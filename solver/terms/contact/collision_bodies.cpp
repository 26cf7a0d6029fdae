// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/collision_bodies.h"

#include "solver/error.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sinew::solver {

namespace {

/// All of such a cloth would be in reach of all of it.
bool is_too_thick(const Points& points, double thickness) {
    return thickness > 0.5 * bounding_box(points).size().maxCoeff();
}

/// A switch is a number between two times of which one has it on: on from halfway.
bool on(double value) { return value >= 0.5; }

} // namespace

bool share_a_set(const ContactRest& a, const ContactRest& b) {
    if (a.sets.empty() || b.sets.empty()) return true;
    return std::any_of(a.sets.begin(), a.sets.end(),
                       [&](int s) { return std::find(b.sets.begin(), b.sets.end(), s) != b.sets.end(); });
}

bool may_meet(const ContactRest& a, const ContactValues& of_a, const ContactRest& b, const ContactValues& of_b) {
    return on(of_a.collides) && on(of_b.collides) && of_a.stiffness > 0 && of_b.stiffness > 0 && share_a_set(a, b);
}

CollisionBodies::CollisionBodies(const Scene& scene) {
    const std::vector<Part>& parts = scene.description().parts;
    bodies_.reserve(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (parts[k].type != &contact_type) continue;
        const auto* rest = static_cast<const ContactRest*>(parts[k].rest.get());
        try {
            bodies_.emplace_back(scene, parts[k].bodies.front(), *rest);
        } catch (Error& e) {
            e.body = parts[k].bodies.front(), e.part = static_cast<int>(k);
            throw;
        }
        rests_.push_back(rest);
        parts_.push_back(k);
        too_thick_.push_back(bodies_.back().is_cloth() && is_too_thick(bodies_.back().modelled(), rest->thickness));
    }
}

bool CollisionBodies::make_pair(const std::vector<PartValues>& values, std::size_t a, std::size_t b,
                                ContactPair& out) const {
    const auto one = get_fields<ContactValues>(values[parts_[a]]), other = get_fields<ContactValues>(values[parts_[b]]);
    const bool itself = a == b;
    if (!bodies_[a].deforms() && !bodies_[b].deforms()) return false;
    if (itself && !on(one.collides_with_itself)) return false;
    if (!may_meet(*rests_[a], one, *rests_[b], other)) return false;
    for (const std::size_t k : {a, b})
        if (too_thick_[k]) refuse_thickness(k);
    out.source = static_cast<int>(a), out.target = static_cast<int>(b);
    out.stiffness = 2 * one.stiffness * other.stiffness / (one.stiffness + other.stiffness);
    out.friction = std::sqrt(one.friction * other.friction);
    out.damping = std::max(one.damping, other.damping);
    out.longest = std::max(one.longest, other.longest);
    out.range = 0.5 * (rests_[a]->thickness + rests_[b]->thickness);
    out.slides = on(one.slides) && on(other.slides);
    out.both_ways = has_faces(a);
    return true;
}

void CollisionBodies::refuse_thickness(std::size_t body) const {
    char text[160];
    std::snprintf(text, sizeof text, "a cloth that is %.4g m long cannot be %.4g m thick",
                  bounding_box(bodies_[body].modelled()).size().maxCoeff(), rests_[body]->thickness);
    Error e("FE298", text,
            "Write zCloth.thickness in metres, whatever the scale, and well below its length: 0.001 is a millimetre, "
            "and 0 has nothing meet it.");
    e.body = bodies_[body].body();
    throw e;
}

void CollisionBodies::find_pairs(const std::vector<PartValues>& values, std::vector<ContactPair>& out) const {
    out.clear();
    for (std::size_t a = 0; a < bodies_.size(); ++a)
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            ContactPair pair;
            if (!has_faces(b) || !make_pair(values, a, b, pair)) continue;
            pair.two_sided = bodies_[b].is_cloth(), pair.only_kept = pair.range > 0;
            out.push_back(pair);
        }
}

void CollisionBodies::find_thick_pairs(const std::vector<PartValues>& values, std::vector<ContactPair>& out) const {
    out.clear();
    for (std::size_t a = 0; a < bodies_.size(); ++a)
        for (std::size_t b = a; b < bodies_.size(); ++b) {
            ContactPair pair;
            const bool any = rests_[a]->thickness > 0 || rests_[b]->thickness > 0;
            if (any && make_pair(values, a, b, pair)) out.push_back(pair);
        }
}

} // namespace sinew::solver
