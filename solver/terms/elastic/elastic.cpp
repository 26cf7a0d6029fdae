// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/elastic/elastic.h"

#include "solver/element/mass_matrix.h"
#include "solver/error.h"
#include "solver/parallel.h"
#include "solver/terms/elastic/layer_mix.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace sinew::solver {

namespace {

constexpr std::size_t batch_grain = 32;

} // namespace

const TermType elastic_type{
    .name = "elastic",
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        return scene.system().tissues.empty() ? nullptr : std::make_unique<Elastic>(scene);
    },
    .memory_version = 1,
    .has_memory = true,
};

Elastic::Elastic(const Scene& scene)
    : scene_(scene)
    , system_(scene.system()) {
    const std::size_t n = system_.tissues.size();
    inputs_.resize(n), shapes_.resize(n), wanted_shapes_.resize(n);
    has_means_.assign(n, 0);
    resting_.assign(n, 0);
    patch_energy_.assign(n, 0.0);
    fibers_.resize(n);
    active_count_.assign(n, 0);
    force_floor_.assign(n, 0.0);
    stiffness_scale_.assign(n, 0.0);
    patches_.resize(n);
    changed_.resize(n);
    for (const TissueBatches& t : system_.tissues) anisotropy_.push_back(t.anisotropy);
    moduli_.resize(system_.batches.size());
    summaries_.resize(system_.batches.size());
    gradients_.resize(system_.gradient_size);
    find_chunks();
    tet_mass_.assign(lanes * system_.batches.size(), 0.0);
}

Changes Elastic::take(const StepInputs& inputs, const State&) {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) { // all of them before anything is taken over
        const int body = system_.tissues[t].body;
        find_rest_shapes(scene_, body, inputs.parts, wanted_shapes_[t]);
        check_values(std::get<TissueInputs>(inputs.bodies[static_cast<std::size_t>(body)]), wanted_shapes_[t], body);
    }
    bool changed = false, new_couplings = false;
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        const auto& in = std::get<TissueInputs>(inputs.bodies[static_cast<std::size_t>(batches.body)]);
        const bool wants_patches = batches.kind == ElementKind::linear && conserves_volume(in);
        if (wants_patches != static_cast<bool>(patches_[t])) {
            new_couplings = true;
            patches_[t].reset();
            if (wants_patches) patches_[t] = std::make_unique<ConservedVolume>(scene_, batches);
        }
        const bool new_rest = take_rest_change(t, in, wanted_shapes_[t]);
        if (new_couplings || new_rest || inputs_[t].layers.empty() || !same_material(inputs_[t], in)) {
            set_materials(t, in);
            changed = true;
        }
        inputs_[t] = in;

        const auto pull = [&](std::size_t k) {
            return in.fibers[k].strength * in.fibers[k].envelope * in.fibers[k].excitation;
        };
        active_count_[t] = 0;
        for (std::size_t k = 0; k < in.fibers.size(); ++k)
            if (pull(k) != 0) ++active_count_[t];
        fibers_[t].clear();
        for (std::size_t i = 0; i < batches.batch_count && active_count_[t]; ++i)
            for (std::size_t k = 0; k < in.fibers.size(); ++k)
                if (pull(k) != 0)
                    fibers_[t].push_back({changed_[t] ? &changed_[t]->fiber(k, i) : &batches.fibers[k][i], pull(k),
                                          in.fibers[k].contraction_limit});
    }
    if (changed) set_scales();
    return {new_couplings, changed};
}

bool Elastic::take_rest_change(std::size_t t, const TissueInputs& in, const RestShapes& shapes) {
    const bool same_shapes = shapes.weights == shapes_[t].weights || (!shapes.act() && !shapes_[t].act());
    if (same_shapes && same_rest_change(inputs_[t], in)) return false;
    shapes_[t] = shapes;
    const TissueBatches& batches = system_.tissues[t];
    if (!changes_rest(in) && !shapes_[t].act())
        changed_[t].reset();
    else if (!changed_[t])
        changed_[t] = std::make_unique<ChangedRest>(system_, batches);
    if (changed_[t]) changed_[t]->set(*scene_.tissue(batches.body), in, shapes_[t]);
    for (std::size_t i = 0; i < anisotropy_[t].size(); ++i)
        std::memcpy(anisotropy_[t][i].direction,
                    (changed_[t] ? changed_[t]->stiff(i) : batches.anisotropy[i]).direction,
                    sizeof anisotropy_[t][i].direction);
    return true;
}

void Elastic::relax(int level) {
    volume_share_ = std::pow(10.0, -level);
    for (std::size_t t = 0; t < system_.tissues.size(); ++t)
        if (has_means_[t] || patches_[t]) set_materials(t, inputs_[t]);
}

PointInputs Elastic::point_inputs(std::size_t t, std::size_t i) const {
    const TissueBatches& batches = system_.tissues[t];
    const std::size_t e = batches.first_batch + i;
    PointInputs in{{batches.law, laws_continued_}, tets(t, i), moduli_[e]};
    if (!anisotropy_[t].empty()) in.anisotropy = &anisotropy_[t][i];
    if (damping_share_ > 0) {
        in.viscosity = damping_share_;
        in.reference_strain = reference_strains_.data() + batches.strain_at(i);
    }
    if (active_count_[t]) in.fibers = std::span(fibers_[t]).subspan(i * active_count_[t], active_count_[t]);
    return in;
}

namespace {

/// The rates that a memory holds, if it is of as many points.
std::span<const double> rates_of(const TermMemory* memory, std::size_t count) {
    if (!memory || memory->bytes.size() != count * sizeof(double)) return {};
    return {reinterpret_cast<const double*>(memory->bytes.data()), count};
}

} // namespace

void Elastic::begin_stage(const Stage& stage) {
    velocity_factor_ = stage.form.velocity_factor;
    damping_share_ = stage.inputs.stiffness_damping * velocity_factor_;
    if (!(damping_share_ > 0)) return;
    std::span<const double> rates;
    if (stage.form.strain.takes_known_rate)
        rates = rates_of(find_memory(stage.before.memories, elastic_type.name), system_.strain_size);
    reference_strains_.resize(system_.strain_size);
    set_strains_of(stage.form.strain, rates, reference_strains_);
}

void Elastic::remember(const Positions& x, bool keeps_history, TermMemory& memory) const {
    if (!keeps_history || !(damping_share_ > 0)) return memory.bytes.clear();
    const std::span<std::byte> bytes = memory.bytes.rewrite(system_.strain_size * sizeof(double));
    const std::span<double> out(reinterpret_cast<double*>(bytes.data()), system_.strain_size);
    set_strains_of({.x = &x}, {}, out);
    parallel_for(out.size(), 8192,
                 [&](std::size_t i) { out[i] = velocity_factor_ * (out[i] - reference_strains_[i]); });
    // Kept as rates of the model's strain: the rest shape may be another one at the next step.
    for (std::size_t t = 0; t < system_.tissues.size(); ++t)
        for (std::size_t i = 0; changed_[t] && i < system_.tissues[t].batch_count; ++i)
            changed_[t]->to_model(i, out.data() + system_.tissues[t].strain_at(i));
}

double Elastic::stored_energy(const Positions& x) {
    const double share = std::exchange(damping_share_, 0);
    const double energy = this->energy(x, true);
    damping_share_ = share;
    return energy;
}

void Elastic::set_strains_of(const StrainReference& reference, std::span<const double> known_rates,
                             std::span<double> strains) const {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        parallel_for(batches.batch_count, batch_grain, [&](std::size_t i) {
            const TetBatch& batch = tets(t, i);
            double* out = strains.data() + batches.strain_at(i);
            StrainReference here = reference;
            if (!known_rates.empty()) here.v = nullptr;
            const auto corners = [&](const std::vector<double>* x) {
                return x ? corners_of(batch, x->data()) : Corners{};
            };
            if (batches.kind == ElementKind::quadratic)
                quadratic_reference_strain(batch, edges(t, i), here, out);
            else
                reference_strain(batch, here, corners(here.x), corners(here.x_between), corners(here.v), out);
            if (known_rates.empty()) return;
            const int count = batches.points() * strain_size;
            double rate[quadratic_points * strain_size];
            std::copy_n(known_rates.data() + batches.strain_at(i), count, rate);
            if (changed_[t]) changed_[t]->to_changed(i, rate);
            for (int k = 0; k < count; ++k) out[k] += here.rate * rate[k];
        });
    }
}

double Elastic::energy(const Positions& x, bool) {
    double energy = 0;
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        if (patches_[t] && !resting_[t]) patch_energy_[t] = patches_[t]->set_pressures(x);
        if (patches_[t]) energy += patch_energy_[t];
        if (resting_[t]) continue;
        parallel_for(batches.batch_count, batch_grain, [&](std::size_t i) {
            PointInputs in = point_inputs(t, i);
            const std::size_t e = batches.first_batch + i;
            double* g = gradients_.data() + batches.gradient_at(i);
            if (batches.kind == ElementKind::quadratic)
                return quadratic_gradient(in, edges(t, i), has_means_[t], x.data(), g, summaries_[e]);
            Pressures pressures{Pack(0.0), Pack(0.0)};
            if (patches_[t]) {
                pressures.j = Pack::load(patches_[t]->pressures(i));
                in.pressures = &pressures;
            }
            point_gradient(in, corners_of(in.batch, x.data()), g, summaries_[e]);
        });
    }
    return energy + ordered_sum(summaries_.size(), [&](std::size_t e) {
               const double* w = summaries_[e].energy;
               return (w[0] + w[1]) + (w[2] + w[3]);
           });
}

void Elastic::rest(std::span<const char> deformables) {
    for (std::size_t t = 0; t < resting_.size(); ++t)
        resting_[t] = !deformables.empty() && deformables[system_.tissues[t].deformable];
}

void Elastic::add_gradient(std::span<double> gradient) const {
    parallel_for(gradient.size() / 3, 512, [&](std::size_t u) {
        double sum[3] = {};
        for (int k = system_.node_start[u]; k < system_.node_start[u + 1]; ++k) {
            const double* e = gradients_.data() + system_.nodes[static_cast<std::size_t>(k)];
            for (int c = 0; c < 3; ++c) sum[c] += e[c * lanes];
        }
        for (std::size_t c = 0; c < 3; ++c) gradient[3 * u + c] += sum[c];
    });
}

void Elastic::add_held_gradient(std::span<double> gradient) const {
    for (const TissueBatches& t : system_.tissues)
        for (std::size_t slot = 0; slot < t.tet_count; ++slot)
            for (int n = 0; n < t.nodes(); ++n) {
                const std::size_t v = static_cast<std::size_t>(system_.node(t, slot / lanes, n)[slot % lanes]);
                if (system_.numbering.unknown[v] >= 0) continue;
                const double* e = gradients_.data() + t.gradient_at(slot / lanes) +
                                  static_cast<std::size_t>(3 * n) * lanes + slot % lanes;
                for (std::size_t c = 0; c < 3; ++c) gradient[3 * v + c] += e[c * lanes];
            }
}

void Elastic::add_masses(MassMatrix& masses) const { masses.add_tets(system_, tet_mass_); }

double Elastic::force_norm(std::size_t t) const {
    // In the order of batches, so that the sum does not depend on how entries are stored.
    const TissueBatches& batches = system_.tissues[t];
    return std::sqrt(ordered_sum(batches.batch_count, [&](std::size_t i) {
        const double* g = gradients_.data() + batches.gradient_at(i);
        double sum = 0;
        for (int k = 0; k < batches.nodes() * 3 * lanes; ++k) sum += g[k] * g[k];
        return sum;
    }));
}

double Elastic::fiber_norm(std::size_t t) const {
    if (active_count_[t] == 0) return 0;
    return std::sqrt(ordered_sum(system_.tissues[t].batch_count, [&](std::size_t i) {
        const double* q = summaries_[system_.tissues[t].first_batch + i].fiber_squares;
        return (q[0] + q[1]) + (q[2] + q[3]);
    }));
}

void Elastic::add_quality(const Positions* x, ShapeQuality& quality) const {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        for (std::size_t i = 0; i < batches.batch_count; ++i) {
            const std::size_t e = batches.first_batch + i;
            double of_tets[lanes];
            if (x && batches.kind == ElementKind::quadratic)
                quadratic_least_j(tets(t, i), edges(t, i), x->data(), of_tets);
            else
                std::copy_n(summaries_[e].j, lanes, of_tets);
            for (int lane = 0; lane < lanes; ++lane) {
                if (!(system_.batches[e].volume[lane] > 0)) continue;
                const double j = of_tets[lane];
                if (!(j >= quality.least_j)) quality.least_j = j; // a number that is none stays
                if (!(j > 0)) ++quality.inverted;
            }
        }
    }
}

void Elastic::raise_forces_at_work(const Positions&, std::span<double> largest) const {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        double& most = largest[system_.tissues[t].deformable];
        most = std::max({most, force_norm(t), fiber_norm(t), force_floor_[t]});
    }
}

void Elastic::add_squared_stiffnesses(std::span<double> squares) const {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const double stiffness = (1 + damping_share_) * stiffness_scale_[t];
        squares[system_.tissues[t].deformable] += stiffness * stiffness;
    }
}

} // namespace sinew::solver
