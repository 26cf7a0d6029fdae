// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/attachment.h"

#include "solver/error.h"
#include "solver/terms/attachment/anchors.h"
#include "solver/terms/elastic/layer_mix.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

namespace sinew::solver {

namespace {

constexpr Measure measures[] = {
    {"attachment", "max_stretch_m", "m", "largest attachment stretch", Combine::most},
};

} // namespace

const TermType attachment_type{
    .name = "attachment",
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        return scene.description().attachments.empty() ? nullptr : std::make_unique<Attachments>(scene);
    },
    .start = [](const Scene& scene, const StepInputs& inputs, const std::vector<Points>& surfaces,
                TermMemory& memory) { keep_attachments(make_anchors(scene, inputs.attachments, surfaces), memory); },
    .memory_version = 1,
    .has_memory = true,
    .pulls = true,
};

Attachments::Attachments(const Scene& scene)
    : scene_(scene)
    , edges_(tet_edges(scene)) {}

Changes Attachments::take(const StepInputs& inputs, const State& before) {
    const TermMemory* memory = find_memory(before.memories, attachment_type.name);
    const auto& attachments = scene_.description().attachments;
    const bool same_anchors = springs_ && memory && *memory == memory_;
    limit_single(inputs, before, same_anchors);
    wanted_.clear();
    for (std::size_t a = 0; a < attachments.size(); ++a) {
        const AttachmentInputs& in = inputs.attachments[a];
        // Whatever the envelope is: one that is keyed from nothing to all couples the same vertices at all times. And
        // within a step as at its start: patches of softer springs and single stiff ones are right, too.
        char held = in.mode() != AttachmentMode::fixed ? off : in.stiffness > most_single_[a] ? by_patches : by_springs;
        if (keeps_couplings_ && held != off && held_[a] != off) held = held_[a];
        wanted_.push_back(held);
    }
    const bool same = same_anchors && wanted_ == held_;
    if (!same) {
        AttachmentView kept = attachments_kept(before.memories);
        check_kept(scene_, inputs.attachments, kept);
        std::vector<int> sides;
        for (std::size_t a = 0; a < wanted_.size(); ++a) {
            if (wanted_[a] == off) kept.anchors[a] = {};
            sides.push_back(wanted_[a] == by_patches ? patch_side(scene_, attachments[a], edges_) : -1);
        }
        springs_ = std::make_unique<Springs>(scene_, std::move(kept), sides);
        memory_ = *memory, held_ = wanted_;
    }
    springs_->limit_single(most_single_);
    return {.couplings = !same};
}

void Attachments::limit_single(const StepInputs& inputs, const State& before, bool same_anchors) {
    const auto& attachments = scene_.description().attachments;
    if (!same_anchors) {
        const AttachmentView kept = attachments_kept(before.memories);
        check_kept(scene_, inputs.attachments, kept);
        held_tets_.clear();
        for (std::size_t a = 0; a < attachments.size(); ++a)
            held_tets_.push_back(held_tets(scene_, attachments[a], kept.anchors[a]));
    }
    bool same = same_anchors;
    materials_.resize(static_cast<std::size_t>(scene_.body_count()));
    for (const auto& ends : held_tets_)
        for (const HeldTets& end : ends) {
            if (end.body < 0) continue;
            const auto& now = std::get<TissueInputs>(inputs.bodies[static_cast<std::size_t>(end.body)]);
            std::vector<TissueInputs>& seen = materials_[static_cast<std::size_t>(end.body)];
            if (!seen.empty() && same_material(seen.front(), now)) continue;
            seen.assign(1, now), seen.front().forces = {}; // of the vertices: many, and no material
            same = false;
        }
    if (same) return;
    most_single_.clear();
    for (const auto& held : held_tets_) most_single_.push_back(single_stiffness(scene_, held, edges_, inputs));
}

double Attachments::energy(const Positions& x, bool with_forces) {
    if (with_forces) gradient_.clear(x.size());
    return springs_->energy(x, with_forces ? gradient_.data() : nullptr);
}

void Attachments::raise_forces_at_work(const Positions& x, std::span<double> largest) const {
    of_body_.assign(static_cast<std::size_t>(scene_.body_count()), 0.0);
    springs_->add_squared_forces(x, of_body_);
    const auto& bodies = scene_.numbering().deformables;
    for (std::size_t d = 0; d < bodies.size(); ++d)
        largest[d] = std::max(largest[d], std::sqrt(of_body_[static_cast<std::size_t>(bodies[d].body)]));
}

void Attachments::add_squared_stiffnesses(std::span<double> squares) const {
    of_body_.assign(static_cast<std::size_t>(scene_.body_count()), 0.0);
    springs_->add_squared_stiffnesses(of_body_);
    const auto& bodies = scene_.numbering().deformables;
    for (std::size_t d = 0; d < bodies.size(); ++d) squares[d] += of_body_[static_cast<std::size_t>(bodies[d].body)];
}

void Attachments::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    out.push_back({&measures[0], springs_->longest(x)});
}

} // namespace sinew::solver
