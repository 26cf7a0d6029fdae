// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/surface_hessian.h"

#include "solver/index.h"

#include <algorithm>

namespace sinew::solver {

namespace {

constexpr std::array<std::pair<int, int>, 6> corner_pairs{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

} // namespace

SurfaceHessian::SurfaceHessian(const CarriedSurface& surface)
    : surface_(surface) {
    struct Found {
        int first, second, triangle, place;
    };
    std::vector<Found> found;
    for (std::size_t t = 0; t < surface.triangles().size(); ++t)
        for (std::size_t k = 0; k < corner_pairs.size(); ++k) {
            const int p = surface.triangles()[t][at(corner_pairs[k].first)],
                      q = surface.triangles()[t][at(corner_pairs[k].second)];
            found.push_back({std::min(p, q), std::max(p, q), static_cast<int>(t), static_cast<int>(k)});
        }
    std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
        return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    });
    of_triangle_.resize(surface.triangles().size());
    for (const Found& f : found) {
        if (pairs_.empty() || pairs_.back().first != f.first || pairs_.back().second != f.second)
            pairs_.push_back({f.first, f.second});
        of_triangle_[at(f.triangle)][at(f.place)] = static_cast<int>(pairs_.size()) - 1;
    }
    sums_.resize(pairs_.size()), used_.resize(pairs_.size());
    for (const Pair& pair : pairs_)
        for (const RideTerm& a : surface_.free_ride(pair.first))
            for (const RideTerm& b : surface_.free_ride(pair.second))
                if (a.vertex != b.vertex)
                    couplings_.emplace_back(std::min(a.vertex, b.vertex), std::max(a.vertex, b.vertex));
    std::sort(couplings_.begin(), couplings_.end());
    couplings_.erase(std::unique(couplings_.begin(), couplings_.end()), couplings_.end());
    couplings_.shrink_to_fit();
}

void SurfaceHessian::bind(const Numbering& numbering, const BlockPattern& pattern) {
    entries_.clear(), first_entry_.clear();
    for (const Pair& pair : pairs_) {
        first_entry_.push_back(entries_.size());
        for (const RideTerm& a : surface_.free_ride(pair.first))
            for (const RideTerm& b : surface_.free_ride(pair.second)) {
                const int row = numbering.unknown[at(a.vertex)], column = numbering.unknown[at(b.vertex)];
                if (row < 0 || column < 0) continue;
                const double weight = a.weight * b.weight;
                // The pattern holds the upper triangle. The block of a pair (p, q) stands for that of (q, p) as well:
                // where p and q share a carrier both fall on its diagonal.
                if (row <= column) entries_.push_back({pattern.find(row, column), weight, false});
                if (pair.first != pair.second && column <= row)
                    entries_.push_back({pattern.find(column, row), weight, true});
            }
    }
    first_entry_.push_back(entries_.size());
}

void SurfaceHessian::clear() { std::fill(used_.begin(), used_.end(), 0); }

void SurfaceHessian::add(int triangle, const PointTriangleBlocks& blocks, double factor) {
    for (std::size_t k = 0; k < corner_pairs.size(); ++k) {
        const std::size_t pair = at(of_triangle_[at(triangle)][k]);
        const auto [c, d] = corner_pairs[k];
        const Mat3& block = blocks[Overlay::block_of(c + 1, d + 1)];
        const Triangle& corners = surface_.triangles()[at(triangle)];
        if (!used_[pair]) sums_[pair].setZero(), used_[pair] = 1;
        if (corners[at(c)] <= corners[at(d)])
            sums_[pair] += factor * block;
        else
            sums_[pair] += factor * block.transpose();
    }
}

void SurfaceHessian::add_to(BlockMatrix& a) const {
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        if (!used_[p]) continue;
        const Mat3 by_rows = sums_[p].transpose(); // as the matrix keeps its blocks
        for (std::size_t e = first_entry_[p]; e < first_entry_[p + 1]; ++e)
            add_scaled(entries_[e].weight, entries_[e].transposed ? sums_[p] : by_rows, a.block(at(entries_[e].block)));
    }
}

} // namespace sinew::solver
