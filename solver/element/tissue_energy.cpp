// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/tissue_energy.h"

#include "solver/error.h"
#include "solver/material/principal.h"
#include "solver/material/compression_resistance.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string>

namespace sinew::solver {

namespace {

constexpr std::size_t batch_grain = 32;

/// Quadratic tets take this much of lambda at their points, in units of mu, and the rest on the tet's mean: up to
/// nu = 0.4 everything stays pointwise and keeps the element's full order, beyond that nothing locks.
constexpr double pointwise_lambda = 4;

bool same(const MaterialValues& a, const MaterialValues& b) {
    return a.youngs_modulus == b.youngs_modulus && a.poissons_ratio == b.poissons_ratio &&
           a.mass_density == b.mass_density && a.envelope == b.envelope &&
           a.volume_conservation == b.volume_conservation;
}

bool same_material(const TissueInputs& a, const TissueInputs& b) {
    return a.compression_resistance == b.compression_resistance && a.transverse_anisotropy == b.transverse_anisotropy &&
           std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(), same);
}

/// Layers composited bottom to top: M_N = a m_N + (1 - a) M_{N-1}, a = envelope x weight; the first layer is opaque.
MaterialValues mix_layers(const TissueRest& rest, const TissueInputs& in, std::size_t tet) {
    MaterialValues m = in.layers.front();
    for (std::size_t k = 1; k < in.layers.size(); ++k) {
        const MaterialValues& layer = in.layers[k];
        const double a = std::clamp(layer.envelope * rest.layer_weights[k][tet], 0.0, 1.0);
        m.youngs_modulus = a * layer.youngs_modulus + (1 - a) * m.youngs_modulus;
        m.poissons_ratio = a * layer.poissons_ratio + (1 - a) * m.poissons_ratio;
        m.mass_density = a * layer.mass_density + (1 - a) * m.mass_density;
        m.volume_conservation = a * layer.volume_conservation + (1 - a) * m.volume_conservation;
    }
    return m;
}

/// Throws Error FE304 that names the body where a value is not a finite number: further on it would only be an energy
/// that is none, of the whole scene.
void check_values(const TissueInputs& in, int body) {
    const auto refuse = [&](const char* what) {
        Error e("FE304", std::string(what) + " is not a finite number",
                "check the attribute and what it is connected to");
        e.body = body;
        throw e;
    };
    const auto finite = [](std::initializer_list<double> values) {
        return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    };
    if (!finite({in.compression_resistance, in.transverse_anisotropy}))
        refuse("the compression resistance or anisotropy of a tissue");
    for (const MaterialValues& m : in.layers)
        if (!finite({m.youngs_modulus, m.poissons_ratio, m.mass_density, m.envelope, m.volume_conservation}))
            refuse("a value of a tissue's material");
    for (const FiberValues& f : in.fibers)
        if (!finite({f.strength, f.contraction_limit, f.excitation, f.envelope})) refuse("a value of a tissue's fibre");
    if (!std::all_of(in.forces.begin(), in.forces.end(), [](const Vec3& f) { return f.allFinite(); }))
        refuse("a load on a tissue");
}

} // namespace

/// Volume patches of one tissue of linear tets, with what the last pass found.
struct TissueEnergy::Patches {
    VolumePatches of;
    std::vector<double> stiffness, volume, mean_j; ///< per patch: sum of k x volume [J], volume [m^3]
    std::vector<double> pressure;                  ///< per slot of the tissue's batches [Pa]
    /// sqrt(stiffness) x d mean_j / d vertex, 3 a member; its products make up the Hessian.
    std::vector<double> slope;
    std::vector<int> block_start, pairs; ///< per block of the pattern: pairs of members (row's, column's)
};

TissueEnergy::TissueEnergy(const Scene& scene)
    : scene_(scene)
    , system_(scene.system()) {
    const std::size_t n = system_.tissues.size();
    inputs_.resize(n);
    has_means_.assign(n, 0);
    fibers_.resize(n);
    active_count_.assign(n, 0);
    force_floor_.assign(n, 0.0);
    stiffness_scale_.assign(n, 0.0);
    patches_.resize(n);
    for (const TissueBatches& t : system_.tissues) anisotropy_.push_back(t.anisotropy);
    moduli_.resize(system_.batches.size());
    summaries_.resize(system_.batches.size());
    gradients_.resize(system_.gradient_size);
    hessians_.resize(system_.hessian_size);
    tet_mass_.assign(lanes * system_.batches.size(), 0.0);
}

TissueEnergy::~TissueEnergy() = default;

bool TissueEnergy::set_values(const StepInputs& inputs) {
    for (const TissueBatches& t : system_.tissues) // all of them before anything is taken over
        check_values(std::get<TissueInputs>(inputs.bodies[static_cast<std::size_t>(t.body)]), t.body);
    bool changed = false, new_couplings = false;
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        const auto& in = std::get<TissueInputs>(inputs.bodies[static_cast<std::size_t>(batches.body)]);
        const bool wants_patches = batches.kind == ElementKind::linear && conserves_volume(in);
        if (wants_patches != static_cast<bool>(patches_[t])) {
            new_couplings = true;
            patches_[t].reset();
            if (wants_patches) {
                patches_[t] = std::make_unique<Patches>();
                patches_[t]->of = make_volume_patches(scene_.tissue(batches.body)->tets);
            }
        }
        if (new_couplings || inputs_[t].layers.empty() || !same_material(inputs_[t], in)) {
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
                    fibers_[t].push_back({&batches.fibers[k][i], pull(k), in.fibers[k].contraction_limit});
    }
    if (changed) {
        set_scales();
        if (pattern_ && !new_couplings) mass_.set(system_, *pattern_, tet_mass_);
    }
    return new_couplings;
}

void TissueEnergy::relax_volume(int level) {
    volume_share_ = std::pow(10.0, -level);
    for (std::size_t t = 0; t < system_.tissues.size(); ++t)
        if (has_means_[t] || patches_[t]) set_materials(t, inputs_[t]);
}

void TissueEnergy::set_materials(std::size_t t, const TissueInputs& in) {
    const TissueBatches& batches = system_.tissues[t];
    const TissueRest& rest = *scene_.tissue(batches.body);
    const bool quadratic = batches.kind == ElementKind::quadratic;
    has_means_[t] = 0;
    Patches* patches = patches_[t].get();
    if (patches) {
        patches->stiffness.assign(patches->of.count(), 0.0);
        patches->volume.assign(patches->of.count(), 0.0);
        patches->mean_j.assign(patches->of.count(), 1.0);
        patches->pressure.assign(batches.batch_count * lanes, 0.0);
        patches->slope.assign(3 * patches->of.vertex.size(), 0.0);
    }
    for (std::size_t slot = 0; slot < batches.batch_count * lanes; ++slot) {
        const std::size_t tet = std::min(slot, batches.tet_count - 1), i = slot / lanes, lane = slot % lanes;
        const TetBatch& batch = system_.batches[batches.first_batch + i];
        TetModuli& moduli = moduli_[batches.first_batch + i];
        const MaterialValues m = mix_layers(rest, in, tet);
        const Lame l = lame(m.youngs_modulus, m.poissons_ratio);
        // The last bit decides nothing: at nu = 0.4 itself, the default, there is no second part.
        const bool splits = quadratic && !needs_direction(rest.law) && l.lambda > (1 + 1e-9) * pointwise_lambda * l.mu;
        moduli.mu[lane] = l.mu;
        moduli.lambda[lane] = splits ? pointwise_lambda * l.mu : l.lambda;
        moduli.lambda_mean[lane] = volume_share_ * (l.lambda - moduli.lambda[lane]);
        moduli.volume[lane] = quadratic ? volume_share_ * m.volume_conservation : 0;
        moduli.compression[lane] =
            compression_coefficient(in.compression_resistance, m.youngs_modulus, m.poissons_ratio);
        if (moduli.lambda_mean[lane] > 0 || moduli.volume[lane] > 0) has_means_[t] = 1;
        if (!anisotropy_[t].empty())
            anisotropy_[t][i].root[lane] =
                batches.anisotropy[i].root[lane] == 0 ? 1 : std::pow(in.transverse_anisotropy, 0.25);
        tet_mass_[batches.first_batch * lanes + slot] = m.mass_density * batch.volume[lane];
        if (patches && slot < batches.tet_count) {
            const std::size_t p = static_cast<std::size_t>(patches->of.patch_of_tet[tet]);
            patches->volume[p] += batch.volume[lane];
            patches->stiffness[p] += volume_share_ * m.volume_conservation * batch.volume[lane];
        }
    }
}

void TissueEnergy::set_scales() {
    double stiffest = 0;
    elastic_scale_ = 0;
    vertex_stiffness_.assign(static_cast<std::size_t>(scene_.vertex_count()), 0.0);
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        double floor = 0, stiffness = 0;
        for (std::size_t e = batches.first_batch; e < batches.first_batch + batches.batch_count; ++e)
            for (int lane = 0; lane < lanes; ++lane) {
                const TetBatch& b = system_.batches[e];
                const TetModuli& m = moduli_[e];
                double squares = 0;
                for (const auto& row : b.shape) squares += row[lane] * row[lane];
                const double lambda = m.lambda[lane] + m.lambda_mean[lane];
                const double scale = (2 * m.mu[lane] + std::min(lambda, 2 * m.mu[lane])) * b.volume[lane];
                const double modulus_volume = (2 * m.mu[lane] + lambda + m.volume[lane]) * b.volume[lane];
                if (b.volume[lane] > 0)
                    stiffest = std::max(stiffest, (m.lambda_mean[lane] + m.volume[lane]) / m.mu[lane]);
                floor += scale * scale * squares;
                elastic_scale_ += modulus_volume;
                for (int n = 0; n < batches.nodes(); ++n)
                    vertex_stiffness_[static_cast<std::size_t>(
                        system_.node(batches, e - batches.first_batch, n)[lane])] += modulus_volume / batches.nodes();
                stiffness += modulus_volume * modulus_volume * squares * squares;
            }
        if (patches_[t]) {
            const Patches& patches = *patches_[t];
            for (std::size_t p = 0; p < patches.stiffness.size(); ++p) {
                elastic_scale_ += patches.stiffness[p];
                const std::size_t tet =
                    static_cast<std::size_t>(patches.of.tets[static_cast<std::size_t>(patches.of.tet_start[p])]);
                const std::size_t e = batches.first_batch + tet / lanes;
                const double mu = moduli_[e].mu[tet % lanes];
                double squares = 0;
                for (const auto& row : system_.batches[e].shape) squares += row[tet % lanes] * row[tet % lanes];
                stiffness += patches.stiffness[p] * patches.stiffness[p] * squares * squares;
                stiffest = std::max(stiffest, patches.stiffness[p] / (patches.volume[p] * mu));
            }
        }
        force_floor_[t] = 1e-6 * std::sqrt(floor);
        stiffness_scale_[t] = std::sqrt(stiffness);
    }
    volume_levels_ = stiffest > 100 ? static_cast<int>(std::ceil(std::log10(stiffest / 100))) : 0;
}

void TissueEnergy::add_couplings(std::vector<std::pair<int, int>>& couplings) const {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        for (std::size_t slot = 0; slot < batches.tet_count; ++slot)
            for (int a = 0; a < batches.nodes(); ++a)
                for (int b = a; b < batches.nodes(); ++b)
                    couplings.emplace_back(system_.node(batches, slot / lanes, a)[slot % lanes],
                                           system_.node(batches, slot / lanes, b)[slot % lanes]);
        if (!patches_[t]) continue;
        const VolumePatches& of = patches_[t]->of;
        const int first = scene_.first_vertex(batches.body);
        for (std::size_t p = 0; p < of.count(); ++p)
            for (int i = of.member_start[p]; i < of.member_start[p + 1]; ++i)
                for (int j = i; j < of.member_start[p + 1]; ++j)
                    couplings.emplace_back(first + of.vertex[static_cast<std::size_t>(i)],
                                           first + of.vertex[static_cast<std::size_t>(j)]);
    }
}

namespace {

/// Counting sort: for_each_entry(visit) calls visit(bucket, value) in the order that the buckets keep.
template <class ForEach>
void sort_into(std::size_t buckets, std::vector<int>& start, std::vector<int>& values, const ForEach& for_each_entry) {
    start.assign(buckets + 1, 0);
    for_each_entry([&](std::size_t bucket, int) { ++start[bucket + 1]; });
    for (std::size_t i = 0; i < buckets; ++i) start[i + 1] += start[i];
    values.resize(static_cast<std::size_t>(start.back()));
    std::vector<int> next(start.begin(), start.end() - 1);
    for_each_entry([&](std::size_t bucket, int value) { values[static_cast<std::size_t>(next[bucket]++)] = value; });
}

} // namespace

void TissueEnergy::set_pattern(const BlockPattern& pattern) {
    pattern_ = &pattern;
    mass_.set(system_, pattern, tet_mass_);
    const auto row = [&](int vertex) { return system_.unknown[static_cast<std::size_t>(vertex)]; };
    // An element entry is named by twice the place of its first number, plus one if it has to be transposed.
    sort_into(pattern.block_count(), contribution_start_, contributions_, [&](const auto& visit) {
        for (const TissueBatches& batches : system_.tissues)
            for (std::size_t slot = 0; slot < batches.tet_count; ++slot) {
                const std::size_t lane = slot % lanes;
                std::size_t at = batches.hessian_at(slot / lanes) + lane;
                for (int a = 0; a < batches.nodes(); ++a)
                    for (int b = a; b < batches.nodes(); ++b, at += 9 * lanes) {
                        const int i = row(system_.node(batches, slot / lanes, a)[lane]),
                                  j = row(system_.node(batches, slot / lanes, b)[lane]);
                        if (i < 0 || j < 0) continue;
                        visit(static_cast<std::size_t>(pattern.find(std::min(i, j), std::max(i, j))),
                              static_cast<int>(2 * at) + (i > j ? 1 : 0));
                    }
            }
    });
    for (std::size_t t = 0; t < patches_.size(); ++t) {
        if (!patches_[t]) continue;
        Patches& patches = *patches_[t];
        const VolumePatches& of = patches.of;
        const int first = scene_.first_vertex(system_.tissues[t].body);
        sort_into(pattern.block_count(), patches.block_start, patches.pairs, [&](const auto& visit) {
            for (std::size_t p = 0; p < of.count(); ++p)
                for (int a = of.member_start[p]; a < of.member_start[p + 1]; ++a)
                    for (int b = of.member_start[p]; b < of.member_start[p + 1]; ++b) {
                        const int i = row(first + of.vertex[static_cast<std::size_t>(a)]),
                                  j = row(first + of.vertex[static_cast<std::size_t>(b)]);
                        if (i < 0 || j < i) continue;
                        const std::size_t block = static_cast<std::size_t>(pattern.find(i, j));
                        visit(block, a), visit(block, b);
                    }
        });
    }
}

PointInputs TissueEnergy::point_inputs(std::size_t t, std::size_t i) const {
    const TissueBatches& batches = system_.tissues[t];
    const std::size_t e = batches.first_batch + i;
    PointInputs in{batches.law, system_.batches[e], moduli_[e]};
    if (!anisotropy_[t].empty()) in.anisotropy = &anisotropy_[t][i];
    if (damping_share_ > 0) {
        in.viscosity = damping_share_;
        in.reference_strain = reference_strains_.data() + batches.strain_at(i);
    }
    if (active_count_[t]) in.fibers = std::span(fibers_[t]).subspan(i * active_count_[t], active_count_[t]);
    return in;
}

void TissueEnergy::set_damping(double share, const StrainReference& reference) {
    damping_share_ = share;
    if (share > 0) set_strains_of(reference, reference_strains_);
}

void TissueEnergy::strain_rates(const std::vector<double>& x, double velocity_factor, std::vector<double>& out) const {
    set_strains_of({.x = &x}, out);
    parallel_for(out.size(), 8192, [&](std::size_t i) { out[i] = velocity_factor * (out[i] - reference_strains_[i]); });
}

void TissueEnergy::set_strains_of(const StrainReference& reference, std::vector<double>& strains) const {
    strains.resize(system_.strain_size);
    if (reference.known_rate && reference.known_rate->size() != system_.strain_size)
        throw std::logic_error("rates of strain of another scene");
    for (const TissueBatches& batches : system_.tissues)
        parallel_for(batches.batch_count, batch_grain, [&](std::size_t i) {
            const TetBatch& batch = system_.batches[batches.first_batch + i];
            double* out = strains.data() + batches.strain_at(i);
            const auto corners = [&](const std::vector<double>* x) {
                return x ? corners_of(batch, x->data()) : Corners{};
            };
            if (batches.kind == ElementKind::quadratic)
                quadratic_reference_strain(batch, system_.edge_batches[batches.first_edge_batch + i], reference, out);
            else
                reference_strain(batch, reference, corners(reference.x), corners(reference.x_between),
                                 corners(reference.v), out);
            if (!reference.known_rate) return;
            const double* rate = reference.known_rate->data() + batches.strain_at(i);
            for (int k = 0; k < batches.points() * strain_size; ++k) out[k] += reference.rate * rate[k];
        });
}

double TissueEnergy::set_patch_pressures(std::size_t t, const std::vector<double>& x) {
    Patches& patches = *patches_[t];
    const VolumePatches& of = patches.of;
    const TissueBatches& batches = system_.tissues[t];
    std::vector<double>& j = patches.pressure; // first det F, then the patch's pressure
    parallel_for(batches.batch_count, batch_grain, [&](std::size_t i) {
        const TetBatch& batch = system_.batches[batches.first_batch + i];
        PointMeasures m;
        point_measures(batches.law, batch, corners_of(batch, x.data()), false, m);
        m.j.store(j.data() + i * lanes);
    });
    parallel_for(of.count(), 256, [&](std::size_t p) {
        double sum = 0;
        for (int k = of.tet_start[p]; k < of.tet_start[p + 1]; ++k) {
            const std::size_t tet = static_cast<std::size_t>(of.tets[static_cast<std::size_t>(k)]);
            sum += system_.batches[batches.first_batch + tet / lanes].volume[tet % lanes] * j[tet];
        }
        patches.mean_j[p] = sum / patches.volume[p];
        for (int k = of.tet_start[p]; k < of.tet_start[p + 1]; ++k)
            j[static_cast<std::size_t>(of.tets[static_cast<std::size_t>(k)])] =
                patches.stiffness[p] / patches.volume[p] * (patches.mean_j[p] - 1);
    });
    for (std::size_t slot = batches.tet_count; slot < j.size(); ++slot) j[slot] = 0;
    return ordered_sum(of.count(), [&](std::size_t p) {
        const double d = patches.mean_j[p] - 1;
        return 0.5 * patches.stiffness[p] * d * d;
    });
}

double TissueEnergy::evaluate(const std::vector<double>& x) {
    double energy = 0;
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        if (patches_[t]) energy += set_patch_pressures(t, x);
        parallel_for(batches.batch_count, batch_grain, [&](std::size_t i) {
            PointInputs in = point_inputs(t, i);
            const std::size_t e = batches.first_batch + i;
            double* g = gradients_.data() + batches.gradient_at(i);
            if (batches.kind == ElementKind::quadratic)
                return quadratic_gradient(in, system_.edge_batches[batches.first_edge_batch + i], has_means_[t],
                                          x.data(), g, summaries_[e]);
            Pressures pressures{Pack(0.0), Pack(0.0)};
            if (patches_[t]) {
                pressures.j = Pack::load(patches_[t]->pressure.data() + i * lanes);
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

void TissueEnergy::set_patch_gradients(std::size_t t, const std::vector<double>& x) {
    Patches& patches = *patches_[t];
    const VolumePatches& of = patches.of;
    const TissueBatches& batches = system_.tissues[t];
    // volume x d det F / d corner, where the element gradients go otherwise
    parallel_for(batches.batch_count, batch_grain, [&](std::size_t i) {
        const TetBatch& batch = system_.batches[batches.first_batch + i];
        PointMeasures m;
        point_measures(batches.law, batch, corners_of(batch, x.data()), false, m);
        double* g = gradients_.data() + batches.gradient_at(i);
        for (int a = 0; a < 4; ++a)
            for (int c = 0; c < 3; ++c) (Pack::load(batch.volume) * m.d_j[a][c]).store(g + (3 * a + c) * lanes);
    });
    parallel_for(of.count(), 256, [&](std::size_t p) {
        const double scale = std::sqrt(patches.stiffness[p]) / patches.volume[p];
        for (int member = of.member_start[p]; member < of.member_start[p + 1]; ++member) {
            double sum[3] = {};
            for (int k = of.corner_start[static_cast<std::size_t>(member)];
                 k < of.corner_start[static_cast<std::size_t>(member) + 1]; ++k) {
                const std::size_t tet = static_cast<std::size_t>(of.corners[static_cast<std::size_t>(k)]) / 4;
                const int corner = of.corners[static_cast<std::size_t>(k)] % 4;
                const double* g = gradients_.data() + batches.gradient_at(tet / lanes) + tet % lanes;
                for (int c = 0; c < 3; ++c) sum[c] += g[(3 * corner + c) * lanes];
            }
            for (std::size_t c = 0; c < 3; ++c)
                patches.slope[3 * static_cast<std::size_t>(member) + c] = scale * sum[c];
        }
    });
}

void TissueEnergy::assemble(const std::vector<double>& x, bool project, BlockMatrix& a) {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        if (patches_[t]) {
            set_patch_pressures(t, x);
            set_patch_gradients(t, x);
        }
        parallel_for(batches.batch_count, batch_grain, [&](std::size_t i) {
            PointInputs in = point_inputs(t, i);
            double* h = hessians_.data() + batches.hessian_at(i);
            if (batches.kind == ElementKind::quadratic)
                return quadratic_hessian(in, system_.edge_batches[batches.first_edge_batch + i], has_means_[t],
                                         x.data(), project, h);
            Pressures pressures{Pack(0.0), Pack(0.0)};
            if (patches_[t]) {
                pressures.j = Pack::load(patches_[t]->pressure.data() + i * lanes);
                in.pressures = &pressures;
            }
            point_hessian(in, corners_of(in.batch, x.data()), project, h);
        });
    }
    parallel_for(pattern_->block_count(), 512, [&](std::size_t index) {
        double sum[9] = {};
        for (int c = contribution_start_[index]; c < contribution_start_[index + 1]; ++c) {
            const int code = contributions_[static_cast<std::size_t>(c)];
            const double* h = hessians_.data() + code / 2;
            if (code % 2)
                for (int r = 0; r < 3; ++r)
                    for (int k = 0; k < 3; ++k) sum[3 * r + k] += h[(3 * k + r) * lanes];
            else
                for (int k = 0; k < 9; ++k) sum[k] += h[k * lanes];
        }
        std::copy_n(sum, 9, a.block(index));
    });
    gather_patches(a);
}

void TissueEnergy::gather_patches(BlockMatrix& a) const {
    for (const auto& patches : patches_) {
        if (!patches) continue;
        parallel_for(pattern_->block_count(), 512, [&](std::size_t index) {
            double* block = a.block(index);
            for (int k = patches->block_start[index]; k < patches->block_start[index + 1]; k += 2) {
                const double* row = patches->slope.data() + 3 * patches->pairs[static_cast<std::size_t>(k)];
                const double* column = patches->slope.data() + 3 * patches->pairs[static_cast<std::size_t>(k) + 1];
                for (int r = 0; r < 3; ++r)
                    for (int c = 0; c < 3; ++c) block[3 * r + c] += row[r] * column[c];
            }
        });
    }
}

double TissueEnergy::force_norm(std::size_t t) const {
    // In the order of batches, so that the sum does not depend on how entries are stored.
    const TissueBatches& batches = system_.tissues[t];
    return std::sqrt(ordered_sum(batches.batch_count, [&](std::size_t i) {
        const double* g = gradients_.data() + batches.gradient_at(i);
        double sum = 0;
        for (int k = 0; k < batches.nodes() * 3 * lanes; ++k) sum += g[k] * g[k];
        return sum;
    }));
}

double TissueEnergy::fiber_norm(std::size_t t) const {
    if (active_count_[t] == 0) return 0;
    return std::sqrt(ordered_sum(system_.tissues[t].batch_count, [&](std::size_t i) {
        const double* q = summaries_[system_.tissues[t].first_batch + i].fiber_squares;
        return (q[0] + q[1]) + (q[2] + q[3]);
    }));
}

void TissueEnergy::count_inverted(const std::vector<double>* x, double& least_j, int& inverted) const {
    least_j = 1;
    inverted = 0;
    bool first = true;
    for (const TissueBatches& batches : system_.tissues)
        for (std::size_t i = 0; i < batches.batch_count; ++i) {
            const std::size_t e = batches.first_batch + i;
            double at_corners[lanes];
            const bool corners = x && batches.kind == ElementKind::quadratic;
            if (corners)
                quadratic_corner_j(system_.batches[e], system_.edge_batches[batches.first_edge_batch + i], x->data(),
                                   at_corners);
            for (int lane = 0; lane < lanes; ++lane) {
                if (!(system_.batches[e].volume[lane] > 0)) continue;
                const double j = corners ? std::min(summaries_[e].j[lane], at_corners[lane]) : summaries_[e].j[lane];
                least_j = first ? j : std::min(least_j, j);
                first = false;
                if (!(j > 0)) ++inverted;
            }
        }
}

} // namespace sinew::solver
