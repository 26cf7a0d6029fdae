// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_coupling.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <numeric>
#include <tuple>

namespace sinew::solver {

namespace {

std::strong_ordering compare(const CoupledSpring& s, const CoupledSpring& t) {
    if (s.attachment != t.attachment) return s.attachment <=> t.attachment;
    return std::lexicographical_compare_three_way(
        s.terms.begin(), s.terms.end(), t.terms.begin(), t.terms.end(),
        [](const SpringTerm& v, const SpringTerm& w) { return v.vertex <=> w.vertex; });
}

/// A spring and its place in the list of springs.
struct Placed {
    const CoupledSpring* spring;
    std::size_t place;
    friend bool operator<(const Placed& a, const Placed& b) {
        const std::strong_ordering order = compare(*a.spring, *b.spring);
        return order != 0 ? order < 0 : a.place < b.place;
    }
};

/// Springs with the same attachment and vertices, which have the same blocks: places in the list of springs.
std::vector<std::vector<std::size_t>> groups_of(const std::vector<CoupledSpring>& springs) {
    std::vector<Placed> order;
    for (std::size_t s = 0; s < springs.size(); ++s) order.push_back({&springs[s], s});
    parallel_sort(order.begin(), order.end());
    std::vector<std::vector<std::size_t>> groups;
    for (const Placed& p : order) {
        if (groups.empty() || compare(springs[groups.back().front()], *p.spring) != 0) groups.emplace_back();
        groups.back().push_back(p.place);
    }
    return groups;
}

/// What goes to a row, row by row; `visit` calls its argument with (row, value) for each, the same in two calls. Rows
/// are sorted by `before`, what is equal in the order visited.
template <class Value, class Visit, class Before>
std::vector<Value> sorted_rows(std::size_t rows, std::vector<std::size_t>& start, const Visit& visit,
                               const Before& before) {
    start.assign(rows + 1, 0);
    visit([&](int row, const Value&) { ++start[at(row) + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Value> out(start.back());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    visit([&](int row, const Value& value) { out[next[at(row)]++] = value; });
    parallel_for(rows, 16, [&](std::size_t row) {
        std::stable_sort(out.begin() + static_cast<std::ptrdiff_t>(start[row]),
                         out.begin() + static_cast<std::ptrdiff_t>(start[row + 1]), before);
    });
    return out;
}

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

    struct Product {
        int column, attachment;
        double product;
    };
    const std::vector<std::vector<std::size_t>> groups = groups_of(springs);
    std::vector<std::size_t> start;
    const std::vector<Product> products = sorted_rows<Product>(
        nodes_.size(), start,
        [&](const auto& visit) {
            for (const std::vector<std::size_t>& group : groups) {
                const CoupledSpring& first = springs[group.front()];
                for (std::size_t i = 0; i < first.terms.size(); ++i)
                    for (std::size_t j = 0; j < first.terms.size(); ++j) {
                        double sum = 0;
                        for (const std::size_t s : group)
                            sum += springs[s].area_weight * springs[s].terms[i].coefficient *
                                   springs[s].terms[j].coefficient;
                        visit(node_of[at(first.terms[i].vertex)],
                              Product{node_of[at(first.terms[j].vertex)], first.attachment, sum});
                    }
            }
        },
        [](const Product& a, const Product& b) {
            return std::tie(a.column, a.attachment) < std::tie(b.column, b.attachment);
        });
    for (std::size_t row = 0; row < nodes_.size(); ++row) {
        row_start_.push_back(column_.size());
        int column = -1;
        for (std::size_t k = start[row]; k < start[row + 1]; ++k) {
            const Product& p = products[k];
            const bool is_new = p.column != column;
            if (is_new) {
                column = p.column;
                column_.push_back(column);
                first_share_.push_back(shares_.size());
            }
            if (is_new || shares_.back().attachment != p.attachment)
                shares_.push_back({p.attachment, p.product});
            else
                shares_.back().product += p.product;
        }
    }
    row_start_.push_back(column_.size());
    first_share_.push_back(shares_.size());
    values_.resize(column_.size());
    make_loads(springs, node_of);
}

void SpringCoupling::make_loads(const std::vector<CoupledSpring>& springs, const std::vector<int>& node_of) {
    std::vector<std::size_t> start;
    const std::vector<Load> all = sorted_rows<Load>(
        nodes_.size(), start,
        [&](const auto& visit) {
            for (const CoupledSpring& s : springs)
                for (const SpringTerm& term : s.terms)
                    visit(node_of[at(term.vertex)], Load{s.attachment, s.area_weight * std::abs(term.coefficient)});
        },
        [](const Load& a, const Load& b) { return a.attachment < b.attachment; });
    for (std::size_t node = 0; node < nodes_.size(); ++node) {
        first_load_.push_back(loads_.size());
        for (std::size_t k = start[node]; k < start[node + 1]; ++k)
            if (k == start[node] || loads_.back().attachment != all[k].attachment)
                loads_.push_back(all[k]);
            else
                loads_.back().area += all[k].area;
    }
    first_load_.push_back(loads_.size());
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
            if (row >= 0 && column >= row) blocks_.emplace_back(pattern.find(row, column), e);
        }
}

void SpringCoupling::set_pulls(const std::vector<SpringPull>& pulls) {
    const bool viscous =
        std::any_of(pulls.begin(), pulls.end(), [](const SpringPull& pull) { return pull.viscous != 0; });
    elastic_values_.resize(viscous ? values_.size() : 0);
    parallel_for(values_.size(), 2048, [&](std::size_t e) {
        double elastic = 0, damped = 0;
        for (std::size_t i = first_share_[e]; i < first_share_[e + 1]; ++i) {
            elastic += pulls[at(shares_[i].attachment)].stiffness * shares_[i].product;
            damped += pulls[at(shares_[i].attachment)].viscous * shares_[i].product;
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
        for (int c = 0; c < 3; ++c) block[4 * c] += values_[blocks_[b].second];
    });
}

void SpringCoupling::add_springs(std::span<double> blocks) const {
    for (const auto& [block, entry] : blocks_) blocks[at(block)] += values_[entry];
}

void SpringCoupling::add_squared_stiffnesses(std::vector<double>& of_body) const {
    for (std::size_t n = 0; n < nodes_.size(); ++n) of_body[at(nodes_[n].body)] += square_stiffness_[n];
}

} // namespace sinew::solver
