// The machine under most terms: many small energies, each of N points that ride on vertices (carried_points.h). A term
// writes a kernel over packs of stencils; this gathers points, and sums energies, gradients and Hessians in a fixed
// order, so that they have the same bits for any number of threads.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/sort_into.h"
#include "solver/term/carried_points.h"
#include "solver/term/pack_vector.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace sinew::solver {

/// Positions or gradients of the points of a pack of stencils.
template <int N>
using StencilVectors = std::array<PackVector, N>;
/// Second derivatives by corners (0, 0), (0, 1) … (0, N - 1), (1, 1) …; row-major.
template <int N>
using StencilBlocks = std::array<PackMatrix, N*(N + 1) / 2>;

template <int N>
class Stencils {
  public:
    static constexpr std::size_t pairs = N * (N + 1) / 2;
    using Corners = std::array<int, N>;

    /// `points`, `carrier`: see CarriedPoints. Each stencil names its points.
    Stencils(const Numbering& numbering, const std::vector<PointWeights>& points, const std::vector<int>& carrier,
             std::vector<Corners> stencils)
        : stencils_(std::move(stencils))
        , links_(links_of(stencils_))
        , carried_(numbering, points, carrier, links_)
        , places_(3 * points.size(), 0.0)
        , by_points_(3 * points.size(), 0.0)
        , by_links_(9 * links_.size(), 0.0)
        , energies_(lanes * batch_count(), 0.0)
        , gradients_(lanes * batch_count() * 3 * N, 0.0)
        , hessians_(lanes * std::min(batch_count(), chunk_batches) * 9 * pairs, 0.0) {
        const auto first_of = [](std::size_t stencil, std::size_t entries) {
            return static_cast<int>(stencil / lanes * entries * lanes + stencil % lanes);
        };
        sort_into(points.size(), of_point_start_, of_point_, [&](const auto& visit) {
            for (std::size_t s = 0; s < stencils_.size(); ++s)
                for (std::size_t c = 0; c < N; ++c)
                    visit(at(stencils_[s][c]), first_of(s, 3 * N) + static_cast<int>(3 * c * lanes));
        });
        find_chunks();
    }

    std::size_t count() const { return stencils_.size(); }
    std::size_t point_count() const { return carried_.count(); }
    std::size_t batch_count() const { return (stencils_.size() + lanes - 1) / lanes; }
    /// Of any slot of the batches; those after the last stencil repeat it.
    const Corners& corners(std::size_t slot) const { return stencils_[std::min(slot, stencils_.size() - 1)]; }
    /// 3 a point, where the last move or evaluation took them. Points without vertices may be put somewhere here.
    std::span<double> places() { return places_; }
    std::span<const double> places() const { return places_; }
    /// The gradient by points of the last evaluation with gradient, 3 a point.
    std::span<const double> by_points() const { return by_points_; }
    const CarriedPoints& carried() const { return carried_; }

    void move(const Positions& x) { carried_.move(x, places_); }

    /// Sum of kernel(batch, points, gradient) over all stencils, for points as they are placed. With `with_gradient`
    /// keeps the gradient by points.
    template <class Kernel>
    double evaluate(bool with_gradient, const Kernel& kernel) {
        parallel_for(batch_count(), 64, [&](std::size_t b) {
            StencilVectors<N> g;
            const Pack energy = kernel(b, load(b), g);
            energy.store(energies_.data() + b * lanes);
            if (!with_gradient) return;
            double* out = gradients_.data() + b * lanes * 3 * N;
            for (const PackVector& corner : g)
                for (const Pack& component : {corner.x, corner.y, corner.z}) component.store(out), out += lanes;
        });
        if (with_gradient) gather_gradient();
        return ordered_sum(count(), [&](std::size_t s) { return energies_[s]; });
    }
    /// Hands the gradient by points on to what carries them; add_gradient and its kin give it then.
    void carry_gradient() { carried_.set_gradient(by_points_); }
    void add_gradient(std::span<double> by_unknowns) const { carried_.add_gradient(by_unknowns); }
    void add_held_gradient(std::span<double> by_vertices) const { carried_.add_held_gradient(by_vertices); }

    void add_couplings(Couplings& couplings) const { carried_.add_couplings(couplings); }
    void bind(const BlockPattern& pattern) { carried_.bind(pattern); }
    /// Adds what kernel(batch, points, blocks) gives, for points as they are placed.
    template <class Kernel>
    void add_hessian(const Kernel& kernel, BlockMatrix& a) {
        const bool by_vertices = carried_.are_vertices();
        for (const Chunk& chunk : chunks_) {
            parallel_for(chunk.end_batch - chunk.first_batch, 8, [&](std::size_t of_chunk) {
                const std::size_t b = chunk.first_batch + of_chunk;
                StencilBlocks<N> h;
                kernel(b, load(b), h);
                // Block after block of each stencil, as they are gathered.
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    double* out = hessians_.data() + (of_chunk * lanes + lane) * 9 * pairs;
                    for (const PackMatrix& block : h)
                        for (const Pack& entry : block) *out++ = entry.v[lane];
                }
            });
            parallel_for(chunk.end_link - chunk.first_link, 128, [&](std::size_t of_chunk) {
                const ChunkLink& to = chunk_links_[chunk.first_link + of_chunk];
                double* const by_link = by_links_.data() + 9 * at(to.link);
                double sum[9] = {};
                if (!to.is_first) std::copy_n(by_link, 9, sum);
                for (std::size_t k = to.start; k < (&to)[1].start; ++k) {
                    const int code = of_link_[k];
                    const double* h = hessians_.data() + code / 2;
                    if (code % 2)
                        for (int d = 0; d < 9; ++d) sum[d] += h[3 * (d % 3) + d / 3];
                    else
                        for (int d = 0; d < 9; ++d) sum[d] += h[d];
                }
                if (to.is_last && by_vertices)
                    carried_.add_link(at(to.link), sum, a);
                else
                    std::copy_n(sum, 9, by_link);
            });
        }
        if (!by_vertices) carried_.add_hessian(by_links_, a);
    }

  private:
    /// Batches whose Hessians are there at the same time, so few that a processor's second cache holds them until they
    /// are added up. Links add up in the order of the stencils, however many a chunk has.
    struct Chunk {
        std::size_t first_batch, end_batch, first_link, end_link; ///< the latter in chunk_links_
    };
    struct ChunkLink {
        int link;
        bool is_first, is_last; ///< of the chunks that have it
        std::size_t start;      ///< in of_link_, of what the chunk's stencils give; up to that of the next one
    };
    static constexpr std::size_t chunk_bytes = std::size_t{1} << 19,
                                 chunk_batches = chunk_bytes / (lanes * 9 * pairs * sizeof(double));

    void find_chunks() {
        std::vector<std::size_t> last(links_.size(), 0); // one more than its place in chunk_links_
        std::vector<std::pair<int, int>> given;
        for (std::size_t first = 0; first < batch_count(); first += chunk_batches) {
            const std::size_t end = std::min(first + chunk_batches, batch_count());
            given.clear();
            for (std::size_t s = first * lanes; s < std::min(end * lanes, stencils_.size()); ++s) {
                int entry = static_cast<int>((s - first * lanes) * 9 * pairs);
                for (std::size_t a = 0; a < N; ++a)
                    for (std::size_t b = a; b < N; ++b, entry += 9) {
                        const int i = stencils_[s][a], j = stencils_[s][b];
                        const auto link = std::lower_bound(links_.begin(), links_.end(), link_of(i, j));
                        given.emplace_back(static_cast<int>(link - links_.begin()), 2 * entry + (i > j ? 1 : 0));
                    }
            }
            std::sort(given.begin(), given.end()); // of a link in the order of the stencils, as entries go
            Chunk chunk{first, end, chunk_links_.size(), 0};
            for (const auto& [link, code] : given) {
                if (chunk_links_.size() == chunk.first_link || chunk_links_.back().link != link) {
                    chunk_links_.push_back({link, last[at(link)] == 0, false, of_link_.size()});
                    last[at(link)] = chunk_links_.size();
                }
                of_link_.push_back(code);
            }
            chunk.end_link = chunk_links_.size();
            chunks_.push_back(chunk);
        }
        for (const std::size_t place : last) chunk_links_[place - 1].is_last = true;
        chunk_links_.push_back({-1, false, false, of_link_.size()});
    }
    static std::pair<int, int> link_of(int i, int j) { return {std::min(i, j), std::max(i, j)}; }
    static std::vector<std::pair<int, int>> links_of(const std::vector<Corners>& stencils) {
        std::vector<std::pair<int, int>> out;
        for (const Corners& s : stencils)
            for (std::size_t a = 0; a < N; ++a)
                for (std::size_t b = a; b < N; ++b) out.push_back(link_of(s[a], s[b]));
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    }
    StencilVectors<N> load(std::size_t batch) const {
        StencilVectors<N> x;
        for (std::size_t lane = 0; lane < lanes; ++lane)
            for (std::size_t c = 0; c < N; ++c) {
                const double* p = places_.data() + 3 * at(corners(batch * lanes + lane)[c]);
                x[c].x.v[lane] = p[0], x[c].y.v[lane] = p[1], x[c].z.v[lane] = p[2];
            }
        return x;
    }
    void gather_gradient() {
        parallel_for(point_count(), 1024, [&](std::size_t p) {
            double sum[3] = {};
            for (int k = of_point_start_[p]; k < of_point_start_[p + 1]; ++k)
                for (int d = 0; d < 3; ++d) sum[d] += gradients_[at(of_point_[at(k)] + d * lanes)];
            std::copy_n(sum, 3, by_points_.data() + 3 * p);
        });
    }

    std::vector<Corners> stencils_;
    std::vector<std::pair<int, int>> links_;
    CarriedPoints carried_;
    std::vector<double> places_, by_points_, by_links_, energies_, gradients_, hessians_;
    std::vector<int> of_point_start_, of_point_; ///< per point: where gradients of corners begin
    std::vector<Chunk> chunks_;
    std::vector<ChunkLink> chunk_links_; ///< chunk after chunk, and one more
    std::vector<int> of_link_;           ///< twice where a block begins in its chunk, plus one if it is transposed
};

} // namespace sinew::solver
