// The Hessian of all tets, chunk by chunk: batch by batch in parallel into places of their own, then added block by
// block.
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

void Elastic::find_chunks() {
    std::size_t entries = 0, most = 0; // of the last chunk, of the largest
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueBatches& batches = system_.tissues[t];
        const std::size_t size = batches.hessian_at(1) - batches.hessian_at(0);
        for (std::size_t first = 0; first < batches.batch_count;) {
            if (chunks_.empty() || entries + size > chunk_entries) {
                chunks_.emplace_back().first_entry = batches.hessian_at(first);
                entries = 0;
            }
            const std::size_t end =
                std::min(batches.batch_count, first + std::max<std::size_t>(1, (chunk_entries - entries) / size));
            chunks_.back().parts.push_back({t, first, end});
            entries += (end - first) * size;
            most = std::max(most, entries);
            first = end;
        }
    }
    entries_.resize(most);
}

void Elastic::bind(const BlockPattern& pattern) {
    pattern_ = &pattern;
    const auto row = [&](int vertex) { return system_.numbering.unknown[static_cast<std::size_t>(vertex)]; };
    std::vector<int> place(pattern.block_count(), -1); // of each block among those of the chunk
    for (HessianChunk& chunk : chunks_) {
        std::vector<int> blocks, block_of, codes;
        for (HessianChunk::Part& part : chunk.parts) {
            const TissueBatches& batches = system_.tissues[part.tissue];
            part.first_block = blocks.size();
            const std::size_t end = std::min(part.end * lanes, batches.tet_count);
            for (std::size_t slot = part.first * lanes; slot < end; ++slot) {
                const std::size_t lane = slot % lanes;
                std::size_t at = batches.hessian_at(slot / lanes) - chunk.first_entry + lane;
                for (int a = 0; a < batches.nodes(); ++a)
                    for (int b = a; b < batches.nodes(); ++b, at += 9 * lanes) {
                        const int i = row(system_.node(batches, slot / lanes, a)[lane]),
                                  j = row(system_.node(batches, slot / lanes, b)[lane]);
                        if (i < 0 || j < 0) continue;
                        const int block = pattern.find(std::min(i, j), std::max(i, j));
                        int& k = place[static_cast<std::size_t>(block)];
                        if (k < 0) k = static_cast<int>(blocks.size()), blocks.push_back(block);
                        block_of.push_back(k);
                        codes.push_back(static_cast<int>(2 * at) + (i > j ? 1 : 0));
                    }
            }
            part.end_block = blocks.size();
        }
        sort_into(blocks.size(), chunk.start, chunk.contributions, [&](const auto& visit) {
            for (std::size_t c = 0; c < codes.size(); ++c) visit(static_cast<std::size_t>(block_of[c]), codes[c]);
        });
        for (const int block : blocks) place[static_cast<std::size_t>(block)] = -1;
        blocks.shrink_to_fit();
        chunk.blocks = std::move(blocks);
    }
    for (const auto& patches : patches_)
        if (patches) patches->bind(pattern);
}

void Elastic::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    for (std::size_t t = 0; t < patches_.size(); ++t) {
        if (!patches_[t] || resting_[t]) continue;
        patches_[t]->set_pressures(x);
        patches_[t]->set_slopes(x, gradients_); // so the forces there are gone until they are evaluated anew
    }
    parallel_for(pattern_->block_count(), 4096, [&](std::size_t index) { std::fill_n(a.block(index), 9, 0.0); });
    const auto add_blocks = [&](const HessianChunk& chunk, std::size_t first, std::size_t end) {
        parallel_for(end - first, 512, [&](std::size_t n) {
            const std::size_t k = first + n;
            double* block = a.block(static_cast<std::size_t>(chunk.blocks[k]));
            double sum[9];
            std::copy_n(block, 9, sum);
            for (int c = chunk.start[k]; c < chunk.start[k + 1]; ++c) {
                const int code = chunk.contributions[static_cast<std::size_t>(c)];
                const double* h = entries_.data() + code / 2;
                if (code % 2)
                    for (int r = 0; r < 3; ++r)
                        for (int m = 0; m < 3; ++m) sum[3 * r + m] += h[(3 * m + r) * lanes];
                else
                    for (int m = 0; m < 9; ++m) sum[m] += h[m * lanes];
            }
            std::copy_n(sum, 9, block);
        });
    };
    for (const HessianChunk& chunk : chunks_) {
        for (const HessianChunk::Part& part : chunk.parts)
            if (!resting_[part.tissue]) set_entries(chunk, part, x, project);
        // The parts that follow each other in one loop.
        for (std::size_t p = 0; p < chunk.parts.size();) {
            std::size_t next = p + 1;
            if (!resting_[chunk.parts[p].tissue]) {
                while (next < chunk.parts.size() && !resting_[chunk.parts[next].tissue]) ++next;
                add_blocks(chunk, chunk.parts[p].first_block, chunk.parts[next - 1].end_block);
            }
            p = next;
        }
    }
    for (std::size_t t = 0; t < patches_.size(); ++t)
        if (patches_[t] && !resting_[t]) patches_[t]->add_hessian(a);
}

void Elastic::set_entries(const HessianChunk& chunk, const HessianChunk::Part& part, const Positions& x, bool project) {
    const TissueBatches& batches = system_.tissues[part.tissue];
    const auto& patches = patches_[part.tissue];
    parallel_for(part.end - part.first, batch_grain, [&](std::size_t k) {
        const std::size_t i = part.first + k;
        PointInputs in = point_inputs(part.tissue, i);
        double* h = entries_.data() + (batches.hessian_at(i) - chunk.first_entry);
        if (batches.kind == ElementKind::quadratic)
            return quadratic_hessian(in, edges(part.tissue, i), has_means_[part.tissue], x.data(), project, h);
        Pressures pressures{Pack(0.0), Pack(0.0)};
        if (patches) {
            pressures.j = Pack::load(patches->pressures(i));
            in.pressures = &pressures;
        }
        point_hessian(in, corners_of(in.batch, x.data()), project, h);
    });
}

} // namespace sinew::solver
