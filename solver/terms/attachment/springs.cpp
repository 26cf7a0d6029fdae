// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/springs.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace sinew::solver {

namespace {

constexpr std::size_t grain = 64;

/// An expansion is made anew where the energy is a smaller share of what it was: sums of terms a hundred times larger
/// than their result lose two digits of sixteen.
constexpr double near_share = 0.01;

Vec3 point_of(const std::vector<double>& x, int vertex) { return Eigen::Map<const Vec3>(x.data() + 3 * at(vertex)); }

} // namespace

Springs::Springs(const Scene& scene, AttachmentView kept)
    : scene_(scene)
    , kept_(std::move(kept))
    , bundles_(scene, kept_.anchors) {
    coupling_.make(scene, bundles_);
    pulls_.resize(scene.description().attachments.size());
    places_.resize(bundles_.spring_count()), of_springs_.resize(bundles_.spring_count());
    const std::size_t nodes = coupling_.nodes().size();
    for (auto* by_node : {&base_, &forces_, &elastic_forces_, &moves_, &products_}) by_node->resize(nodes);
    node_square_.resize(nodes);
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
    references_.resize(any_viscous ? bundles_.spring_count() : 0);
    elastic_of_springs_.resize(references_.size());
    parallel_for(bundles_.count(), grain, [&](std::size_t b) {
        const int attachment = bundles_.attachment(b);
        const AttachmentRest& rest = attachments[at(attachment)];
        const bool to_bone = scene_.bone(rest.target), from_bone = scene_.bone(rest.source);
        const std::span<const int> vertices = bundles_.vertices(b);
        bundles_.for_each_spring(b, [&](const SpringBundles::Spring& s) {
            const Anchor& anchor = kept_.anchors[at(attachment)][at(s.anchor)];
            Vec3 place = Vec3::Zero(), velocity = Vec3::Zero();
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
            places_[s.number] = place;
            if (!any_viscous) return;
            references_[s.number] = Vec3::Zero();
            if (pulls_[at(attachment)].viscous == 0) return;
            // Relative velocity = sum c (factor x + offset) - velocity of the anchor = factor (stretch - reference).
            Vec3 offset = Vec3::Zero();
            for (std::size_t i = 0; i < vertices.size(); ++i)
                offset += s.coefficients[i] * point_of(form.velocity_offset, vertices[i]);
            references_[s.number] = (velocity - offset) / form.velocity_factor - place;
        });
    });
    coupling_.set_pulls(pulls_);
    expand(before.x);
}

template <class Visit>
void Springs::for_each_stretch(std::size_t bundle, const std::vector<double>& x, const Visit& visit) const {
    const std::span<const int> vertices = bundles_.vertices(bundle);
    std::array<Vec3, SpringBundles::most_vertices> points;
    for (std::size_t i = 0; i < vertices.size(); ++i) points[i] = point_of(x, vertices[i]);
    bundles_.for_each_spring(bundle, [&](const SpringBundles::Spring& s) {
        Vec3 sum = -places_[s.number];
        for (std::size_t i = 0; i < vertices.size(); ++i) sum += s.coefficients[i] * points[i];
        visit(s, sum);
    });
}

void Springs::gather(const std::vector<Vec3>& of_springs, std::vector<Vec3>& at_nodes) const {
    parallel_for(at_nodes.size(), 64, [&](std::size_t n) {
        Vec3 sum = Vec3::Zero();
        for (const auto& [bundle, vertex] : coupling_.places(n))
            bundles_.for_each_spring(at(bundle), [&, own = at(vertex)](const SpringBundles::Spring& s) {
                sum += s.coefficients[own] * of_springs[s.number];
            });
        at_nodes[n] = sum;
    });
}

void Springs::expand(const std::vector<double>& x) {
    energy_ = ordered_sum(bundles_.count(), [&](std::size_t b) {
        const SpringPull& pull = pulls_[at(bundles_.attachment(b))];
        double energy = 0;
        for_each_stretch(b, x, [&](const SpringBundles::Spring& s, const Vec3& d) {
            const Vec3 elastic = s.area_weight * pull.stiffness * d;
            of_springs_[s.number] = elastic;
            energy += 0.5 * elastic.dot(d);
            if (!viscous()) return;
            const Vec3 moved = d - references_[s.number];
            elastic_of_springs_[s.number] = elastic;
            of_springs_[s.number] += s.area_weight * pull.viscous * moved;
            energy += 0.5 * s.area_weight * pull.viscous * moved.squaredNorm();
        });
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
    const std::size_t chunk = (bundles_.count() + parts.size() - 1) / parts.size();
    parallel_for(parts.size(), 4, [&](std::size_t p) {
        for (std::size_t b = p * chunk; b < std::min((p + 1) * chunk, bundles_.count()); ++b)
            for_each_stretch(b, x, [&](const SpringBundles::Spring&, const Vec3& d) {
                parts[p] = std::max(parts[p], d.squaredNorm());
            });
    });
    return std::sqrt(*std::max_element(parts.begin(), parts.end()));
}

double Springs::stored_energy(const std::vector<double>& x) const {
    return ordered_sum(bundles_.count(), [&](std::size_t b) {
        const double stiffness = pulls_[at(bundles_.attachment(b))].stiffness;
        double energy = 0;
        for_each_stretch(b, x, [&](const SpringBundles::Spring& s, const Vec3& d) {
            energy += 0.5 * stiffness * s.area_weight * d.squaredNorm();
        });
        return energy;
    });
}

} // namespace sinew::solver
