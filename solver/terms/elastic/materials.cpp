// Moduli and masses of the tets from the values of a step, and the scales that judge forces and rounding.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/material/compression_resistance.h"
#include "solver/material/principal.h"
#include "solver/terms/elastic/elastic.h"
#include "solver/terms/elastic/layer_mix.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

/// Quadratic tets take this much of lambda at their points, in units of mu, and the rest on the tet's mean: up to
/// nu = 0.4 everything stays pointwise and keeps the element's full order, beyond that nothing locks.
constexpr double pointwise_lambda = 4;

double modulus_of(const TetModuli& m, int lane) {
    return 2 * m.mu[lane] + m.lambda[lane] + m.lambda_mean[lane] + m.volume[lane];
}

} // namespace

void Elastic::set_materials(std::size_t t, const TissueInputs& in) {
    const TissueBatches& batches = system_.tissues[t];
    const TissueRest& rest = *scene_.tissue(batches.body);
    const bool quadratic = batches.kind == ElementKind::quadratic;
    has_means_[t] = 0;
    ConservedVolume* patches = patches_[t].get();
    if (patches) patches->clear();
    for (std::size_t slot = 0; slot < batches.batch_count * lanes; ++slot) {
        const std::size_t tet = std::min(slot, batches.tet_count - 1), i = slot / lanes, lane = slot % lanes;
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
        // What has grown weighs what the model does, and is as stiff per volume.
        tet_mass_[batches.first_batch * lanes + slot] =
            m.mass_density * system_.batches[batches.first_batch + i].volume[lane];
        // What a patch holds now is the same whichever rest shape it is measured from: V det F = V det G det Fe.
        if (patches && slot < batches.tet_count)
            patches->add_stiffness(tet, tets(t, i).volume[lane], volume_share_ * m.volume_conservation);
    }
}

void Elastic::set_scales() {
    double stiffest = 0;
    elastic_scale_ = 0;
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        double floor = 0, stiffness = 0;
        for (std::size_t i = 0; i < batches.batch_count; ++i)
            for (int lane = 0; lane < lanes; ++lane) {
                const TetBatch& b = tets(t, i);
                const TetModuli& m = moduli_[batches.first_batch + i];
                double squares = 0;
                for (const auto& row : b.shape) squares += row[lane] * row[lane];
                const double lambda = m.lambda[lane] + m.lambda_mean[lane];
                const double scale = (2 * m.mu[lane] + std::min(lambda, 2 * m.mu[lane])) * b.volume[lane];
                const double modulus_volume = modulus_of(m, lane) * b.volume[lane];
                if (b.volume[lane] > 0)
                    stiffest = std::max(stiffest, (m.lambda_mean[lane] + m.volume[lane]) / m.mu[lane]);
                floor += scale * scale * squares;
                elastic_scale_ += modulus_volume;
                stiffness += modulus_volume * modulus_volume * squares * squares;
            }
        for (std::size_t p = 0; patches_[t] && p < patches_[t]->count(); ++p) {
            const ConservedVolume::Patch patch = patches_[t]->patch(p);
            elastic_scale_ += patch.stiffness;
            const std::size_t i = patch.tet / lanes, lane = patch.tet % lanes;
            double squares = 0;
            for (const auto& row : tets(t, i).shape) squares += row[lane] * row[lane];
            stiffness += patch.stiffness * patch.stiffness * squares * squares;
            stiffest = std::max(stiffest, patch.stiffness / (patch.volume * moduli_[batches.first_batch + i].mu[lane]));
        }
        force_floor_[t] = 1e-6 * std::sqrt(floor);
        stiffness_scale_[t] = std::sqrt(stiffness);
    }
    volume_levels_ = stiffest > 100 ? static_cast<int>(std::ceil(std::log10(stiffest / 100))) : 0;
}

void Elastic::add_vertex_stiffness(std::span<double> stiffness) const {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        for (std::size_t slot = 0; slot < batches.tet_count; ++slot) {
            const std::size_t i = slot / lanes, lane = slot % lanes;
            const TetModuli& moduli = moduli_[batches.first_batch + i];
            const double share = modulus_of(moduli, static_cast<int>(lane)) * tets(t, i).volume[lane] / batches.nodes();
            for (int n = 0; n < batches.nodes(); ++n)
                stiffness[static_cast<std::size_t>(system_.node(batches, i, n)[lane])] += share;
        }
    }
}

} // namespace sinew::solver
