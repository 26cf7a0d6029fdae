// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/sliding/sliding.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/terms/attachment/anchors.h"
#include "solver/terms/sliding/lump_samples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace sinew::solver {

namespace {

constexpr Measure measures[] = {
    {"sliding", "max_stretch_m", "m", "largest way of sliding points from where they may be", Combine::most},
    {"sliding", "force_N", "N", "sum of the forces of sliding attachments", Combine::most},
};

/// Anchors that one tet carries where the target looks to about the same side: places in the list.
std::vector<std::vector<std::size_t>> samples_alike(std::span<const Anchor> anchors, const std::vector<Vec3>& normals) {
    constexpr double least_facing_alike = 0.8; // the cosine
    std::map<int, std::vector<std::vector<std::size_t>>> by_tet;
    for (std::size_t i = 0; i < anchors.size(); ++i) {
        auto& groups = by_tet[anchors[i].source.tet];
        auto group = std::find_if(groups.begin(), groups.end(), [&](const std::vector<std::size_t>& g) {
            return normals[g.front()].dot(normals[i]) > least_facing_alike;
        });
        if (group == groups.end()) group = groups.insert(groups.end(), std::vector<std::size_t>());
        group->push_back(i);
    }
    std::vector<std::vector<std::size_t>> out;
    for (auto& [tet, groups] : by_tet)
        for (auto& group : groups) out.push_back(std::move(group));
    return out;
}

/// Of the points that slide: where more have left the places that the matrix knows, it is laid out anew.
constexpr double most_strayed = 0.05;

bool all_bones(const Scene& scene) {
    const auto& attachments = scene.description().attachments;
    return std::none_of(attachments.begin(), attachments.end(),
                        [&](const AttachmentRest& a) { return scene.deforms(a.source) || scene.deforms(a.target); });
}

} // namespace

const TermType sliding_type{
    .name = "sliding",
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        return all_bones(scene) ? nullptr : std::make_unique<Slides>(scene);
    },
    .memory_version = 2,
    .has_memory = true,
};

Changes Slides::take(const StepInputs& inputs, const State& before) {
    wanted_.clear();
    for (std::size_t a = 0; a < inputs.attachments.size(); ++a) {
        const AttachmentRest& rest = scene_.description().attachments[a];
        // Between bones there is nothing to move.
        wanted_.push_back(inputs.attachments[a].mode() == AttachmentMode::sliding &&
                          (scene_.deforms(rest.source) || scene_.deforms(rest.target)));
    }
    const bool any = std::find(wanted_.begin(), wanted_.end(), 1) != wanted_.end();
    const TermMemory* memory = find_memory(before.memories, attachment_type.name);
    const bool same = wanted_ == on_ && (!any || (memory && *memory == anchors_));
    if (!same) {
        slides_.clear(), rides_.clear(), targets_.clear();
        homes_.assign(1, -2); // none fits: couplings are new, also where what follows throws
        first_slide_.assign(wanted_.size() + 1, 0);
        on_ = wanted_;
        if (any) {
            const AttachmentView attachments = attachments_kept(before.memories);
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
        const auto triangles =
            static_cast<int>(targets_[at(scene_.description().attachments[a].target)]->surface().triangles().size());
        const bool fits = places.size() == first_slide_[a + 1] - first_slide_[a] &&
                          std::all_of(places.begin(), places.end(), [&](const SlidingMemory::Place& p) {
                              return p.triangle >= 0 && p.triangle < triangles && p.home >= -1 && p.home < triangles;
                          });
        if (!fits) throw Error("IO403", "a saved simulation state holds sliding attachments of another scene");
    }
    // As the pattern is to be made.
    newly_home_.clear();
    for (const auto& places : kept_.places)
        for (const SlidingMemory::Place& p : places) newly_home_.push_back(p.home);
    const bool at_home = newly_home_ == homes_;
    homes_.swap(newly_home_);
    return {.couplings = !same || !at_home};
}

void Slides::make_slides(const AttachmentView& attachments) {
    const auto& rests = scene_.description().attachments;
    targets_.resize(at(scene_.body_count())), allowed_.resize(rests.size());
    for (std::size_t a = 0; a < rests.size(); ++a) {
        if (on_[a]) {
            std::unique_ptr<SlidingTarget>& target = targets_[at(rests[a].target)];
            if (!target) target = std::make_unique<SlidingTarget>(scene_, rests[a].target);
            allowed_[a] = target->allowed(scene_, rests[a]);
            add_slides(static_cast<int>(a), attachments.anchors[a]);
        }
        first_slide_[a + 1] = slides_.size();
    }
    now_.resize(slides_.size()), points_.resize(slides_.size()), starts_.resize(slides_.size());
    heights_.resize(slides_.size()), nearest_.resize(slides_.size());
    pulls_.resize(rests.size()), bones_.resize(at(scene_.body_count()));
}

void Slides::add_slides(int attachment, std::span<const Anchor> anchors) {
    const AttachmentRest& rest = scene_.description().attachments[at(attachment)];
    const auto add = [&](const AnchorEnd& source, double area_weight) {
        slides_.push_back({attachment, at(rest.target), rides_.size(), 0, area_weight, source});
        if (!scene_.deforms(rest.source)) return;
        const PointWeights point = carried_end(scene_, rest.source, source);
        for (int k = 0; k < point.count; ++k)
            if (point.weight[k] != 0) rides_.push_back({point.vertex[k], point.weight[k]});
        slides_.back().terms = static_cast<int>(rides_.size() - slides_.back().first_term);
    };
    const TissueRest* tissue = scene_.tissue(rest.source);
    if (!tissue) {
        for (const Anchor& anchor : anchors) add(anchor.source, anchor.area_weight);
        return;
    }
    const int degree = tissue->element == ElementKind::quadratic ? 4 : 2;
    for (const std::vector<std::size_t>& alike : samples_alike(anchors, modelled_normals(anchors, rest))) {
        std::vector<std::array<double, 4>> coordinates;
        std::vector<double> weights;
        for (const std::size_t i : alike)
            coordinates.push_back(anchors[i].source.coordinates), weights.push_back(anchors[i].area_weight);
        // A height that is kept may be that of any point; what is drawn to the target itself stays on the skin.
        const bool few = rest.maintain_offset && tissue->element == ElementKind::linear;
        AnchorEnd source = anchors[alike.front()].source;
        for (const LumpedSample& l :
             few ? lump_into_few(coordinates, weights) : lump_samples(coordinates, weights, degree)) {
            source.coordinates = l.coordinates;
            add(source, l.weight);
        }
    }
}

/// Of the target where each anchor holds, where it was modelled.
std::vector<Vec3> Slides::modelled_normals(std::span<const Anchor> anchors, const AttachmentRest& rest) const {
    const CarriedSurface& surface = targets_[at(rest.target)]->surface();
    const double* carriers =
        surface.deforms() ? scene_.numbering().rest.data() : scene_.bone(rest.target)->surface.data()->data();
    SurfaceBoxes boxes;
    boxes.fit(surface, carriers);
    std::vector<Vec3> out(anchors.size());
    parallel_for(anchors.size(), 64, [&](std::size_t i) {
        const Vec3 p = modelled_point(scene_, rest.target, anchors[i].target);
        out[i] = find_feature(surface, boxes, p, 1e300).normal.normalized();
    });
    return out;
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
    kept_.places[attachment].resize(first_slide_[attachment + 1] - first_slide_[attachment]);
    parallel_for(kept_.places[attachment].size(), 64, [&](std::size_t i) {
        const Slide& s = slides_[first_slide_[attachment] + i];
        const Vec3 p = point_of(s, before.x, before.bones);
        const ClosestFeature nearest =
            find_feature(target.surface(), boxes, p, 1e300, [&](int t) { return flags.empty() || flags[at(t)]; });
        SlidingMemory::Place& place = kept_.places[attachment][i];
        place.triangle = nearest.triangle;
        place.home = target.surface().deforms() && s.terms > 0 ? place.triangle : -1;
        if (rest.maintain_offset) {
            const ClosestFeature any =
                flags.empty() ? nearest : follow_feature(target.surface(), target.places(), nearest.triangle, p);
            place.height = target.height_over(target.feature_of(any), p, true).value;
        }
    });
}

void Slides::add_couplings(Couplings& couplings) const {
    // What carries one point is coupled: elements couple most of that in any case. So is what carries the source with
    // what carries the target about where it was when the matrix was laid out; what has slid farther is left to the
    // matrix's overlay.
    const auto add = [&](std::span<const RideTerm> ride) {
        for (const RideTerm& a : ride)
            for (const RideTerm& b : ride)
                if (a.vertex < b.vertex) couplings.emplace_back(a.vertex, b.vertex);
    };
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const Slide& s = slides_[i];
        add(ride(s));
        if (homes_[i] < 0) continue;
        for (const RideTerm& a : ride(s))
            for (const int vertex : targets_[s.target]->carriers_about(homes_[i]))
                if (vertex != a.vertex) couplings.emplace_back(a.vertex, vertex);
    }
    for (const auto& target : targets_)
        if (target && target->surface().deforms()) target->hessian().add_couplings(couplings);
}

void Slides::bind(const BlockPattern& pattern) {
    const std::vector<int>& unknown = scene_.numbering().unknown;
    pattern_ = &pattern;
    ties_.assign(slides_.size(), {});
    find_shares();
    entries_.clear(), first_entry_.clear();
    for (const Slide& s : slides_) {
        first_entry_.push_back(entries_.size());
        for (const RideTerm& a : ride(s))
            for (const RideTerm& b : ride(s)) {
                const int row = unknown[at(a.vertex)], column = unknown[at(b.vertex)];
                if (row >= 0 && row <= column) entries_.push_back({pattern.find(row, column), a.weight * b.weight});
            }
    }
    first_entry_.push_back(entries_.size());
    for (const auto& target : targets_)
        if (target && target->surface().deforms()) target->hessian().bind(scene_.numbering(), pattern);
}

void Slides::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    if (slides_.empty()) return;
    double longest = 0, force = 0;
    look_at(x);
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const double off = std::sqrt(std::max(0.0, squared_way(i)));
        longest = std::max(longest, off), force += stiffness(slides_[i]) * off;
    }
    out.push_back({&measures[0], longest}), out.push_back({&measures[1], force});
}

void Slides::marks(const Positions& x, Marks& out) const {
    if (slides_.empty()) return;
    look_at(x);
    MarkGroup group{std::string(sliding_type.name), "way", "m", {}};
    constexpr std::size_t most_shown = 400; // of an attachment
    for (std::size_t a = 0; a + 1 < first_slide_.size(); ++a) {
        const AttachmentRest& rest = scene_.description().attachments[a];
        const std::size_t step = (first_slide_[a + 1] - first_slide_[a]) / most_shown + 1;
        for (std::size_t i = first_slide_[a]; i < first_slide_[a + 1]; i += step)
            group.marks.push_back({slides_[i].attachment,
                                   points_[i],
                                   points_[i] - now_[i].allowed.away,
                                   std::sqrt(std::max(0.0, squared_way(i))),
                                   {rest.source, rest.target}});
    }
    out.push_back(std::move(group));
}

void Slides::remember(const Positions& x, bool, TermMemory& memory) const {
    if (slides_.empty()) return memory.bytes.clear();
    look_at(x);
    remembered_ = kept_;
    for (std::size_t a = 0; a < on_.size(); ++a)
        parallel_for(first_slide_[a + 1] - first_slide_[a], 64, [&](std::size_t k) {
            const std::size_t i = first_slide_[a] + k;
            remembered_.places[a][k].triangle = find_nearest(i, points_[i]).allowed.triangle;
        });
    // Each change of what is coupled costs an analysis.
    std::size_t strayed = 0;
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const std::size_t a = at(slides_[i].attachment);
        if (!is_near_home(*targets_[slides_[i].target], remembered_.places[a][i - first_slide_[a]])) ++strayed;
    }
    if (static_cast<double>(strayed) > most_strayed * static_cast<double>(slides_.size()))
        for (auto& places : remembered_.places)
            for (SlidingMemory::Place& p : places)
                if (p.home >= 0) p.home = p.triangle;
    keep_slides(remembered_, memory);
}

bool Slides::is_near_home(const SlidingTarget& target, const SlidingMemory::Place& place) const {
    if (place.home < 0) return true;
    const Triangle& home = target.surface().triangles()[at(place.home)];
    return std::ranges::any_of(target.surface().triangles()[at(place.triangle)],
                               [&](int v) { return has_vertex(home, v); });
}

} // namespace sinew::solver
