// The Hessian of all tets: batch by batch in parallel into places of their own, then gathered block by block.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/parallel.h"
#include "solver/sort_into.h"
#include "solver/terms/elastic/elastic.h"

#include <algorithm>

namespace sinew::solver {

namespace {

constexpr std::size_t batch_grain = 32;

} // namespace

void Elastic::add_couplings(Couplings& couplings) const {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        for (std::size_t slot = 0; slot < batches.tet_count; ++slot)
            for (int a = 0; a < batches.nodes(); ++a)
                for (int b = a; b < batches.nodes(); ++b)
                    couplings.emplace_back(system_.node(batches, slot / lanes, a)[slot % lanes],
                                           system_.node(batches, slot / lanes, b)[slot % lanes]);
        if (patches_[t]) patches_[t]->add_couplings(couplings);
    }
}

void Elastic::bind(const BlockPattern& pattern) {
    pattern_ = &pattern;
    const auto row = [&](int vertex) { return system_.numbering.unknown[static_cast<std::size_t>(vertex)]; };
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
    for (const auto& patches : patches_)
        if (patches) patches->bind(pattern);
}

void Elastic::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        if (patches_[t]) {
            patches_[t]->set_pressures(x);
            patches_[t]->set_slopes(x, gradients_);
        }
        parallel_for(batches.batch_count, batch_grain, [&](std::size_t i) {
            PointInputs in = point_inputs(t, i);
            double* h = hessians_.data() + batches.hessian_at(i);
            if (batches.kind == ElementKind::quadratic)
                return quadratic_hessian(in, edges(t, i), has_means_[t], x.data(), project, h);
            Pressures pressures{Pack(0.0), Pack(0.0)};
            if (patches_[t]) {
                pressures.j = Pack::load(patches_[t]->pressures(i));
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
    for (const auto& patches : patches_)
        if (patches) patches->add_hessian(a);
}

} // namespace sinew::solver
