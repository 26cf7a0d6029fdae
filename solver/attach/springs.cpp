// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/attach/springs.h"

#include "solver/attach/anchors.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

/// Adds the embedded point sum_k sign b_k x_k to a spring; vertices that both ends share are merged.
void add_point(Spring& s, const PointWeights& point, double sign) {
    for (int k = 0; k < point.count; ++k) {
        int i = 0;
        while (i < s.count && s.vertex[i] != point.vertex[k]) ++i;
        if (i == s.count) s.vertex[s.count] = point.vertex[k], s.coefficient[s.count++] = 0;
        s.coefficient[i] += sign * point.weight[k];
    }
}

} // namespace

Springs::Springs(const Scene& scene, const std::vector<std::vector<Anchor>>& anchors)
    : scene_(scene) {
    const auto& attachments = scene.description().attachments;
    for (std::size_t a = 0; a < anchors.size(); ++a) {
        const TissueRest* source = scene.tissue(attachments[a].source);
        const TissueRest* target = scene.tissue(attachments[a].target);
        if (!source && !target) continue;
        for (std::size_t i = 0; i < anchors[a].size(); ++i) {
            const Anchor& anchor = anchors[a][i];
            Spring s;
            s.attachment = static_cast<int>(a);
            s.anchor_index = static_cast<int>(i);
            s.area_weight = anchor.area_weight;
            if (source) s.body[0] = attachments[a].source;
            if (target) s.body[1] = attachments[a].target;
            if (source) {
                const std::size_t v = static_cast<std::size_t>(anchor.source_vertex);
                const bool on_edge = anchor.source_tet >= 0;
                add_point(s,
                          scene.embedded(attachments[a].source, on_edge ? anchor.source_tet : source->embedding.tet[v],
                                         on_edge ? anchor.source_coordinates : source->embedding.barycentric[v]),
                          1);
            }
            if (target)
                add_point(s, scene.embedded(attachments[a].target, anchor.target_tet, anchor.coordinates),
                          source ? -1 : 1);
            springs_.push_back(s);
        }
    }
    values_.resize(springs_.size());
}

void Springs::add_couplings(std::vector<std::pair<int, int>>& couplings) const {
    for (const Spring& s : springs_)
        for (int i = 0; i < s.count; ++i)
            for (int j = 0; j < i; ++j) couplings.emplace_back(s.vertex[i], s.vertex[j]);
}

void Springs::begin_stage(const StepInputs& inputs, const State& before, const std::vector<Points>& bones_after,
                          const ImplicitForm& form) {
    const auto& attachments = scene_.description().attachments;
    const auto bones = bones_weighed(form, before, bones_after);
    for (std::size_t k = 0; k < springs_.size(); ++k) {
        const Spring& s = springs_[k];
        const std::size_t a = static_cast<std::size_t>(s.attachment);
        const Anchor& anchor = before.anchors[a][static_cast<std::size_t>(s.anchor_index)];
        const AttachmentInputs& in = inputs.attachments[a];
        const AttachmentRest& rest = attachments[a];
        Values& v = values_[k];
        v.stiffness = in.stiffness * in.envelope * s.area_weight;
        v.viscous = in.damping * form.velocity_factor * s.area_weight;
        Vec3 velocity = Vec3::Zero();
        v.anchor = Vec3::Zero();
        for (std::size_t time = 0; time < 3; ++time) {
            if (form.bone_position[time] == 0 && form.bone_velocity[time] == 0) continue;
            Vec3 p = Vec3::Zero();
            if (const BoneRest* bone = scene_.bone(rest.target))
                p = bone_anchor(anchor, bone->triangles, (*bones[time])[static_cast<std::size_t>(rest.target)]);
            else if (scene_.bone(rest.source))
                p = (*bones[time])[static_cast<std::size_t>(rest.source)]
                                  [static_cast<std::size_t>(anchor.source_vertex)];
            v.anchor += form.bone_position[time] * p;
            velocity += form.bone_velocity[time] * p;
        }
        v.reference = Vec3::Zero();
        if (v.viscous == 0) continue;
        // Relative velocity = sum c (factor x + offset) - velocity of the anchor = factor (stretch - reference).
        Vec3 offset = Vec3::Zero();
        for (int i = 0; i < s.count; ++i)
            for (int c = 0; c < 3; ++c)
                offset[c] +=
                    s.coefficient[i] *
                    form.velocity_offset[3 * static_cast<std::size_t>(s.vertex[i]) + static_cast<std::size_t>(c)];
        v.reference = (velocity - offset) / form.velocity_factor - v.anchor;
    }
}

Vec3 Springs::stretch(const Spring& s, const Values& v, const std::vector<double>& x) const {
    Vec3 sum = -v.anchor;
    for (int i = 0; i < s.count; ++i)
        for (int c = 0; c < 3; ++c)
            sum[c] += s.coefficient[i] * x[3 * static_cast<std::size_t>(s.vertex[i]) + static_cast<std::size_t>(c)];
    return sum;
}

double Springs::energy(const std::vector<double>& x, double* gradient) const {
    double total = 0;
    for (std::size_t k = 0; k < springs_.size(); ++k) {
        const Spring& s = springs_[k];
        const Values& v = values_[k];
        const Vec3 d = stretch(s, v, x), moved = d - v.reference;
        total += 0.5 * v.stiffness * d.squaredNorm() + 0.5 * v.viscous * moved.squaredNorm();
        if (!gradient) continue;
        const Vec3 force = v.stiffness * d + v.viscous * moved;
        for (int i = 0; i < s.count; ++i)
            for (int c = 0; c < 3; ++c)
                gradient[3 * static_cast<std::size_t>(s.vertex[i]) + static_cast<std::size_t>(c)] +=
                    s.coefficient[i] * force[c];
    }
    return total;
}

void Springs::set_pattern(const BlockPattern& pattern, const std::vector<int>& unknown) {
    std::vector<std::pair<int, Entry>> entries; // of the upper triangle, by block
    for (std::size_t k = 0; k < springs_.size(); ++k) {
        const Spring& s = springs_[k];
        for (int i = 0; i < s.count; ++i) {
            const int row = unknown[static_cast<std::size_t>(s.vertex[i])];
            for (int j = 0; j < s.count && row >= 0; ++j) {
                const int column = unknown[static_cast<std::size_t>(s.vertex[j])];
                if (column < row) continue; // also skips fixed vertices
                entries.push_back(
                    {pattern.find(row, column), {static_cast<int>(k), s.coefficient[i] * s.coefficient[j]}});
            }
        }
    }
    std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    blocks_.clear();
    entries_.clear();
    entry_start_.clear();
    for (const auto& [block, entry] : entries) {
        if (blocks_.empty() || blocks_.back() != block) {
            blocks_.push_back(block);
            entry_start_.push_back(entries_.size());
        }
        entries_.push_back(entry);
    }
    entry_start_.push_back(entries_.size());
}

void Springs::add_hessian(BlockMatrix& a) const {
    parallel_for(blocks_.size(), 512, [&](std::size_t b) {
        double sum = 0;
        for (std::size_t e = entry_start_[b]; e < entry_start_[b + 1]; ++e) {
            const Values& v = values_[static_cast<std::size_t>(entries_[e].spring)];
            sum += (v.stiffness + v.viscous) * entries_[e].product;
        }
        double* block = a.block(static_cast<std::size_t>(blocks_[b]));
        for (int c = 0; c < 3; ++c) block[4 * c] += sum;
    });
}

void Springs::add_squared_forces(const std::vector<double>& x, std::vector<double>& of_body) const {
    for (std::size_t k = 0; k < springs_.size(); ++k) {
        const double square = (values_[k].stiffness * stretch(springs_[k], values_[k], x)).squaredNorm();
        for (const int body : springs_[k].body)
            if (body >= 0) of_body[static_cast<std::size_t>(body)] += square;
    }
}

void Springs::add_squared_stiffnesses(std::vector<double>& of_body) const {
    for (std::size_t k = 0; k < springs_.size(); ++k)
        for (const int body : springs_[k].body)
            if (body >= 0) of_body[static_cast<std::size_t>(body)] += values_[k].stiffness * values_[k].stiffness;
}

double Springs::longest(const std::vector<double>& x) const {
    double longest = 0;
    for (std::size_t k = 0; k < springs_.size(); ++k)
        longest = std::max(longest, stretch(springs_[k], values_[k], x).norm());
    return longest;
}

double Springs::stored_energy(const std::vector<double>& x) const {
    double total = 0;
    for (std::size_t k = 0; k < springs_.size(); ++k)
        total += 0.5 * values_[k].stiffness * stretch(springs_[k], values_[k], x).squaredNorm();
    return total;
}

} // namespace sinew::solver
