// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/contacts.h"

namespace sinew::nodes {

ContactList contact_list(std::vector<solver::ContactPoint> contacts, const std::vector<int>& simulated,
                         const SolverSpace& space) {
    for (solver::ContactPoint& c : contacts) {
        c.source = simulated[static_cast<std::size_t>(c.source)];
        c.target = simulated[static_cast<std::size_t>(c.target)];
        c.place = space.place_in_scene(c.place);
        c.normal = space.direction_in_scene(c.normal), c.force = space.direction_in_scene(c.force);
    }
    return {std::move(contacts)};
}

std::vector<ContactSum> sums_of(const ContactList& list) {
    std::vector<ContactSum> out;
    for (std::size_t i = 0; i < list.contacts.size(); ++i) {
        const solver::ContactPoint& c = list.contacts[i];
        if (out.empty() || out.back().source != c.source || out.back().target != c.target)
            out.push_back({c.source, c.target, 0, 0, i});
        ContactSum& pair = out.back();
        ++pair.contacts, pair.sliding += c.slides ? 1 : 0;
        if (c.depth > list.contacts[pair.deepest].depth) pair.deepest = i;
        pair.force += c.force;
    }
    return out;
}

} // namespace sinew::nodes

namespace sinew::engine {

void ValueTraits<nodes::ContactList>::hash(Hasher& h, const nodes::ContactList& v) {
    h.add(static_cast<std::uint64_t>(v.contacts.size()));
    for (const solver::ContactPoint& c : v.contacts) {
        h.add(c.source).add(c.target).add(c.point).add(c.slides).add(c.depth);
        for (const solver::Vec3* p : {&c.place, &c.normal, &c.force})
            h.add_doubles(std::span<const double>(p->data(), 3));
    }
}

std::size_t ValueTraits<nodes::ContactList>::bytes(const nodes::ContactList& v) {
    return v.contacts.size() * sizeof(solver::ContactPoint);
}

} // namespace sinew::engine
