// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/springs.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace sinew::solver {

namespace {

constexpr std::size_t grain = 256;

/// An expansion is made anew where the energy is a smaller share of what it was: sums of terms a hundred times larger
/// than their result lose two digits of sixteen.
constexpr double near_share = 0.01;

Vec3 point_of(const std::vector<double>& x, int vertex) { return Eigen::Map<const Vec3>(x.data() + 3 * at(vertex)); }

} // namespace

Springs::Springs(const Scene& scene, AttachmentView kept)
    : scene_(scene)
    , kept_(std::move(kept)) {
    const auto& attachments = scene.description().attachments;
    for (std::size_t a = 0; a < kept_.anchors.size(); ++a) {
        const bool pulls_source = scene.deforms(attachments[a].source),
                   pulls_target = scene.deforms(attachments[a].target);
        if (kept_.anchors[a].empty() || (!pulls_source && !pulls_target)) continue;
        beds_.push_back({static_cast<int>(a), count_, pulls_source, pulls_target});
        count_ += kept_.anchors[a].size();
    }
    make_terms();
    make_coupling();
    make_shares();
    pulls_.resize(attachments.size());
    places_.resize(count_), of_springs_.resize(count_);
    const std::size_t nodes = coupling_.nodes().size();
    for (auto* by_node : {&base_, &forces_, &elastic_forces_, &moves_, &products_}) by_node->resize(nodes);
    node_square_.resize(nodes);
}

template <class Visit>
void Springs::for_each_term(const Bed& bed, const Anchor& anchor, const Visit& visit) const {
    const AttachmentRest& rest = scene_.description().attachments[at(bed.attachment)];
    const auto add_end = [&](const AnchorEnd& end, int body, double sign) {
        const PointWeights point = carried_end(scene_, body, end);
        for (int k = 0; k < point.count; ++k) visit(point.vertex[k], sign * point.weight[k]);
    };
    if (bed.pulls_source) add_end(anchor.source, rest.source, 1);
    if (bed.pulls_target) add_end(anchor.target, rest.target, bed.pulls_source ? -1 : 1);
}

/// Kept, since to find them anew at every visit, through the body, the tet that carries the anchor and its shape
/// functions, takes four times as many instructions as the visit itself.
void Springs::make_terms() {
    bed_.reserve(count_), area_.reserve(count_), first_term_.reserve(count_ + 1);
    std::size_t terms = 0;
    for (const Bed& bed : beds_)
        for (const Anchor& anchor : kept_.anchors[at(bed.attachment)])
            for_each_term(bed, anchor, [&](int, double) { ++terms; });
    terms_.reserve(terms);
    for (std::size_t b = 0; b < beds_.size(); ++b)
        for (const Anchor& anchor : kept_.anchors[at(beds_[b].attachment)]) {
            bed_.push_back(static_cast<int>(b)), area_.push_back(anchor.area_weight);
            first_term_.push_back(terms_.size());
            for_each_term(beds_[b], anchor, [&](int vertex, double c) { terms_.push_back({vertex, c}); });
        }
    first_term_.push_back(terms_.size());
}

void Springs::make_coupling() {
    std::vector<CoupledSpring> coupled;
    coupled.reserve(count_);
    for (std::size_t s = 0; s < count_; ++s)
        coupled.push_back({beds_[at(bed_[s])].attachment,
                           {terms_.data() + first_term_[s], first_term_[s + 1] - first_term_[s]},
                           area_[s]});
    coupling_.make(scene_, coupled);
}

/// Finds what each node gets, in the order of the springs, which fixes the order of every sum.
void Springs::make_shares() {
    std::vector<int> node_of(scene_.numbering().vertex_count(), -1);
    const std::vector<SpringCoupling::Node>& nodes = coupling_.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n) node_of[at(nodes[n].vertex)] = static_cast<int>(n);
    first_share_.assign(nodes.size() + 1, 0);
    for (const SpringTerm& t : terms_) ++first_share_[at(node_of[at(t.vertex)]) + 1];
    std::partial_sum(first_share_.begin(), first_share_.end(), first_share_.begin());
    shares_.resize(terms_.size());
    std::vector<std::size_t> next(first_share_.begin(), first_share_.end() - 1);
    for (std::size_t s = 0; s < count_; ++s)
        for (std::size_t t = first_term_[s]; t < first_term_[s + 1]; ++t)
            shares_[next[at(node_of[at(terms_[t].vertex)])]++] = {static_cast<int>(s), static_cast<int>(t)};
}

void Springs::begin_stage(const StepInputs& inputs, const State& before, const std::vector<Points>& bones_after,
                          const ImplicitForm& form) {
    const auto& attachments = scene_.description().attachments;
    const auto bones = bones_weighed(form, before, bones_after);
    for (std::size_t a = 0; a < pulls_.size(); ++a) {
        const AttachmentInputs& in = inputs.attachments[a];
        pulls_[a] = {in.stiffness * in.envelope, in.damping * in.envelope * form.velocity_factor};
    }
    const bool any_viscous =
        std::any_of(pulls_.begin(), pulls_.end(), [](const SpringPull& p) { return p.viscous != 0; });
    references_.resize(any_viscous ? count_ : 0);
    elastic_of_springs_.resize(references_.size());
    parallel_for(count_, grain, [&](std::size_t k) {
        const Bed& bed = beds_[at(bed_[k])];
        const Anchor& anchor = anchor_of(bed, k);
        const AttachmentRest& rest = attachments[at(bed.attachment)];
        Vec3 place = Vec3::Zero(), velocity = Vec3::Zero();
        const bool to_bone = scene_.bone(rest.target), from_bone = scene_.bone(rest.source);
        for (std::size_t time = 0; time < 3 && (to_bone || from_bone); ++time) {
            if (form.bone_position[time] == 0 && form.bone_velocity[time] == 0) continue;
            const Vec3 p = to_bone ? bone_anchor(anchor, (*bones[time])[at(rest.target)])
                                   : bone_point(anchor.source, (*bones[time])[at(rest.source)]);
            place += form.bone_position[time] * p;
            velocity += form.bone_velocity[time] * p;
        }
        if (scene_.cloth(rest.target)) {
            const Vec3 offset = cloth_offset(scene_, rest.target, anchor, before.x);
            place += from_bone ? Vec3(-offset) : offset;
        }
        places_[k] = place;
        if (!any_viscous) return;
        references_[k] = Vec3::Zero();
        if (pulls_[at(bed.attachment)].viscous == 0) return;
        // Relative velocity = sum c (factor x + offset) - velocity of the anchor = factor (stretch - reference).
        Vec3 offset = Vec3::Zero();
        for (std::size_t t = first_term_[k]; t < first_term_[k + 1]; ++t)
            offset += terms_[t].coefficient * point_of(form.velocity_offset, terms_[t].vertex);
        references_[k] = (velocity - offset) / form.velocity_factor - place;
    });
    coupling_.set_pulls(pulls_);
    expand(before.x);
}

Vec3 Springs::stretch(std::size_t spring, const std::vector<double>& x) const {
    Vec3 sum = -places_[spring];
    for (std::size_t t = first_term_[spring]; t < first_term_[spring + 1]; ++t)
        sum += terms_[t].coefficient * point_of(x, terms_[t].vertex);
    return sum;
}

void Springs::gather(const std::vector<Vec3>& of_springs, std::vector<Vec3>& at_nodes) const {
    parallel_for(at_nodes.size(), 64, [&](std::size_t n) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = first_share_[n]; i < first_share_[n + 1]; ++i)
            sum += terms_[at(shares_[i].term)].coefficient * of_springs[at(shares_[i].spring)];
        at_nodes[n] = sum;
    });
}

void Springs::expand(const std::vector<double>& x) {
    energy_ = ordered_sum(count_, [&](std::size_t k) {
        const double area = area_[k];
        const SpringPull& pull = pulls_[at(beds_[at(bed_[k])].attachment)];
        const Vec3 d = stretch(k, x), elastic = area * pull.stiffness * d;
        of_springs_[k] = elastic;
        double energy = 0.5 * elastic.dot(d);
        if (viscous()) {
            const Vec3 moved = d - references_[k];
            elastic_of_springs_[k] = elastic;
            of_springs_[k] += area * pull.viscous * moved;
            energy += 0.5 * area * pull.viscous * moved.squaredNorm();
        }
        return energy;
    });
    const std::vector<SpringCoupling::Node>& nodes = coupling_.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n) base_[n] = point_of(x, nodes[n].vertex);
    gather(of_springs_, forces_);
    if (viscous()) gather(elastic_of_springs_, elastic_forces_);
}

void Springs::set_moves(const std::vector<double>& x) {
    const std::vector<SpringCoupling::Node>& nodes = coupling_.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n) moves_[n] = point_of(x, nodes[n].vertex) - base_[n];
}

double Springs::energy(const std::vector<double>& x, double* gradient) {
    const std::vector<SpringCoupling::Node>& nodes = coupling_.nodes();
    set_moves(x);
    parallel_for(nodes.size(), 64, [&](std::size_t n) { products_[n] = coupling_.product(n, moves_); });
    double energy = energy_ + ordered_sum(nodes.size(), [&](std::size_t n) {
                        return moves_[n].dot(forces_[n] + 0.5 * products_[n]);
                    });
    if (std::abs(energy) < near_share * energy_) {
        expand(x);
        energy = energy_;
        std::fill(products_.begin(), products_.end(), Vec3::Zero());
    }
    if (gradient)
        for (std::size_t n = 0; n < nodes.size(); ++n)
            Eigen::Map<Vec3>(gradient + 3 * at(nodes[n].vertex)) += forces_[n] + products_[n];
    return energy;
}

void Springs::add_squared_forces(const std::vector<double>& x, std::vector<double>& of_body) {
    const std::vector<SpringCoupling::Node>& nodes = coupling_.nodes();
    const std::vector<Vec3>& here = viscous() ? elastic_forces_ : forces_;
    set_moves(x);
    parallel_for(nodes.size(), 64, [&](std::size_t n) {
        node_square_[n] = (here[n] + coupling_.elastic_product(n, moves_)).squaredNorm();
    });
    for (std::size_t n = 0; n < nodes.size(); ++n) of_body[at(nodes[n].body)] += node_square_[n];
}

double Springs::longest(const std::vector<double>& x) const {
    std::array<double, 256> parts{};
    const std::size_t chunk = (count_ + parts.size() - 1) / parts.size();
    parallel_for(parts.size(), 4, [&](std::size_t p) {
        for (std::size_t k = p * chunk; k < std::min((p + 1) * chunk, count_); ++k)
            parts[p] = std::max(parts[p], stretch(k, x).squaredNorm());
    });
    return std::sqrt(*std::max_element(parts.begin(), parts.end()));
}

double Springs::stored_energy(const std::vector<double>& x) const {
    return ordered_sum(count_, [&](std::size_t k) {
        const double k_area = pulls_[at(beds_[at(bed_[k])].attachment)].stiffness * area_[k];
        return 0.5 * k_area * stretch(k, x).squaredNorm();
    });
}

} // namespace sinew::solver
