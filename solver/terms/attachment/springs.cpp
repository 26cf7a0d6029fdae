// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/springs.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace sinew::solver {

namespace {

constexpr std::size_t grain = 64;

/// An expansion is made anew where the energy is a smaller share of what it was: sums of terms a hundred times larger
/// than their result lose two digits of sixteen.
constexpr double near_share = 0.01;

/// Of what a patch's springs have, by their areas.
Vec3 mean_of(const SpringPatches& patches, const SpringBundles& bundles, std::size_t patch,
             const std::vector<Vec3>& by_springs) {
    Vec3 sum = Vec3::Zero();
    for (const int s : patches.springs(patch)) sum += bundles.area_weight(at(s)) * by_springs[at(s)];
    return sum / patches.area(patch);
}

Vec3 point_of(const std::vector<double>& x, int vertex) { return Eigen::Map<const Vec3>(x.data() + 3 * at(vertex)); }

} // namespace

Springs::Springs(const Scene& scene, AttachmentView kept, std::span<const int> sides)
    : scene_(scene)
    , kept_(std::move(kept))
    , bundles_(scene, kept_.anchors)
    , patches_(scene, bundles_, kept_.anchors, sides)
    , most_single_(scene.description().attachments.size(), std::numeric_limits<double>::infinity()) {
    coupling_.make(scene, bundles_, patches_);
    pulls_.resize(2 * scene.description().attachments.size());
    means_.resize(patches_.count()), place_means_.resize(patches_.count());
    places_.resize(bundles_.spring_count()), of_springs_.resize(bundles_.spring_count());
    const std::size_t nodes = coupling_.nodes().size();
    for (auto* by_node : {&base_, &forces_, &elastic_forces_, &moves_, &products_}) by_node->resize(nodes);
    node_square_.resize(nodes);
}

void Springs::begin_stage(const StepInputs& inputs, const State& before, const std::vector<Points>& bones_after,
                          const ImplicitForm& form) {
    const auto& attachments = scene_.description().attachments;
    const auto bones = bones_weighed(form, before, bones_after);
    for (std::size_t a = 0; a < attachments.size(); ++a) {
        const AttachmentInputs& in = inputs.attachments[a];
        SpringPull all{in.stiffness * in.envelope, in.damping * in.envelope * form.velocity_factor};
        const bool whole = !patches_.has(static_cast<int>(a)) || all.stiffness <= most_single_[a];
        if (!whole) all.stiffness = std::min(all.stiffness, mean_over_single * most_single_[a]);
        const double single = whole ? 1 : most_single_[a] / all.stiffness;
        pulls_[a] = {single * all.stiffness, single * all.viscous};
        pulls_[attachments.size() + a] = {all.stiffness - pulls_[a].stiffness, all.viscous - pulls_[a].viscous};
    }
    const bool any_viscous =
        std::any_of(pulls_.begin(), pulls_.end(), [](const SpringPull& p) { return p.viscous != 0; });
    references_.resize(any_viscous ? bundles_.spring_count() : 0);
    elastic_of_springs_.resize(references_.size());
    reference_means_.resize(any_viscous ? patches_.count() : 0);
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
            if (inputs.attachments[at(attachment)].damping * inputs.attachments[at(attachment)].envelope == 0) return;
            // Relative velocity = sum c (factor x + offset) - velocity of the anchor = factor (stretch - reference).
            Vec3 offset = Vec3::Zero();
            for (std::size_t i = 0; i < vertices.size(); ++i)
                offset += s.coefficients[i] * point_of(form.velocity_offset, vertices[i]);
            references_[s.number] = (velocity - offset) / form.velocity_factor - place;
        });
    });
    parallel_for(patches_.count(), grain, [&](std::size_t p) {
        place_means_[p] = mean_of(patches_, bundles_, p, places_);
        if (any_viscous) reference_means_[p] = mean_of(patches_, bundles_, p, references_);
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

void Springs::find_means(const std::vector<double>& x) const {
    parallel_for(patches_.count(), grain, [&](std::size_t p) {
        Vec3 sum = Vec3::Zero();
        for (const SpringPatches::Pull& pull : patches_.pulls(p)) sum += pull.area * point_of(x, pull.vertex);
        means_[p] = sum / patches_.area(p) - place_means_[p];
    });
}

void Springs::expand(const std::vector<double>& x) {
    const std::size_t attachments = most_single_.size();
    find_means(x);
    energy_ = ordered_sum(bundles_.count(), [&](std::size_t b) {
        const SpringPull& single = pulls_[at(bundles_.attachment(b))];
        const SpringPull& mean = pulls_[attachments + at(bundles_.attachment(b))];
        double energy = 0;
        for_each_stretch(b, x, [&](const SpringBundles::Spring& s, const Vec3& d) {
            Vec3 elastic = s.area_weight * single.stiffness * d;
            energy += 0.5 * elastic.dot(d);
            const int patch = patches_.of_spring(s.number);
            if (patch >= 0) elastic += s.area_weight * mean.stiffness * means_[at(patch)];
            of_springs_[s.number] = elastic;
            if (!viscous()) return;
            const Vec3 moved = d - references_[s.number];
            elastic_of_springs_[s.number] = elastic;
            of_springs_[s.number] += s.area_weight * single.viscous * moved;
            energy += 0.5 * s.area_weight * single.viscous * moved.squaredNorm();
            if (patch >= 0)
                of_springs_[s.number] +=
                    s.area_weight * mean.viscous * (means_[at(patch)] - reference_means_[at(patch)]);
        });
        return energy;
    });
    energy_ += ordered_sum(patches_.count(), [&](std::size_t p) {
        const SpringPull& mean = pulls_[attachments + at(patches_.attachment(p))];
        double energy = 0.5 * mean.stiffness * means_[p].squaredNorm();
        if (viscous()) energy += 0.5 * mean.viscous * (means_[p] - reference_means_[p]).squaredNorm();
        return patches_.area(p) * energy;
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
    find_means(x);
    const double of_springs = ordered_sum(bundles_.count(), [&](std::size_t b) {
        const double stiffness = pulls_[at(bundles_.attachment(b))].stiffness;
        double energy = 0;
        for_each_stretch(b, x, [&](const SpringBundles::Spring& s, const Vec3& d) {
            energy += 0.5 * stiffness * s.area_weight * d.squaredNorm();
        });
        return energy;
    });
    return of_springs + ordered_sum(patches_.count(), [&](std::size_t p) {
               return 0.5 * pulls_[most_single_.size() + at(patches_.attachment(p))].stiffness * patches_.area(p) *
                      means_[p].squaredNorm();
           });
}

} // namespace sinew::solver
