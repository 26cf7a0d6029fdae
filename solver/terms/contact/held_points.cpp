// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/held_points.h"

#include "solver/terms/attachment/anchors.h"
#include "solver/terms/attachment/attachment.h"

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
    const AttachmentMemory attachments = attachments_kept(before.memories);
    held_.assign(attachments.anchors.size(), {});
    for (std::size_t a = 0; a < held_.size(); ++a) {
        const AttachmentRest& rest = scene_.description().attachments[a];
        Held& held = held_[a];
        held.source = contact_body_[at(rest.source)], held.target = contact_body_[at(rest.target)];
        if (held.source < 0 || held.target < 0) continue;
        Points sources, targets;
        for (const Anchor& anchor : attachments.anchors[a]) {
            sources.push_back(modelled_point(scene_, rest.source, anchor.source));
            targets.push_back(modelled_point(scene_, rest.target, anchor.target));
        }
        held.of[0] = flags(held.source, sources), held.of[1] = flags(held.target, targets);
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
    for (std::size_t a = 0; a < held_.size(); ++a) {
        const Held& h = held_[a];
        const bool forwards = h.source == pair.source && h.target == pair.target;
        if (!forwards && (h.source != pair.target || h.target != pair.source)) continue;
        if (h.source < 0 || inputs[a].stiffness * inputs[a].envelope * inputs[a].holds < pair.stiffness) continue;
        const std::vector<char>& flags = h.of[forwards ? 0 : 1];
        held.resize(flags.size(), 0);
        for (std::size_t p = 0; p < flags.size(); ++p) held[p] = held[p] || flags[p];
    }
}

} // namespace sinew::solver
