// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/carried_points.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/sort_into.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>

namespace sinew::solver {

namespace {

/// Carriers are handled in this many chunks at most, each with scratch of its own.
constexpr std::size_t most_chunks = 64;

} // namespace

CarriedPoints::CarriedPoints(const Numbering& numbering, const std::vector<PointWeights>& points,
                             const std::vector<int>& carrier, const std::vector<std::pair<int, int>>& links)
    : numbering_(numbering)
    , count_(points.size())
    , link_count_(links.size()) {
    std::vector<int> order(count_);
    std::iota(order.begin(), order.end(), 0);
    std::erase_if(order, [&](int p) { return points[at(p)].count == 0; });
    std::stable_sort(order.begin(), order.end(), [&](int p, int q) { return carrier[at(p)] < carrier[at(q)]; });
    point_ = std::move(order);
    for (std::size_t first = 0, next; first < point_.size(); first = next) {
        for (next = first; next < point_.size() && carrier[at(point_[next])] == carrier[at(point_[first])];) ++next;
        std::vector<int> vertices;
        for (std::size_t i = first; i < next; ++i) {
            const PointWeights& w = points[at(point_[i])];
            vertices.insert(vertices.end(), w.vertex, w.vertex + w.count);
        }
        std::sort(vertices.begin(), vertices.end());
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
        Carrier c{vertex_.size(), vertices.size(), first, next - first, weight_.size()};
        weight_.resize(weight_.size() + c.vertex_count * c.point_count, 0.0);
        for (std::size_t i = 0; i < c.point_count; ++i) {
            const PointWeights& w = points[at(point_[first + i])];
            for (int k = 0; k < w.count; ++k) {
                const auto place = std::lower_bound(vertices.begin(), vertices.end(), w.vertex[k]) - vertices.begin();
                weight_[c.first_weight + i * c.vertex_count + at(place)] += w.weight[k];
            }
        }
        carrier_of_.insert(carrier_of_.end(), c.point_count, static_cast<int>(carriers_.size()));
        vertex_.insert(vertex_.end(), vertices.begin(), vertices.end());
        carriers_.push_back(c);
    }
    for (const int v : vertex_) unknown_.push_back(numbering.unknown[at(v)]);
    gradient_.assign(3 * vertex_.size(), 0.0);
    sort_into(numbering.unknown_count(), of_unknown_start_, of_unknown_, [&](const auto& visit) {
        for (std::size_t k = 0; k < unknown_.size(); ++k)
            if (unknown_[k] >= 0) visit(at(unknown_[k]), static_cast<int>(k));
    });
    find_neighbours(links);
    find_columns();
}

void CarriedPoints::find_neighbours(const std::vector<std::pair<int, int>>& links) {
    std::vector<int> place_of(count_, -1);
    for (std::size_t i = 0; i < point_.size(); ++i) place_of[at(point_[i])] = static_cast<int>(i);
    std::vector<int> start, entries;
    const auto for_each_end = [&](const auto& visit) {
        for (std::size_t l = 0; l < links.size(); ++l) {
            const int i = place_of[at(links[l].first)], j = place_of[at(links[l].second)];
            if (i < 0 || j < 0) continue;
            visit(at(i), static_cast<int>(2 * l));
            if (i != j) visit(at(j), static_cast<int>(2 * l + 1));
        }
    };
    sort_into(point_.size(), start, entries, for_each_end);
    neighbour_start_.assign(start.begin(), start.end());
    for (const int code : entries) {
        const auto [i, j] = links[at(code / 2)];
        neighbours_.push_back({place_of[at(code % 2 ? i : j)], code, 0});
    }
}

void CarriedPoints::find_columns() {
    std::size_t entries = 0;
    for (Carrier& c : carriers_) {
        const std::size_t first = neighbour_start_[c.first_point],
                          end = neighbour_start_[c.first_point + c.point_count];
        std::vector<int> reached; // carriers
        for (std::size_t n = first; n < end; ++n) reached.push_back(carrier_of_[at(neighbours_[n].point)]);
        std::sort(reached.begin(), reached.end());
        reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
        std::vector<int> columns;
        for (const int r : reached) {
            const Carrier& to = carriers_[at(r)];
            for (std::size_t k = to.first_vertex; k < to.first_vertex + to.vertex_count; ++k)
                if (unknown_[k] >= 0) columns.push_back(unknown_[k]);
        }
        std::sort(columns.begin(), columns.end());
        columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
        std::vector<std::size_t> places; // of the reached carriers, in place_
        for (const int r : reached) {
            places.push_back(place_.size());
            const Carrier& to = carriers_[at(r)];
            for (std::size_t k = to.first_vertex; k < to.first_vertex + to.vertex_count; ++k) {
                const auto place = std::lower_bound(columns.begin(), columns.end(), unknown_[k]) - columns.begin();
                place_.push_back(unknown_[k] < 0 ? -1 : static_cast<int>(place));
            }
        }
        for (std::size_t n = first; n < end; ++n) {
            const auto r = std::lower_bound(reached.begin(), reached.end(), carrier_of_[at(neighbours_[n].point)]);
            neighbours_[n].first_place = places[at(r - reached.begin())];
        }
        c.first_column = column_.size();
        c.column_count = columns.size();
        column_.insert(column_.end(), columns.begin(), columns.end());
        most_columns_ = std::max(most_columns_, columns.size());
        c.first_entry = entries;
        for (std::size_t k = c.first_vertex; k < c.first_vertex + c.vertex_count; ++k) {
            const auto own = std::lower_bound(columns.begin(), columns.end(), unknown_[k]) - columns.begin();
            row_start_.push_back(unknown_[k] < 0 ? columns.size() : at(own));
            entries += 9 * (c.column_count - row_start_.back());
        }
        c.entry_count = entries - c.first_entry;
    }
    if (entries > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw Error("FE210",
                    "forces on surfaces take " + std::to_string(entries) + " stiffness entries; " +
                        std::to_string(std::numeric_limits<int>::max()) + " can be numbered",
                    "choose larger tets or coarser surfaces");
    entries_.resize(entries);
    scratch_.resize(std::min(most_chunks, carriers_.size()) * 9 * most_columns_);
}

void CarriedPoints::move(const Positions& x, std::span<double> points) const {
    parallel_for(carriers_.size(), 256, [&](std::size_t index) {
        const Carrier& c = carriers_[index];
        const double* w = weight_.data() + c.first_weight;
        for (std::size_t i = 0; i < c.point_count; ++i, w += c.vertex_count) {
            double sum[3] = {};
            for (std::size_t k = 0; k < c.vertex_count; ++k) {
                const double* p = x.data() + 3 * at(vertex_[c.first_vertex + k]);
                for (int d = 0; d < 3; ++d) sum[d] += w[k] * p[d];
            }
            std::copy_n(sum, 3, points.data() + 3 * at(point_[c.first_point + i]));
        }
    });
}

void CarriedPoints::set_gradient(std::span<const double> by_points) {
    parallel_for(carriers_.size(), 256, [&](std::size_t index) {
        const Carrier& c = carriers_[index];
        const double* w = weight_.data() + c.first_weight;
        double* out = gradient_.data() + 3 * c.first_vertex;
        std::fill_n(out, 3 * c.vertex_count, 0.0);
        for (std::size_t i = 0; i < c.point_count; ++i, w += c.vertex_count) {
            const double* g = by_points.data() + 3 * at(point_[c.first_point + i]);
            for (std::size_t k = 0; k < c.vertex_count; ++k)
                for (std::size_t d = 0; d < 3; ++d) out[3 * k + d] += w[k] * g[d];
        }
    });
}

void CarriedPoints::add_gradient(std::span<double> by_unknowns) const {
    parallel_for(numbering_.unknown_count(), 512, [&](std::size_t u) {
        for (int k = of_unknown_start_[u]; k < of_unknown_start_[u + 1]; ++k)
            for (std::size_t d = 0; d < 3; ++d) by_unknowns[3 * u + d] += gradient_[3 * at(of_unknown_[at(k)]) + d];
    });
}

void CarriedPoints::add_held_gradient(std::span<double> by_vertices) const {
    for (std::size_t k = 0; k < vertex_.size(); ++k)
        for (std::size_t d = 0; unknown_[k] < 0 && d < 3; ++d)
            by_vertices[3 * at(vertex_[k]) + d] += gradient_[3 * k + d];
}

void CarriedPoints::add_squared_gradient(std::span<double> of_deformables) const {
    for (std::size_t body = 0; body < numbering_.deformables.size(); ++body) {
        const Deformable& d = numbering_.deformables[body];
        of_deformables[body] += ordered_sum(vertex_.size(), [&](std::size_t k) {
            const std::size_t v = at(vertex_[k]);
            if (v < d.first_vertex || v >= d.first_vertex + d.vertex_count) return 0.0;
            const double* g = gradient_.data() + 3 * k;
            return g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
        });
    }
}

void CarriedPoints::add_couplings(Couplings& couplings) const {
    for (const Carrier& c : carriers_)
        for (std::size_t k = c.first_vertex; k < c.first_vertex + c.vertex_count; ++k)
            for (std::size_t j = row_start_[k]; j < c.column_count; ++j)
                couplings.emplace_back(vertex_[k], numbering_.vertex_of_unknown[at(column_[c.first_column + j])]);
}

void CarriedPoints::find_link_blocks(const BlockPattern& pattern) {
    link_block_.clear();
    const auto is_vertex = [&](const Carrier& c) {
        return c.vertex_count == 1 && c.point_count == 1 && weight_[c.first_weight] == 1;
    };
    if (carriers_.size() != count_ || !std::all_of(carriers_.begin(), carriers_.end(), is_vertex)) return;
    for (std::size_t u = 0; u < numbering_.unknown_count(); ++u)
        if (of_unknown_start_[u + 1] - of_unknown_start_[u] > 1) return; // two points that are the same vertex
    link_block_.assign(link_count_, -1);
    for (std::size_t i = 0; i < point_.size(); ++i)
        for (std::size_t n = neighbour_start_[i]; n < neighbour_start_[i + 1]; ++n) {
            const Neighbour& to = neighbours_[n];
            const int row = unknown_[i], column = unknown_[at(to.point)];
            if (row < 0 || column < row) continue;
            link_block_[at(to.link / 2)] = 2 * pattern.find(row, column) + to.link % 2;
        }
}

void CarriedPoints::add_link(std::size_t link, const double* block, BlockMatrix& a) const {
    const int code = link_block_[link];
    if (code < 0) return;
    double* out = a.block(at(code / 2));
    for (int d = 0; d < 9; ++d) out[d] += block[code % 2 ? 3 * (d % 3) + d / 3 : d];
}

void CarriedPoints::bind(const BlockPattern& pattern) {
    find_link_blocks(pattern);
    std::vector<int> start, entries;
    sort_into(pattern.block_count(), start, entries, [&](const auto& visit) {
        std::size_t entry = 0;
        for (const Carrier& c : carriers_)
            for (std::size_t k = c.first_vertex; k < c.first_vertex + c.vertex_count; ++k)
                for (std::size_t j = row_start_[k]; j < c.column_count; ++j, entry += 9)
                    visit(at(pattern.find(unknown_[k], column_[c.first_column + j])), static_cast<int>(entry));
    });
    block_.clear(), block_start_.assign(1, 0);
    for (std::size_t b = 0; b < pattern.block_count(); ++b) {
        if (start[b] == start[b + 1]) continue;
        block_.push_back(static_cast<int>(b));
        block_start_.push_back(start[b + 1]);
    }
    of_block_ = std::move(entries);
}

void CarriedPoints::add_share(const Carrier& c, std::span<const double> blocks, double* by_columns) {
    double* const first = entries_.data() + c.first_entry;
    std::fill_n(first, c.entry_count, 0.0);
    for (std::size_t i = 0; i < c.point_count; ++i) {
        // The point's derivatives by all columns, then each row's share of them.
        std::fill_n(by_columns, 9 * c.column_count, 0.0);
        const std::size_t place = c.first_point + i;
        for (std::size_t n = neighbour_start_[place]; n < neighbour_start_[place + 1]; ++n) {
            const Neighbour& to = neighbours_[n];
            const Carrier& carrier = carriers_[at(carrier_of_[at(to.point)])];
            const double* h = blocks.data() + 9 * at(to.link / 2);
            double block[9];
            for (int d = 0; d < 9; ++d) block[d] = to.link % 2 ? h[3 * (d % 3) + d / 3] : h[d];
            const double* w =
                weight_.data() + carrier.first_weight + (at(to.point) - carrier.first_point) * carrier.vertex_count;
            for (std::size_t k = 0; k < carrier.vertex_count; ++k) {
                const int column = place_[to.first_place + k];
                if (column < 0 || w[k] == 0) continue;
                double* out = by_columns + 9 * at(column);
                for (int d = 0; d < 9; ++d) out[d] += w[k] * block[d];
            }
        }
        const double* w = weight_.data() + c.first_weight + i * c.vertex_count;
        double* out = first;
        for (std::size_t k = 0; k < c.vertex_count; ++k) {
            const std::size_t start = row_start_[c.first_vertex + k], count = 9 * (c.column_count - start);
            const double* from = by_columns + 9 * start;
            for (std::size_t d = 0; w[k] != 0 && d < count; ++d) out[d] += w[k] * from[d];
            out += count;
        }
    }
}

void CarriedPoints::add_hessian(std::span<const double> blocks, BlockMatrix& a) {
    const std::size_t chunks = std::min(most_chunks, carriers_.size());
    parallel_for(chunks, 1, [&](std::size_t chunk) {
        double* scratch = scratch_.data() + chunk * 9 * most_columns_;
        for (std::size_t i = chunk * carriers_.size() / chunks; i < (chunk + 1) * carriers_.size() / chunks; ++i)
            add_share(carriers_[i], blocks, scratch);
    });
    parallel_for(block_.size(), 512, [&](std::size_t b) {
        double* out = a.block(at(block_[b]));
        for (int k = block_start_[b]; k < block_start_[b + 1]; ++k) {
            const double* entry = entries_.data() + of_block_[at(k)];
            for (int d = 0; d < 9; ++d) out[d] += entry[d];
        }
    });
}

} // namespace sinew::solver
