// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/held_points.h"

#include "solver/terms/attachment/anchors.h"
#include "solver/terms/attachment/attachment.h"

#include <algorithm>
#include <array>

namespace sinew::solver {

HeldPoints::HeldPoints(const Scene& scene, const CollisionBodies& bodies)
    : scene_(scene)
    , bodies_(bodies)
    , contact_body_(at(scene.body_count()), -1) {
    for (std::size_t b = 0; b < bodies.count(); ++b)
        contact_body_[at(bodies[static_cast<int>(b)].body())] = static_cast<int>(b);
}

void HeldPoints::take(const State& before) {
    const TermMemory* memory = find_memory(before.memories, attachment_type.name);
    if (!memory || (taken_ && *memory == memory_)) return;
    const AttachmentView attachments = attachments_kept(before.memories);
    struct End {
        int body = -1, in_contact = -1;
        Points places;           ///< of the samples, as modelled
        std::vector<char> flags; ///< of the points near those; none where it does not collide
    };
    std::vector<std::array<End, 2>> ends(attachments.anchors.size());
    held_.clear();
    for (std::size_t a = 0; a < ends.size(); ++a) {
        const AttachmentRest& rest = scene_.description().attachments[a];
        ends[a][0].body = rest.source, ends[a][1].body = rest.target;
        for (const Anchor& anchor : attachments.anchors[a]) {
            ends[a][0].places.push_back(modelled_point(scene_, rest.source, anchor.source));
            ends[a][1].places.push_back(modelled_point(scene_, rest.target, anchor.target));
        }
        for (End& end : ends[a]) {
            end.in_contact = contact_body_[at(end.body)];
            if (end.in_contact >= 0) end.flags = flags(end.in_contact, end.places);
        }
        const auto& [one, other] = ends[a];
        if (one.in_contact >= 0 && other.in_contact >= 0)
            held_.push_back({one.in_contact, other.in_contact, {one.flags, other.flags}, {a, a}});
    }
    // Both near where the other one is held as well: there nothing can move them apart.
    const auto near_both = [&](const End& own, const End& others) {
        std::vector<char> out = flags(own.in_contact, others.places);
        for (std::size_t p = 0; p < out.size(); ++p) out[p] = out[p] && own.flags[p];
        return out;
    };
    for (std::size_t a = 0; a < ends.size(); ++a)
        for (std::size_t b = a + 1; b < ends.size(); ++b)
            for (const std::size_t i : {0, 1})
                for (const std::size_t j : {0, 1}) {
                    const End &one = ends[a][i], &other = ends[b][j];
                    if (ends[a][1 - i].body != ends[b][1 - j].body || one.body == other.body) continue;
                    if (one.in_contact < 0 || other.in_contact < 0) continue;
                    Held both{one.in_contact, other.in_contact, {near_both(one, other), near_both(other, one)}, {a, b}};
                    const auto any = [](const std::vector<char>& f) { return std::ranges::count(f, 1) > 0; };
                    if (any(both.of[0]) || any(both.of[1])) held_.push_back(std::move(both));
                }
    memory_ = *memory, taken_ = true;
}

std::vector<char> HeldPoints::flags(int body, const Points& places) const {
    const CollisionBody& surface = bodies_[body];
    std::vector<char> out(surface.point_count(), 0);
    const std::vector<BvhNode>& nodes = surface.bvh().nodes;
    const double reach2 = surface.mean_edge() * surface.mean_edge();
    std::vector<std::size_t> open;
    for (const Vec3& place : places) {
        if (!nodes.empty()) open.push_back(0);
        while (!open.empty()) {
            const std::size_t n = open.back();
            open.pop_back();
            const BvhNode& node = nodes[n];
            if (squared_distance(node, place) > reach2) continue;
            if (node.count == 0) open.push_back(n + 1), open.push_back(at(node.first));
            for (int i = node.first; i < node.first + node.count; ++i)
                for (const int p : surface.triangles()[at(surface.bvh().order[at(i)])])
                    if ((surface.modelled(p) - place).squaredNorm() <= reach2) out[at(p)] = 1;
        }
    }
    return out;
}

void HeldPoints::find(const ContactPair& pair, std::span<const AttachmentInputs> inputs,
                      std::vector<char>& held) const {
    held.clear();
    const auto firmness = [&](std::size_t a) { return inputs[a].stiffness * inputs[a].envelope * inputs[a].holds; };
    for (const Held& h : held_) {
        const bool forwards = h.source == pair.source && h.target == pair.target;
        if (!forwards && (h.source != pair.target || h.target != pair.source)) continue;
        const auto [a, b] = h.attachments;
        const double one = firmness(a), other = firmness(b);
        const double firm = a == b ? one : one > 0 && other > 0 ? one * other / (one + other) : 0;
        if (firm < pair.stiffness) continue;
        const std::vector<char>& flags = h.of[forwards ? 0 : 1];
        held.resize(flags.size(), 0);
        for (std::size_t p = 0; p < flags.size(); ++p) held[p] = held[p] || flags[p];
    }
}

} // namespace sinew::solver
