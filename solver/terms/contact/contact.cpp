// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sinew::solver {

namespace {

constexpr Measure measures[] = {
    {"contact", "contacts", "1", "points in contact", Combine::most},
    {"contact", "max_depth_m", "m", "deepest contact", Combine::most},
    {"contact", "force_N", "N", "sum of contact forces", Combine::most},
    {"contact", "dropped", "1", "contacts dropped as deeper than maxContactLength", Combine::sum},
};
constexpr auto value_names = field_names<ContactValues>();

void tidy(std::vector<CoupledCarriers>& pairs) {
    parallel_sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

void sort_contacts(std::vector<KeptContact>& contacts) {
    std::sort(contacts.begin(), contacts.end(), [](const KeptContact& a, const KeptContact& b) {
        return std::tie(a.source, a.target, a.point) < std::tie(b.source, b.target, b.point);
    });
}

void list_pairs(const std::vector<ContactPair>& pairs, std::vector<CollidingBodies>& out) {
    out.clear();
    for (const ContactPair& pair : pairs) out.push_back({pair.source, pair.target});
}

/// Adds the contacts of points that are inside already where pairs begin to collide, and counts those too deep for it.
/// `carriers`: of each body.
void add_inside(const CollisionBodies& bodies, const std::vector<ContactPair>& pairs,
                const std::vector<const double*>& carriers, ContactMemory& out) {
    TouchSearch search(bodies);
    search.begin(carriers);
    std::vector<Touch> touches;
    for (const ContactPair& pair : pairs) {
        touches.clear();
        out.dropped += search.find_inside(pair, touches);
        for (const Touch& t : touches) {
            const std::array<double, 3> place{t.feature.place[0], t.feature.place[1], t.feature.place[2]};
            const double depth = press_of(bodies[t.target], pair, t.side, t.feature).depth;
            const double force = pair.stiffness * search.area(pair, t) * depth;
            out.contacts.push_back(
                {t.source, t.point, t.target, t.feature.triangle, place, t.feature.triangle, 0, place, force});
        }
    }
    sort_contacts(out.contacts);
}

/// Of each body of contact: what carries its points. `x`: of what deforms; `bones`: per body.
std::vector<const double*> carriers_at(const CollisionBodies& bodies, const std::vector<double>& x,
                                       const std::vector<Points>& bones) {
    std::vector<const double*> out;
    for (std::size_t b = 0; b < bodies.count(); ++b) {
        const CollisionBody& body = bodies[static_cast<int>(b)];
        out.push_back(body.deforms() ? x.data() : bones[at(body.body())].data()->data());
    }
    return out;
}

/// Contact begins. `x`: of what deforms; `bones`: per body.
void begin_at(const Scene& scene, const StepInputs& inputs, const std::vector<double>& x,
              const std::vector<Points>& bones, TermMemory& memory) {
    const CollisionBodies bodies(scene);
    ContactMemory kept;
    std::vector<ContactPair> pairs;
    bodies.find_pairs(inputs.parts, pairs);
    add_inside(bodies, pairs, carriers_at(bodies, x, bones), kept);
    list_pairs(pairs, kept.pairs);
    keep_contacts(kept, memory);
}

void start(const Scene& scene, const StepInputs& inputs, const std::vector<Points>& surfaces, TermMemory& memory) {
    begin_at(scene, inputs, scene.numbering().rest, surfaces, memory);
}

void begin(const Scene& scene, const StepInputs& inputs, const State& now, TermMemory& memory) {
    begin_at(scene, inputs, now.x, now.bones, memory);
}

} // namespace

const TermType contact_type{
    .name = "contact",
    .numerics = 8,
    .values = value_names,
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        const std::vector<Part>& parts = scene.description().parts;
        const bool used =
            std::any_of(parts.begin(), parts.end(), [](const Part& p) { return p.type == &contact_type; });
        return used ? std::make_unique<Contacts>(scene) : nullptr;
    },
    .start = start,
    .begin = begin,
    .memory_version = 3,
    .has_memory = true,
    .presses = true,
};

Contacts::Contacts(const Scene& scene)
    : scene_(scene)
    , bodies_(scene)
    , search_(bodies_)
    , attached_(scene, bodies_)
    , cloth_(scene, bodies_) {
    bones_.resize(bodies_.count());
    moves_.resize(bodies_.count()), places_.resize(bodies_.count());
}

Changes Contacts::take(const StepInputs& inputs, const State& before) {
    for (std::size_t b = 0; b < bodies_.count(); ++b) {
        const std::size_t part = bodies_.part(static_cast<int>(b));
        const ContactValues v = get_fields<ContactValues>(inputs.parts[part]);
        for (const auto& [name, value] : {std::pair{"contactStiffness", v.stiffness},
                                          {"contactFriction", v.friction},
                                          {"contactDamping", v.damping},
                                          {"maxContactLength", v.longest}}) {
            if (value >= 0) continue;
            Error e("FE304", std::string(name) + " is negative: " + std::to_string(value), "it must be 0 or more");
            e.body = bodies_[static_cast<int>(b)].body(), e.part = static_cast<int>(part);
            throw e;
        }
    }
    contacts_kept(before.memories, kept_);
    attached_.take(before);
    for (const KeptContact& c : kept_.contacts) {
        const auto is_body = [&](int b) { return b >= 0 && at(b) < bodies_.count(); };
        const auto is_triangle = [&](int t) { return t >= 0 && at(t) < bodies_[c.target].triangles().size(); };
        if (!is_body(c.source) || !is_body(c.target) || c.point < 0 || at(c.point) >= bodies_[c.source].point_count() ||
            !is_triangle(c.triangle) || !is_triangle(c.anchor_triangle))
            throw Error("IO403", "a saved simulation state holds contacts of bodies that the scene does not have");
    }
    begin_pairs(inputs, before);
    const bool same = pattern_ && kept_.couplings == couplings_;
    couplings_ = kept_.couplings;
    return {.couplings = !same};
}

/// Bodies that did not collide at the state and do from now on, since a switch or a stiffness is keyed: what is inside
/// then is drawn out as at the start frame.
void Contacts::begin_pairs(const StepInputs& inputs, const State& before) {
    bodies_.find_pairs(inputs.parts, begun_);
    std::erase_if(begun_, [&](const ContactPair& pair) {
        return std::binary_search(kept_.pairs.begin(), kept_.pairs.end(), CollidingBodies{pair.source, pair.target});
    });
    if (begun_.empty()) return;
    add_inside(bodies_, begun_, carriers_at(bodies_, before.x, before.bones), kept_);
}

void Contacts::add_couplings(Couplings& couplings) const {
    // What carries a point is coupled whether it touches or not: elements couple most of that in any case.
    for (std::size_t b = 0; b < bodies_.count(); ++b)
        for (int c = 0; c < bodies_[static_cast<int>(b)].carrier_count(); ++c) {
            const std::span<const int> vertices = bodies_[static_cast<int>(b)].carrier_vertices(c);
            for (std::size_t i = 0; i < vertices.size(); ++i)
                for (std::size_t j = i + 1; j < vertices.size(); ++j) couplings.emplace_back(vertices[i], vertices[j]);
        }
    for (const CoupledCarriers& c : couplings_)
        for (const int v : bodies_[c.body].carrier_vertices(c.carrier))
            for (const int w : bodies_[c.other_body].carrier_vertices(c.other_carrier))
                if (v != w) couplings.emplace_back(v, w);
}

KeptContact Contacts::kept_contact(std::size_t i, const ClosestFeature& f) const {
    const Touch& t = touches_[i];
    const ContactPair& pair = pair_of(i);
    const double k = stiffness(i);
    const bool has_side = pair.two_sided && !bodies_[t.target].is_at_rim(f.triangle, f.place);
    // What began at the rim is on the side where it has come to lie.
    const int side = !has_side ? 0 : t.side != 0 ? t.side : f.inside() ? -1 : 1;
    KeptContact out{t.source,
                    t.point,
                    t.target,
                    f.triangle,
                    {f.place[0], f.place[1], f.place[2]},
                    f.triangle,
                    side,
                    {f.place[0], f.place[1], f.place[2]},
                    k * press(i, f).depth};
    if (pair.slides && pair.friction <= 0) return out;
    if (t.kept >= 0) {
        const KeptContact& was = kept_.contacts[at(t.kept)];
        out.anchor_triangle = was.anchor_triangle, out.anchor = was.anchor;
    } else if (const Tether* tie = first_tie(i)) {
        out.anchor_triangle = tie->triangle, out.anchor = {tie->place[0], tie->place[1], tie->place[2]};
    } else {
        return out;
    }
    const Vec3 anchor(out.anchor[0], out.anchor[1], out.anchor[2]), p = point_at(t);
    const Vec3 way = p - place_at(t.target, out.anchor_triangle, anchor) - offset_of(pair, t.side, f);
    if (!pair.slides) out.force = k * way.norm();
    const Vec3 n = f.normal.normalized(), along = way - n * n.dot(way);
    const double most = pair.friction * out.force, length = along.norm();
    if (pair.slides && k * length > most) {
        const Vec3 behind = p - f.away - (most / k / length) * along; // on the surface
        const ClosestFeature end = follow_feature(bodies_[t.target], places_[at(t.target)], f.triangle, behind);
        out.anchor_triangle = end.triangle, out.anchor = {end.place[0], end.place[1], end.place[2]};
    }
    return out;
}

bool Contacts::is_left_to_attachments(const KeptContact& c) const {
    const auto before = [](const ContactPair& a, const KeptContact& b) {
        return std::tie(a.source, a.target) < std::tie(b.source, b.target);
    };
    const auto pair = std::lower_bound(pairs_.begin(), pairs_.end(), c, before);
    if (pair == pairs_.end() || pair->source != c.source || pair->target != c.target) return false;
    const std::vector<char>& held = held_[at(pair - pairs_.begin())];
    return !held.empty() && held[at(c.point)];
}

/// What is coupled changes only where something ties firmly that is not: each change costs an analysis.
void Contacts::remember_couplings() const {
    next_.couplings.clear();
    const bool strong_cloth = std::find(cloth_strong_.begin(), cloth_strong_.end(), 1) != cloth_strong_.end();
    if (!strong_cloth && std::find(strong_.begin(), strong_.end(), 1) == strong_.end()) {
        next_.couplings = kept_.couplings;
        return;
    }
    const auto is_coupled = [&](const CoupledCarriers& c) {
        return std::binary_search(kept_.couplings.begin(), kept_.couplings.end(), c);
    };
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const int triangle = feature_at(i).triangle;
        if (!strong_[pair_of_touch_[i]] && !visit_couplings(bodies_, touches_[i], triangle, false, is_coupled))
            continue;
        visit_couplings(bodies_, touches_[i], triangle, true, [&](const CoupledCarriers& c) {
            next_.couplings.push_back(c);
            return true;
        });
    }
    for (const ClothContact::Press& press : presses_)
        if (neither_stands(press)) couple_cloth(press);
    tidy(next_.couplings);
}

void Contacts::remember(const Positions& x, bool, TermMemory& memory) const {
    next_.contacts.clear(), next_.couplings.clear();
    find_features(x);
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const ClosestFeature& f = now_[i];
        if (f.triangle < 0) continue;
        const Touch& t = touches_[i];
        const ContactPair& pair = pair_of(i);
        const Press pressed = press(i, f);
        bool out = pressed.depth <= 0;
        if (t.kept >= 0 && !pair.slides) {
            const KeptContact& was = kept_.contacts[at(t.kept)];
            const Vec3 place(was.anchor[0], was.anchor[1], was.anchor[2]);
            const Vec3 way = point_at(t) - place_at(t.target, was.anchor_triangle, place) - offset_of(pair, t.side, f);
            const double along = way.dot(face_normal(bodies_[t.target], places_[at(t.target)], was.anchor_triangle));
            out = (t.side < 0 ? -along : along) > 0;
        }
        if (out || is_too_deep(pair, f)) continue;
        next_.contacts.push_back(kept_contact(i, f));
    }
    // What is left to attachments is kept for when they let go.
    for (const KeptContact& c : kept_.contacts)
        if (is_left_to_attachments(c)) next_.contacts.push_back(c);
    remember_lost();
    sort_contacts(next_.contacts);
    list_pairs(pairs_, next_.pairs);
    remember_couplings();
    keep_contacts(next_, memory);
}

void Contacts::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    double count = 0, deepest = 0, force = 0, dropped = static_cast<double>(kept_.dropped + dropped_);
    find_features(x);
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const ClosestFeature& f = now_[i];
        if (f.triangle < 0) continue;
        const double depth = press(i, f).depth;
        if (!(depth > 0)) continue;
        count += 1, deepest = std::max(deepest, depth);
        force += stiffness(i) * depth;
        if (is_too_deep(pair_of(i), f)) dropped += 1;
    }
    for (const ClothContact::Press& press : presses_) {
        count += 1, deepest = std::max(deepest, press.depth());
        force += press.force();
    }
    out.push_back({&measures[0], count}), out.push_back({&measures[1], deepest}), out.push_back({&measures[2], force});
    out.push_back({&measures[3], dropped});
}

void Contacts::marks(const Positions& x, Marks& out) const {
    MarkGroup group{std::string(contact_type.name), "force", "N", {}};
    look_at(x);
    for (const KeptContact& c : kept_.contacts) {
        if (is_left_to_attachments(c)) continue;
        const Vec3 p = places_[at(c.source)][at(c.point)];
        const Vec3 place(c.place[0], c.place[1], c.place[2]);
        group.marks.push_back({static_cast<int>(bodies_.part(c.source)),
                               p,
                               place_at(c.target, c.triangle, place),
                               c.force,
                               {bodies_[c.source].body(), bodies_[c.target].body()}});
    }
    mark_cloth(x, group);
    out.push_back(std::move(group));
}

} // namespace sinew::solver
