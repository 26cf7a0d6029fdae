// Sliding attachments within a stage: the Hessian. Each slide has blocks of its point with one or several triangles,
// made side by side; they go to the matrix carrier by carrier and pair by pair, which write to blocks of their own.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/terms/sliding/sliding.h"

#include <algorithm>
#include <map>

namespace sinew::solver {

/// What is left of a slide without its damping: at the nearest place where it may be, and if that is not the nearest
/// of all, at that one too, for the bend of its height.
void Slides::make_blocks(std::size_t i, bool project, PointTriangleBlocks& blocks) const {
    const SlidingTarget& target = *targets_[slides_[i].target];
    const ClosestFeature& f = now_[i].allowed;
    const Height& h = now_[i].height;
    const double g = heights_[i];
    if (g == 0 || nearest_[i].apart) {
        const bool on_face = (f.place.array() != 0).all();
        if (project && on_face) {
            for (Mat3& block : blocks) block.setZero();
            const Vec3 normal = face_normal(target.surface(), target.places(), f.triangle);
            add_square(f.place, normal * normal.transpose(), blocks);
        } else {
            blocks =
                point_triangle_hessian(target.surface().corners(f.triangle, target.places()), f.place, f.away, project);
        }
        return;
    }
    // Distance and height are one and the same.
    const double stretch = h.value != 0 ? 1 - g / h.value : 0, factor = project ? std::max(0.0, stretch) : stretch;
    if (factor == 0) {
        for (Mat3& block : blocks) block.setZero();
    } else {
        blocks = target.bend(h, project);
        for (Mat3& block : blocks) block *= factor;
    }
    add_square(h.place, h.normal * h.normal.transpose(), blocks);
}

/// All that a slide adds, into its places of additions_.
void Slides::make_additions(std::size_t i, bool project) {
    Addition *const first = additions_.data() + most_additions * i, *next = first;
    const double k = stiffness(slides_[i]), g = heights_[i];
    const SlidingTarget& target = *targets_[slides_[i].target];
    const Height& h = now_[i].height;
    const bool beyond = g != 0 && nearest_[i].apart;
    next->triangle = g == 0 || beyond ? now_[i].allowed.triangle : h.triangle, next->factor = k;
    make_blocks(i, project, next++->blocks);
    if (beyond && h.value != 0) {
        const double factor = project ? std::max(0.0, -g / h.value) : -g / h.value;
        if (factor != 0) {
            next->triangle = h.triangle, next->factor = k * factor;
            next++->blocks = target.bend(h, project);
        }
    }
    if (!brakes_.empty()) {
        const Brake& b = brakes_[i];
        next->triangle = b.triangle, next->factor = pulls_[at(slides_[i].attachment)].viscous * slides_[i].area_weight;
        for (Mat3& block : next->blocks) block.setZero();
        add_square(b.place, b.normal * b.normal.transpose(), next++->blocks);
    }
    addition_count_[i] = static_cast<int>(next - first);
}

void Slides::find_ties(std::size_t i, int triangle) {
    Ties& out = ties_[i];
    if (out.triangle == triangle) return;
    out.triangle = triangle, out.all = true;
    out.ties.clear();
    const Slide& s = slides_[i];
    const CarriedSurface& surface = targets_[s.target]->surface();
    const std::vector<int>& unknown = scene_.numbering().unknown;
    for (const RideTerm& one : ride(s))
        for (int c = 0; c < 3; ++c)
            for (const RideTerm& other : surface.ride(surface.triangles()[at(triangle)][at(c)])) {
                const int row = unknown[at(one.vertex)], column = unknown[at(other.vertex)];
                if (row < 0 || column < 0) continue;
                const int block = pattern_->find(std::min(row, column), std::max(row, column));
                if (block < 0) {
                    out.all = false;
                    return;
                }
                const double weight = one.weight * other.weight;
                if (row <= column) out.ties.push_back({block, c, weight, false});
                if (column <= row) out.ties.push_back({block, c, weight, true});
            }
}

template <class Visit>
void Slides::for_each_addition(const std::vector<std::size_t>& attachments, const Visit& visit) const {
    for (const std::size_t a : attachments)
        for (std::size_t i = first_slide_[a]; i < first_slide_[a + 1]; ++i)
            for (int k = 0; k < addition_count_[i]; ++k) visit(i, additions_[most_additions * i + at(k)]);
}

/// Attachments whose slides write to the same numbers, in groups: to blocks of what carries the source, to those of a
/// pair of carriers, and to sums of a target.
void Slides::find_shares() {
    shares_.clear(), between_carriers_ = true;
    const auto add = [&](Share::Kind kind, std::size_t one, std::size_t other, std::size_t attachment) {
        const auto found = std::ranges::find_if(
            shares_, [&](const Share& s) { return s.kind == kind && s.one == one && s.other == other; });
        Share& share = found == shares_.end() ? shares_.emplace_back(Share{kind, one, other, {}, {}}) : *found;
        share.attachments.push_back(attachment);
    };
    for (std::size_t a = 0; a + 1 < first_slide_.size(); ++a) {
        if (first_slide_[a] == first_slide_[a + 1]) continue;
        const AttachmentRest& rest = scene_.description().attachments[a];
        // Subtissues are bodies of their own, of which one tissue may carry several.
        const std::size_t source = at(scene_.carrier_of(rest.source)), target = at(scene_.carrier_of(rest.target));
        const bool source_deforms = scene_.deforms(rest.source), target_deforms = scene_.deforms(rest.target);
        if (source_deforms && target_deforms) add(Share::pair, std::min(source, target), std::max(source, target), a);
        if (target_deforms) add(Share::target, at(rest.target), at(rest.target), a);
        if (source_deforms) add(Share::source, source, source, a);
        between_carriers_ = between_carriers_ && source != target;
    }
    std::map<int, std::vector<std::size_t>> by_carrier;
    for (std::size_t t = 0; t < targets_.size(); ++t)
        if (targets_[t] && targets_[t]->surface().deforms())
            by_carrier[scene_.carrier_of(static_cast<int>(t))].push_back(t);
    targets_of_carriers_.clear();
    for (auto& [carrier, targets] : by_carrier) targets_of_carriers_.push_back(std::move(targets));
}

void Slides::add_share(Share& share, BlockMatrix& a) {
    share.outside.clear();
    for_each_addition(share.attachments, [&](std::size_t i, const Addition& add) {
        if (share.kind == Share::source) {
            const Mat3 own = add.blocks[0].transpose();
            for (std::size_t e = first_entry_[i]; e < first_entry_[i + 1]; ++e)
                add_scaled(add.factor * entries_[e].weight, own, a.block(at(entries_[e].block)));
        } else if (share.kind == Share::target) {
            targets_[share.one]->hessian().add(add.triangle, add.blocks, add.factor);
        } else {
            find_ties(i, add.triangle);
            if (!ties_[i].all) return share.outside.push_back({i, &add});
            const std::array<Mat3, 3> by_rows{add.blocks[1].transpose(), add.blocks[2].transpose(),
                                              add.blocks[3].transpose()};
            for (const Tie& t : ties_[i].ties)
                add_scaled(add.factor * t.weight, t.turned ? add.blocks[at(t.corner + 1)] : by_rows[at(t.corner)],
                           a.block(at(t.block)));
        }
    });
}

/// What the pattern does not couple.
void Slides::add_outside(const Share& share, BlockMatrix& a) {
    const std::vector<int>& unknown = scene_.numbering().unknown;
    for (const auto& [i, add] : share.outside) {
        const CarriedSurface& surface = targets_[slides_[i].target]->surface();
        carriers_.clear();
        const auto carry = [&](int corner, std::span<const RideTerm> ride) {
            for (const RideTerm& t : ride)
                if (unknown[at(t.vertex)] >= 0) carriers_.push_back({corner, unknown[at(t.vertex)], t.weight});
        };
        carry(0, ride(slides_[i]));
        for (int c = 0; c < 3; ++c) carry(c + 1, surface.free_ride(surface.triangles()[at(add->triangle)][at(c)]));
        a.overlay.add_across(
            carriers_, {add->factor * add->blocks[1], add->factor * add->blocks[2], add->factor * add->blocks[3]});
    }
}

void Slides::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    if (slides_.empty()) return;
    look_at(x);
    additions_.resize(most_additions * slides_.size()), addition_count_.resize(slides_.size());
    parallel_for(slides_.size(), 64, [&](std::size_t i) { make_additions(i, project); });
    for (const auto& target : targets_)
        if (target && target->surface().deforms()) target->hessian().clear();
    if (between_carriers_)
        parallel_for(shares_.size(), 1, [&](std::size_t k) { add_share(shares_[k], a); });
    else
        for (Share& share : shares_) add_share(share, a);
    for (const Share& share : shares_) add_outside(share, a);
    parallel_for(targets_of_carriers_.size(), 1, [&](std::size_t k) {
        for (const std::size_t t : targets_of_carriers_[k]) targets_[t]->hessian().add_to(a);
    });
}

} // namespace sinew::solver
