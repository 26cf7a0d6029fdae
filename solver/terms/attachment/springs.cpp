// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/springs.h"

#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sinew::solver {

namespace {

constexpr std::size_t grain = 256;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Vec3 point_of(const std::vector<double>& x, int vertex) { return Eigen::Map<const Vec3>(x.data() + 3 * at(vertex)); }

} // namespace

Springs::Springs(const Scene& scene, std::vector<std::vector<Anchor>> anchors)
    : scene_(scene)
    , anchors_(std::move(anchors)) {
    const auto& attachments = scene.description().attachments;
    for (std::size_t a = 0; a < anchors_.size(); ++a) {
        const int source = attachments[a].source, target = attachments[a].target;
        const bool pulls_source = scene.tissue(source), pulls_target = scene.tissue(target);
        if (!pulls_source && !pulls_target) continue;
        for (std::size_t i = 0; i < anchors_[a].size(); ++i) {
            const Anchor& anchor = anchors_[a][i];
            springs_.push_back({static_cast<int>(a), static_cast<int>(i), terms_.size(), 0, anchor.area_weight});
            if (pulls_source) add_end(anchor.source, source, 1);
            if (pulls_target) add_end(anchor.target, target, pulls_source ? -1 : 1);
        }
    }
    pulls_.resize(attachments.size());
    places_.resize(springs_.size()), references_.resize(springs_.size()), forces_.resize(springs_.size());
    make_nodes();
    make_groups();
}

/// Adds an embedded point to the last spring.
void Springs::add_end(const AnchorEnd& end, int body, double sign) {
    const PointWeights point = scene_.embedded(body, end.tet, end.coordinates);
    for (int k = 0; k < point.count; ++k) terms_.push_back({point.vertex[k], sign * point.weight[k]});
    springs_.back().count += point.count;
}

/// Finds what each vertex gets, in the order of the springs, which fixes the order of every sum.
void Springs::make_nodes() {
    std::vector<std::pair<int, Share>> shares; // by vertex
    for (std::size_t s = 0; s < springs_.size(); ++s)
        for (std::size_t k = 0; k < at(springs_[s].count); ++k) {
            const Term& term = terms_[springs_[s].first_term + k];
            shares.push_back({term.vertex, {static_cast<int>(s), term.coefficient}});
        }
    std::stable_sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    int body = 0;
    for (const auto& [vertex, share] : shares) {
        const Spring& spring = springs_[at(share.spring)];
        const bool new_node = nodes_.empty() || nodes_.back().vertex != vertex;
        if (new_node) {
            while (vertex >= scene_.first_vertex(body) + static_cast<int>(scene_.vertex_count(body))) ++body;
            nodes_.push_back({vertex, body, shares_.size(), loads_.size()});
        }
        if (new_node || loads_.back().attachment != spring.attachment) loads_.push_back({spring.attachment, 0});
        loads_.back().area += spring.area_weight * std::abs(share.coefficient);
        shares_.push_back(share);
    }
    node_square_.resize(nodes_.size());
    nodes_.push_back({-1, -1, shares_.size(), loads_.size()});
}

void Springs::make_groups() {
    std::vector<int> order(springs_.size());
    std::iota(order.begin(), order.end(), 0);
    // By attachment, then by vertices.
    const auto compare = [&](int a, int b) {
        const Spring &s = springs_[at(a)], &t = springs_[at(b)];
        if (s.attachment != t.attachment) return s.attachment < t.attachment ? -1 : 1;
        if (s.count != t.count) return s.count < t.count ? -1 : 1;
        for (std::size_t k = 0; k < at(s.count); ++k) {
            const int v = terms_[s.first_term + k].vertex, w = terms_[t.first_term + k].vertex;
            if (v != w) return v < w ? -1 : 1;
        }
        return 0;
    };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return compare(a, b) < 0; });
    for (const int s : order) {
        if (groups_.empty() || compare(groups_.back().front(), s) != 0) groups_.emplace_back();
        groups_.back().push_back(s);
    }
}

void Springs::add_couplings(std::vector<std::pair<int, int>>& couplings) const {
    for (const Group& group : groups_) {
        const Spring& s = springs_[at(group.front())];
        const Term* term = terms_.data() + s.first_term;
        for (int i = 0; i < s.count; ++i)
            for (int j = 0; j < i; ++j) couplings.emplace_back(term[i].vertex, term[j].vertex);
    }
}

void Springs::begin_stage(const StepInputs& inputs, const State& before, const std::vector<Points>& bones_after,
                          const ImplicitForm& form) {
    const auto& attachments = scene_.description().attachments;
    const auto bones = bones_weighed(form, before, bones_after);
    for (std::size_t a = 0; a < pulls_.size(); ++a) {
        const AttachmentInputs& in = inputs.attachments[a];
        pulls_[a] = {in.stiffness * in.envelope, in.damping * in.envelope * form.velocity_factor};
    }
    parallel_for(springs_.size(), grain, [&](std::size_t k) {
        const Spring& s = springs_[k];
        const Anchor& anchor = anchors_[at(s.attachment)][at(s.anchor)];
        const AttachmentRest& rest = attachments[at(s.attachment)];
        Vec3 place = Vec3::Zero(), velocity = Vec3::Zero();
        const bool to_bone = scene_.bone(rest.target), from_bone = scene_.bone(rest.source);
        for (std::size_t time = 0; time < 3 && (to_bone || from_bone); ++time) {
            if (form.bone_position[time] == 0 && form.bone_velocity[time] == 0) continue;
            const Vec3 p = to_bone ? bone_anchor(anchor, (*bones[time])[at(rest.target)])
                                   : bone_point(anchor.source, (*bones[time])[at(rest.source)]);
            place += form.bone_position[time] * p;
            velocity += form.bone_velocity[time] * p;
        }
        places_[k] = place;
        references_[k] = Vec3::Zero();
        if (pulls_[at(s.attachment)].viscous == 0) return;
        // Relative velocity = sum c (factor x + offset) - velocity of the anchor = factor (stretch - reference).
        Vec3 offset = Vec3::Zero();
        for (std::size_t i = s.first_term; i < s.first_term + at(s.count); ++i)
            offset += terms_[i].coefficient * point_of(form.velocity_offset, terms_[i].vertex);
        references_[k] = (velocity - offset) / form.velocity_factor - place;
    });
}

Vec3 Springs::stretch(std::size_t spring, const std::vector<double>& x) const {
    const Spring& s = springs_[spring];
    Vec3 sum = -places_[spring];
    for (std::size_t i = s.first_term; i < s.first_term + at(s.count); ++i)
        sum += terms_[i].coefficient * point_of(x, terms_[i].vertex);
    return sum;
}

Vec3 Springs::gathered(std::size_t node) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = nodes_[node].first_share; i < nodes_[node + 1].first_share; ++i)
        sum += shares_[i].coefficient * forces_[at(shares_[i].spring)];
    return sum;
}

double Springs::energy(const std::vector<double>& x, double* gradient) {
    const double total = ordered_sum(springs_.size(), [&](std::size_t k) {
        const Spring& s = springs_[k];
        const Pull& pull = pulls_[at(s.attachment)];
        const Vec3 d = stretch(k, x), moved = d - references_[k];
        forces_[k] = s.area_weight * (pull.stiffness * d + pull.viscous * moved);
        return 0.5 * s.area_weight * (pull.stiffness * d.squaredNorm() + pull.viscous * moved.squaredNorm());
    });
    if (gradient)
        parallel_for(node_square_.size(), grain,
                     [&](std::size_t n) { Eigen::Map<Vec3>(gradient + 3 * at(nodes_[n].vertex)) += gathered(n); });
    return total;
}

void Springs::set_pattern(const BlockPattern& pattern, const std::vector<int>& unknown) {
    std::vector<std::pair<int, Entry>> entries; // of the upper triangle, by block
    for (const Group& group : groups_) {
        const int count = springs_[at(group.front())].count, attachment = springs_[at(group.front())].attachment;
        for (int i = 0; i < count; ++i)
            for (int j = 0; j < count; ++j) {
                const auto term = [&](int spring, int k) -> const Term& {
                    return terms_[springs_[at(spring)].first_term + at(k)];
                };
                const int row = unknown[at(term(group.front(), i).vertex)],
                          column = unknown[at(term(group.front(), j).vertex)];
                if (row < 0 || column < row) continue; // also skips fixed vertices
                double sum = 0;
                for (const int s : group)
                    sum += springs_[at(s)].area_weight * term(s, i).coefficient * term(s, j).coefficient;
                entries.push_back({pattern.find(row, column), {attachment, sum}});
            }
    }
    std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    blocks_.clear();
    entries_.clear();
    entry_start_.clear();
    for (const auto& [block, entry] : entries) { // within a block by attachment, as the groups are
        const bool new_block = blocks_.empty() || blocks_.back() != block;
        if (new_block) {
            blocks_.push_back(block);
            entry_start_.push_back(entries_.size());
        }
        if (new_block || entries_.back().attachment != entry.attachment)
            entries_.push_back(entry);
        else
            entries_.back().product += entry.product;
    }
    entry_start_.push_back(entries_.size());
}

void Springs::add_hessian(BlockMatrix& a) const {
    parallel_for(blocks_.size(), 512, [&](std::size_t b) {
        double sum = 0;
        for (std::size_t e = entry_start_[b]; e < entry_start_[b + 1]; ++e) {
            const Pull& pull = pulls_[at(entries_[e].attachment)];
            sum += (pull.stiffness + pull.viscous) * entries_[e].product;
        }
        double* block = a.block(at(blocks_[b]));
        for (int c = 0; c < 3; ++c) block[4 * c] += sum;
    });
}

void Springs::add_squared_forces(const std::vector<double>& x, std::vector<double>& of_body) {
    parallel_for(springs_.size(), grain, [&](std::size_t k) {
        forces_[k] = pulls_[at(springs_[k].attachment)].stiffness * springs_[k].area_weight * stretch(k, x);
    });
    parallel_for(node_square_.size(), grain, [&](std::size_t n) { node_square_[n] = gathered(n).squaredNorm(); });
    for (std::size_t n = 0; n < node_square_.size(); ++n) of_body[at(nodes_[n].body)] += node_square_[n];
}

void Springs::add_squared_stiffnesses(std::vector<double>& of_body) const {
    for (std::size_t n = 0; n + 1 < nodes_.size(); ++n)
        for (std::size_t l = nodes_[n].first_load; l < nodes_[n + 1].first_load; ++l) {
            const double stiffness = pulls_[at(loads_[l].attachment)].stiffness * loads_[l].area;
            of_body[at(nodes_[n].body)] += stiffness * stiffness;
        }
}

double Springs::longest(const std::vector<double>& x) const {
    double longest = 0;
    for (std::size_t k = 0; k < springs_.size(); ++k) longest = std::max(longest, stretch(k, x).norm());
    return longest;
}

double Springs::stored_energy(const std::vector<double>& x) const {
    return ordered_sum(springs_.size(), [&](std::size_t k) {
        const double k_area = pulls_[at(springs_[k].attachment)].stiffness * springs_[k].area_weight;
        return 0.5 * k_area * stretch(k, x).squaredNorm();
    });
}

} // namespace sinew::solver
