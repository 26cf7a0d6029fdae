// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/collision_bodies.h"

#include "solver/error.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

/// A switch is a number between two times of which one has it on: on from halfway.
bool on(double value) { return value >= 0.5; }

} // namespace

bool share_a_set(const ContactRest& a, const ContactRest& b) {
    if (a.sets.empty() || b.sets.empty()) return true;
    return std::any_of(a.sets.begin(), a.sets.end(),
                       [&](int s) { return std::find(b.sets.begin(), b.sets.end(), s) != b.sets.end(); });
}

CollisionBodies::CollisionBodies(const Scene& scene) {
    const std::vector<Part>& parts = scene.description().parts;
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

} // namespace sinew::solver
