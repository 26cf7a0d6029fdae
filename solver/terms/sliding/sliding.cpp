// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/sliding/sliding.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sinew::solver {

namespace {

constexpr Measure measures[] = {
    {"sliding", "max_stretch_m", "m", "largest way of sliding points from where they may be", Combine::most},
    {"sliding", "force_N", "N", "sum of the forces of sliding attachments", Combine::most},
};

bool all_bones(const Scene& scene) {
    const auto& attachments = scene.description().attachments;
    return std::none_of(attachments.begin(), attachments.end(),
                        [&](const AttachmentRest& a) { return scene.tissue(a.source) || scene.tissue(a.target); });
}

} // namespace

const TermType sliding_type{
    .name = "sliding",
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        return all_bones(scene) ? nullptr : std::make_unique<Slides>(scene);
    },
    .memory_version = 1,
    .has_memory = true,
};

Changes Slides::take(const StepInputs& inputs, const State& before) {
    wanted_.clear();
    for (std::size_t a = 0; a < inputs.attachments.size(); ++a) {
        const AttachmentRest& rest = scene_.description().attachments[a];
        // Between bones there is nothing to move.
        wanted_.push_back(inputs.attachments[a].mode() == AttachmentMode::sliding &&
                          (scene_.tissue(rest.source) || scene_.tissue(rest.target)));
    }
    const bool any = std::find(wanted_.begin(), wanted_.end(), 1) != wanted_.end();
    const TermMemory* memory = find_memory(before.memories, attachment_type.name);
    const bool same = wanted_ == on_ && (!any || (memory && *memory == anchors_));
    if (!same) {
        slides_.clear(), rides_.clear();
        on_ = wanted_;
        if (any) {
            const AttachmentMemory attachments = attachments_kept(before.memories);
            check_kept(scene_, inputs.attachments, attachments);
            make_slides(attachments);
            anchors_ = *memory;
        }
    }
    slides_kept(before.memories, kept_);
    kept_.places.resize(on_.size());
    for (std::size_t a = 0; a < on_.size(); ++a) {
        std::vector<SlidingMemory::Place>& places = kept_.places[a];
        if (!on_[a]) {
            places.clear();
            continue;
        }
        if (places.empty()) begin_sliding(a, before);
        const auto count =
            std::count_if(slides_.begin(), slides_.end(), [&](const Slide& s) { return at(s.attachment) == a; });
        const auto triangles =
            static_cast<int>(targets_[at(scene_.description().attachments[a].target)]->surface().triangles().size());
        const bool fits = std::ptrdiff_t(places.size()) == count &&
                          std::all_of(places.begin(), places.end(), [&](const SlidingMemory::Place& p) {
                              return p.triangle >= 0 && p.triangle < triangles;
                          });
        if (!fits) throw Error("IO403", "a saved simulation state holds sliding attachments of another scene");
    }
    return {.couplings = !same};
}

void Slides::make_slides(const AttachmentMemory& attachments) {
    const auto& rests = scene_.description().attachments;
    targets_.resize(at(scene_.body_count())), allowed_.resize(rests.size());
    for (std::size_t a = 0; a < rests.size(); ++a) {
        const AttachmentRest& rest = rests[a];
        if (!on_[a]) continue;
        std::unique_ptr<SlidingTarget>& target = targets_[at(rest.target)];
        if (!target) target = std::make_unique<SlidingTarget>(scene_, rest.target);
        allowed_[a] = target->allowed(scene_, rest);
        for (const Anchor& anchor : attachments.anchors[a]) {
            slides_.push_back(
                {static_cast<int>(a), at(rest.target), rides_.size(), 0, anchor.area_weight, anchor.source});
            if (!scene_.tissue(rest.source)) continue;
            const PointWeights point = scene_.embedded(rest.source, anchor.source.tet, anchor.source.coordinates);
            for (int k = 0; k < point.count; ++k)
                if (point.weight[k] != 0) rides_.push_back({point.vertex[k], point.weight[k]});
            slides_.back().terms = static_cast<int>(rides_.size() - slides_.back().first_term);
        }
    }
    now_.resize(slides_.size()), points_.resize(slides_.size()), starts_.resize(slides_.size());
    heights_.resize(slides_.size()), nearest_.resize(slides_.size());
    elements_.resize(slides_.size()), height_elements_.resize(slides_.size()), brake_elements_.resize(slides_.size());
    pulls_.resize(rests.size()), bones_.resize(at(scene_.body_count()));
}

Vec3 Slides::point_of(const Slide& s, const Positions& x, const std::vector<Points>& bones) const {
    if (s.terms == 0) return bone_point(s.source, bones[at(scene_.description().attachments[at(s.attachment)].source)]);
    Vec3 p = Vec3::Zero();
    for (const RideTerm& t : ride(s)) p += t.weight * Eigen::Map<const Vec3>(x.data() + 3 * at(t.vertex));
    return p;
}

/// At the nearest places where everything is before the step.
void Slides::begin_sliding(std::size_t attachment, const State& before) {
    const AttachmentRest& rest = scene_.description().attachments[attachment];
    SlidingTarget& target = *targets_[at(rest.target)];
    const double* carriers =
        target.surface().deforms() ? before.x.data() : before.bones[at(rest.target)].data()->data();
    SurfaceBoxes boxes;
    boxes.fit(target.surface(), carriers);
    target.place(carriers);
    const std::vector<char>& flags = allowed_[attachment];
    for (const Slide& s : slides_) {
        if (at(s.attachment) != attachment) continue;
        const Vec3 p = point_of(s, before.x, before.bones);
        const ClosestFeature nearest =
            find_feature(target.surface(), boxes, p, 1e300, [&](int t) { return flags.empty() || flags[at(t)]; });
        SlidingMemory::Place place;
        place.triangle = nearest.triangle;
        if (rest.maintain_offset) {
            const ClosestFeature any =
                flags.empty() ? nearest : follow_feature(target.surface(), target.places(), nearest.triangle, p);
            place.height = target.height_over(target.feature_of(any), p).value;
        }
        kept_.places[attachment].push_back(place);
    }
}

void Slides::add_couplings(Couplings& couplings) const {
    // What carries one point is coupled: elements couple most of that in any case. What carries the target is not
    // coupled with what carries the source, as that changes: the matrix's overlay takes it.
    const auto add = [&](std::span<const RideTerm> ride) {
        for (const RideTerm& a : ride)
            for (const RideTerm& b : ride)
                if (a.vertex < b.vertex) couplings.emplace_back(a.vertex, b.vertex);
    };
    std::vector<char> used(targets_.size(), 0);
    for (const Slide& s : slides_) add(ride(s)), used[s.target] = 1;
    for (std::size_t t = 0; t < targets_.size(); ++t)
        for (std::size_t p = 0; used[t] && p < targets_[t]->surface().point_count(); ++p)
            add(targets_[t]->surface().free_ride(static_cast<int>(p)));
}

void Slides::bind(const BlockPattern& pattern) {
    pattern_ = &pattern;
    for (auto* elements : {&elements_, &height_elements_, &brake_elements_})
        for (PointTriangleElement& e : *elements) e.forget();
}

void Slides::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    if (slides_.empty()) return;
    double longest = 0, force = 0;
    look_at(x);
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const double off = residual(i);
        longest = std::max(longest, off), force += stiffness(slides_[i]) * off;
    }
    out.push_back({&measures[0], longest}), out.push_back({&measures[1], force});
}

void Slides::remember(const Positions& x, bool, TermMemory& memory) const {
    if (slides_.empty()) return memory.bytes.clear();
    look_at(x);
    std::vector<std::size_t>& next = next_;
    next.assign(kept_.places.size(), 0);
    remembered_ = kept_;
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const std::size_t a = at(slides_[i].attachment);
        remembered_.places[a][next[a]++].triangle = find_nearest(i, points_[i]).allowed.triangle;
    }
    keep_slides(remembered_, memory);
}

} // namespace sinew::solver
