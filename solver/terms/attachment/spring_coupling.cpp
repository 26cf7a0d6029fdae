// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_coupling.h"

#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/sort_into.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tbb/enumerable_thread_specific.h>
#include <tuple>
#include <unordered_map>

namespace sinew::solver {

namespace {

/// Whether two springs have the same attachment and vertices, and so the same blocks.
bool alike(const CoupledSpring& s, const CoupledSpring& t) {
    return s.attachment == t.attachment &&
           std::equal(s.terms.begin(), s.terms.end(), t.terms.begin(), t.terms.end(),
                      [](const SpringTerm& v, const SpringTerm& w) { return v.vertex == w.vertex; });
}

struct Hash {
    std::size_t operator()(const CoupledSpring* s) const {
        std::uint64_t h = static_cast<std::uint64_t>(s->attachment);
        for (const SpringTerm& t : s->terms) {
            h = (h ^ static_cast<std::uint64_t>(t.vertex)) * 0x9e3779b97f4a7c15U;
            h ^= h >> 32;
        }
        return h;
    }
};

struct Alike {
    bool operator()(const CoupledSpring* s, const CoupledSpring* t) const { return alike(*s, *t); }
};

/// Springs that are alike, by groups that come in the order of their first springs: places in the list of springs.
struct Groups {
    std::vector<int> start, spring;
    std::span<const int> of(std::size_t group) const {
        return std::span(spring).subspan(at(start[group]), at(start[group + 1] - start[group]));
    }
};

Groups groups_of(const std::vector<CoupledSpring>& springs) {
    std::unordered_map<const CoupledSpring*, int, Hash, Alike> known;
    std::vector<int> group(springs.size());
    for (std::size_t s = 0; s < springs.size(); ++s)
        group[s] = known.try_emplace(&springs[s], static_cast<int>(known.size())).first->second;
    Groups out;
    sort_into(known.size(), out.start, out.spring, [&](const auto& visit) {
        for (std::size_t s = 0; s < springs.size(); ++s) visit(at(group[s]), static_cast<int>(s));
    });
    return out;
}

/// What one attachment's springs make between a node and another.
struct Product {
    int column, attachment;
    double product;
};

/// The products of one node after the other, by a thread that keeps its working memory.
class RowProducts {
  public:
    explicit RowProducts(std::size_t nodes)
        : place_(nodes, -1) {}

    /// Begins with another node.
    void begin() {
        for (const Product& p : products_) place_[at(p.column)] = -1;
        products_.clear();
    }

    /// Adds what springs that are alike make between their term `own` and all; attachments must not fall.
    void add(const std::vector<CoupledSpring>& springs, std::span<const int> group, std::size_t own,
             const std::vector<int>& node_of) {
        const CoupledSpring& first = springs[at(group.front())];
        sum_.assign(first.terms.size(), 0);
        for (const int s : group) {
            const std::span<const SpringTerm> terms = springs[at(s)].terms;
            const double weight = springs[at(s)].area_weight * terms[own].coefficient;
            for (std::size_t j = 0; j < terms.size(); ++j) sum_[j] += weight * terms[j].coefficient;
        }
        for (std::size_t j = 0; j < first.terms.size(); ++j) {
            const int column = node_of[at(first.terms[j].vertex)];
            int& place = place_[at(column)];
            if (place < 0 || products_[at(place)].attachment != first.attachment) {
                place = static_cast<int>(products_.size());
                products_.push_back({column, first.attachment, 0});
            }
            products_[at(place)].product += sum_[j];
        }
    }

    /// By columns, and in each by attachments.
    std::vector<Product> sorted() const {
        std::vector<Product> out = products_;
        std::sort(out.begin(), out.end(), [](const Product& a, const Product& b) {
            return std::tie(a.column, a.attachment) < std::tie(b.column, b.attachment);
        });
        return out;
    }

  private:
    std::vector<int> place_; ///< by columns: of the last product, or -1
    std::vector<Product> products_;
    std::vector<double> sum_;
};

} // namespace

void SpringCoupling::make(const Scene& scene, const std::vector<CoupledSpring>& springs) {
    std::vector<int> node_of(scene.numbering().vertex_count(), -1);
    for (const CoupledSpring& s : springs)
        for (const SpringTerm& term : s.terms) node_of[at(term.vertex)] = 0;
    int body = 0;
    for (std::size_t v = 0; v < node_of.size(); ++v) {
        if (node_of[v] < 0) continue;
        const int vertex = static_cast<int>(v);
        while (vertex >= scene.first_vertex(body) + static_cast<int>(scene.vertex_count(body))) ++body;
        node_of[v] = static_cast<int>(nodes_.size());
        nodes_.push_back({vertex, body});
    }

    const Groups groups = groups_of(springs);
    // Where a node stands: group and term, by rising groups and so by rising attachments.
    std::vector<int> place_start, place;
    std::vector<std::pair<int, int>> places;
    for (std::size_t g = 0; g + 1 < groups.start.size(); ++g)
        for (std::size_t i = 0; i < springs[at(groups.of(g).front())].terms.size(); ++i)
            places.emplace_back(static_cast<int>(g), static_cast<int>(i));
    sort_into(nodes_.size(), place_start, place, [&](const auto& visit) {
        for (std::size_t p = 0; p < places.size(); ++p) {
            const CoupledSpring& first = springs[at(groups.of(at(places[p].first)).front())];
            visit(at(node_of[at(first.terms[at(places[p].second)].vertex)]), static_cast<int>(p));
        }
    });
    std::vector<std::vector<Product>> rows(nodes_.size());
    std::vector<std::vector<Load>> row_loads(nodes_.size());
    tbb::enumerable_thread_specific<RowProducts> makers(nodes_.size());
    parallel_for(nodes_.size(), 16, [&](std::size_t node) {
        RowProducts& maker = makers.local();
        maker.begin();
        for (int k = place_start[node]; k < place_start[node + 1]; ++k) {
            const auto [g, i] = places[at(place[at(k)])];
            const std::span<const int> group = groups.of(at(g));
            maker.add(springs, group, at(i), node_of);
            const int attachment = springs[at(group.front())].attachment;
            std::vector<Load>& loads = row_loads[node];
            if (loads.empty() || loads.back().attachment != attachment) loads.push_back({attachment, 0});
            for (const int s : group)
                loads.back().area += springs[at(s)].area_weight * std::abs(springs[at(s)].terms[at(i)].coefficient);
        }
        rows[node] = maker.sorted();
    });

    std::size_t shares = 0;
    for (const std::vector<Product>& row : rows) shares += row.size();
    shares_.reserve(shares);
    for (std::size_t node = 0; node < nodes_.size(); ++node) {
        row_start_.push_back(column_.size());
        int column = -1;
        for (const Product& p : rows[node]) {
            if (p.column != column) {
                column = p.column;
                column_.push_back(column);
                first_share_.push_back(static_cast<int>(shares_.size()));
            }
            shares_.push_back({p.attachment, p.product});
        }
        first_load_.push_back(loads_.size());
        loads_.insert(loads_.end(), row_loads[node].begin(), row_loads[node].end());
    }
    row_start_.push_back(column_.size());
    first_share_.push_back(static_cast<int>(shares_.size()));
    first_load_.push_back(loads_.size());
    for (auto* list : {&column_, &first_share_}) list->shrink_to_fit();
    values_.resize(column_.size());
    square_stiffness_.resize(nodes_.size());
}

void SpringCoupling::add_couplings(std::vector<std::pair<int, int>>& couplings) const {
    for (std::size_t n = 0; n < nodes_.size(); ++n)
        for (std::size_t e = row_start_[n]; e < row_start_[n + 1]; ++e)
            if (at(column_[e]) < n) couplings.emplace_back(nodes_[n].vertex, nodes_[at(column_[e])].vertex);
}

void SpringCoupling::set_pattern(const BlockPattern& pattern, const std::vector<int>& unknown) {
    blocks_.clear();
    for (std::size_t n = 0; n < nodes_.size(); ++n)
        for (std::size_t e = row_start_[n]; e < row_start_[n + 1]; ++e) {
            const int row = unknown[at(nodes_[n].vertex)], column = unknown[at(nodes_[at(column_[e])].vertex)];
            if (row >= 0 && column >= row) blocks_.emplace_back(pattern.find(row, column), static_cast<int>(e));
        }
    blocks_.shrink_to_fit();
}

void SpringCoupling::set_pulls(const std::vector<SpringPull>& pulls) {
    const bool viscous =
        std::any_of(pulls.begin(), pulls.end(), [](const SpringPull& pull) { return pull.viscous != 0; });
    elastic_values_.resize(viscous ? values_.size() : 0);
    parallel_for(values_.size(), 2048, [&](std::size_t e) {
        double elastic = 0, damped = 0;
        for (int i = first_share_[e]; i < first_share_[e + 1]; ++i) {
            elastic += pulls[at(shares_[at(i)].attachment)].stiffness * shares_[at(i)].product;
            damped += pulls[at(shares_[at(i)].attachment)].viscous * shares_[at(i)].product;
        }
        values_[e] = elastic + damped;
        if (viscous) elastic_values_[e] = elastic;
    });
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        square_stiffness_[n] = 0;
        for (std::size_t l = first_load_[n]; l < first_load_[n + 1]; ++l) {
            const double stiffness = pulls[at(loads_[l].attachment)].stiffness * loads_[l].area;
            square_stiffness_[n] += stiffness * stiffness;
        }
    }
}

void SpringCoupling::add_hessian(BlockMatrix& a) const {
    parallel_for(blocks_.size(), 2048, [&](std::size_t b) {
        double* block = a.block(at(blocks_[b].first));
        for (int c = 0; c < 3; ++c) block[4 * c] += values_[at(blocks_[b].second)];
    });
}

void SpringCoupling::add_springs(std::span<double> blocks) const {
    for (const auto& [block, entry] : blocks_) blocks[at(block)] += values_[at(entry)];
}

void SpringCoupling::add_squared_stiffnesses(std::vector<double>& of_body) const {
    for (std::size_t n = 0; n < nodes_.size(); ++n) of_body[at(nodes_[n].body)] += square_stiffness_[n];
}

} // namespace sinew::solver
