// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/elastic/conserved_volume.h"

#include "solver/element/elastic_point.h"
#include "solver/parallel.h"
#include "solver/sort_into.h"

#include <cmath>

namespace sinew::solver {

namespace {

constexpr std::size_t batch_grain = 32;

} // namespace

ConservedVolume::ConservedVolume(const Scene& scene, const TissueBatches& batches)
    : system_(scene.system())
    , batches_(batches)
    , first_vertex_(scene.first_vertex(batches.body))
    , of_(make_volume_patches(scene.tissue(batches.body)->tets)) {}

void ConservedVolume::clear() {
    stiffness_.assign(of_.count(), 0.0);
    volume_.assign(of_.count(), 0.0);
    mean_j_.assign(of_.count(), 1.0);
    pressure_.assign(batches_.batch_count * lanes, 0.0);
    slope_.assign(3 * of_.vertex.size(), 0.0);
}

void ConservedVolume::add_stiffness(std::size_t tet, double volume, double modulus) {
    const std::size_t p = static_cast<std::size_t>(of_.patch_of_tet[tet]);
    volume_[p] += volume;
    stiffness_[p] += modulus * volume;
}

void ConservedVolume::add_couplings(Couplings& couplings) const {
    for (std::size_t p = 0; p < of_.count(); ++p)
        for (int i = of_.member_start[p]; i < of_.member_start[p + 1]; ++i)
            for (int j = i; j < of_.member_start[p + 1]; ++j)
                couplings.emplace_back(first_vertex_ + of_.vertex[static_cast<std::size_t>(i)],
                                       first_vertex_ + of_.vertex[static_cast<std::size_t>(j)]);
}

void ConservedVolume::bind(const BlockPattern& pattern) {
    const auto row = [&](int member) {
        return system_.numbering
            .unknown[static_cast<std::size_t>(first_vertex_ + of_.vertex[static_cast<std::size_t>(member)])];
    };
    sort_into(pattern.block_count(), block_start_, pairs_, [&](const auto& visit) {
        for (std::size_t p = 0; p < of_.count(); ++p)
            for (int a = of_.member_start[p]; a < of_.member_start[p + 1]; ++a)
                for (int b = of_.member_start[p]; b < of_.member_start[p + 1]; ++b) {
                    const int i = row(a), j = row(b);
                    if (i < 0 || j < i) continue;
                    const std::size_t block = static_cast<std::size_t>(pattern.find(i, j));
                    visit(block, a), visit(block, b);
                }
    });
}

double ConservedVolume::set_pressures(const Positions& x) {
    std::vector<double>& j = pressure_; // first det F, then the patch's pressure
    parallel_for(batches_.batch_count, batch_grain, [&](std::size_t i) {
        const TetBatch& batch = system_.batches[batches_.first_batch + i];
        PointMeasures m;
        point_measures(batches_.law, batch, corners_of(batch, x.data()), false, m);
        m.j.store(j.data() + i * lanes);
    });
    parallel_for(of_.count(), 256, [&](std::size_t p) {
        double sum = 0;
        for (int k = of_.tet_start[p]; k < of_.tet_start[p + 1]; ++k) {
            const std::size_t tet = static_cast<std::size_t>(of_.tets[static_cast<std::size_t>(k)]);
            sum += system_.batches[batches_.first_batch + tet / lanes].volume[tet % lanes] * j[tet];
        }
        mean_j_[p] = sum / volume_[p];
        for (int k = of_.tet_start[p]; k < of_.tet_start[p + 1]; ++k)
            j[static_cast<std::size_t>(of_.tets[static_cast<std::size_t>(k)])] =
                stiffness_[p] / volume_[p] * (mean_j_[p] - 1);
    });
    for (std::size_t slot = batches_.tet_count; slot < j.size(); ++slot) j[slot] = 0;
    return ordered_sum(of_.count(), [&](std::size_t p) {
        const double d = mean_j_[p] - 1;
        return 0.5 * stiffness_[p] * d * d;
    });
}

void ConservedVolume::set_slopes(const Positions& x, std::vector<double>& scratch) {
    // volume x d det F / d corner, where the element gradients go otherwise
    parallel_for(batches_.batch_count, batch_grain, [&](std::size_t i) {
        const TetBatch& batch = system_.batches[batches_.first_batch + i];
        PointMeasures m;
        point_measures(batches_.law, batch, corners_of(batch, x.data()), false, m);
        double* g = scratch.data() + batches_.gradient_at(i);
        for (int a = 0; a < 4; ++a)
            for (int c = 0; c < 3; ++c) (Pack::load(batch.volume) * m.d_j[a][c]).store(g + (3 * a + c) * lanes);
    });
    parallel_for(of_.count(), 256, [&](std::size_t p) {
        const double scale = std::sqrt(stiffness_[p]) / volume_[p];
        for (int member = of_.member_start[p]; member < of_.member_start[p + 1]; ++member) {
            double sum[3] = {};
            for (int k = of_.corner_start[static_cast<std::size_t>(member)];
                 k < of_.corner_start[static_cast<std::size_t>(member) + 1]; ++k) {
                const std::size_t tet = static_cast<std::size_t>(of_.corners[static_cast<std::size_t>(k)]) / 4;
                const int corner = of_.corners[static_cast<std::size_t>(k)] % 4;
                const double* g = scratch.data() + batches_.gradient_at(tet / lanes) + tet % lanes;
                for (int c = 0; c < 3; ++c) sum[c] += g[(3 * corner + c) * lanes];
            }
            for (std::size_t c = 0; c < 3; ++c) slope_[3 * static_cast<std::size_t>(member) + c] = scale * sum[c];
        }
    });
}

void ConservedVolume::add_hessian(BlockMatrix& a) const {
    parallel_for(a.pattern->block_count(), 512, [&](std::size_t index) {
        double* block = a.block(index);
        for (int k = block_start_[index]; k < block_start_[index + 1]; k += 2) {
            const double* row = slope_.data() + 3 * pairs_[static_cast<std::size_t>(k)];
            const double* column = slope_.data() + 3 * pairs_[static_cast<std::size_t>(k) + 1];
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) block[3 * r + c] += row[r] * column[c];
        }
    });
}

} // namespace sinew::solver
