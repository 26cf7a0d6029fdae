// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact_list.h"

#include "solver/index.h"
#include "solver/marks_of.h"
#include "solver/terms/contact/contact.h"

#include <tuple>

namespace sinew::solver {

void Contacts::list(std::vector<ContactPoint>& out) const {
    out.clear();
    out.reserve(kept_.contacts.size());
    auto pair = pairs_.begin(); // in the order of the contacts
    for (const KeptContact& c : kept_.contacts) {
        while (pair != pairs_.end() && std::tie(pair->source, pair->target) < std::tie(c.source, c.target)) ++pair;
        if (pair == pairs_.end()) break;
        if (pair->source != c.source || pair->target != c.target) continue; // switched off at this time
        if (is_left_to_attachments(c)) continue;
        const Vec3 p = places_[at(c.source)][at(c.point)];
        const Points& surface = places_[at(c.target)];
        NearestPlace nearest;
        nearest.triangle = c.triangle, nearest.place = Vec3(c.place[0], c.place[1], c.place[2]);
        nearest.point = place_at(c.target, c.triangle, nearest.place);
        const ClosestFeature f = feature_of(bodies_[c.target], surface, nearest, p);
        const Press pressed = press_of(bodies_[c.target], *pair, pair->two_sided ? c.side : 1, f);
        const double length = f.normal.norm(), flip = c.side < 0 ? -1 : 1;
        ContactPoint& made = out.emplace_back();
        made.source = bodies_[c.source].body(), made.target = bodies_[c.target].body(), made.point = c.point;
        made.slides = pair->slides;
        made.place = p;
        const Vec3 outwards = length > 0 ? Vec3(flip / length * f.normal) : Vec3(Vec3::Zero());
        // Of an edge or a vertex it is where the contact pushes to, not the mean of the faces about.
        made.normal = pressed.depth > 0 ? pressed.out : outwards;
        made.depth = pressed.depth;
        const Vec3 way = p - place_at(c.target, c.anchor_triangle, Vec3(c.anchor[0], c.anchor[1], c.anchor[2])) -
                         offset_of(*pair, c.side, f);
        if (!pair->slides) {
            if (const double stretch = way.norm(); stretch > 0) made.force = -c.force / stretch * way;
        } else if (pressed.depth > 0) {
            // Friction is a spring as stiff as the contact, along the surface, to where the point sticks.
            const Vec3 along = pair->friction > 0 ? Vec3(way - outwards * outwards.dot(way)) : Vec3(Vec3::Zero());
            made.force = c.force / pressed.depth * (pressed.depth * pressed.out - along);
        }
    }
    list_cloth(out);
}

std::vector<ContactPoint> contacts_shown(Workspace& workspace) {
    std::vector<ContactPoint> out;
    if (const Term* term = term_shown(workspace, contact_type)) static_cast<const Contacts*>(term)->list(out);
    return out;
}

} // namespace sinew::solver
