// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_coupling.h"

#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/sort_into.h"

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

/// By rows, and in each by `before`, what is equal as it came; `start`: of each row, and one past the end.
template <class Value, class Before>
std::vector<Value> sorted_rows(std::size_t rows, const std::vector<int>& row_of, const std::vector<Value>& values,
                               std::vector<int>& start, const Before& before) {
    std::vector<int> order;
    sort_into(rows, start, order, [&](const auto& visit) {
        for (std::size_t k = 0; k < values.size(); ++k) visit(at(row_of[k]), static_cast<int>(k));
    });
    std::vector<Value> out(values.size());
    parallel_for(rows, 16, [&](std::size_t row) {
        const auto first = out.begin() + start[row], end = out.begin() + start[row + 1];
        std::transform(order.begin() + start[row], order.begin() + start[row + 1], first,
                       [&](int k) { return values[at(k)]; });
        std::stable_sort(first, end, before);
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
    std::vector<int> row_of;
    std::vector<Product> unsorted;
    for (const std::vector<std::size_t>& group : groups_of(springs)) {
        const CoupledSpring& first = springs[group.front()];
        for (std::size_t i = 0; i < first.terms.size(); ++i)
            for (std::size_t j = 0; j < first.terms.size(); ++j) {
                double sum = 0;
                for (const std::size_t s : group)
                    sum += springs[s].area_weight * springs[s].terms[i].coefficient * springs[s].terms[j].coefficient;
                row_of.push_back(node_of[at(first.terms[i].vertex)]);
                unsorted.push_back({node_of[at(first.terms[j].vertex)], first.attachment, sum});
            }
    }
    std::vector<int> start;
    const std::vector<Product> products =
        sorted_rows(nodes_.size(), row_of, unsorted, start, [](const Product& a, const Product& b) {
            return std::tie(a.column, a.attachment) < std::tie(b.column, b.attachment);
        });
    for (std::size_t row = 0; row < nodes_.size(); ++row) {
        row_start_.push_back(column_.size());
        int column = -1;
        for (int k = start[row]; k < start[row + 1]; ++k) {
            const Product& p = products[at(k)];
            const bool is_new = p.column != column;
            if (is_new) {
                column = p.column;
                column_.push_back(column);
                first_share_.push_back(static_cast<int>(shares_.size()));
            }
            if (is_new || shares_.back().attachment != p.attachment)
                shares_.push_back({p.attachment, p.product});
            else
                shares_.back().product += p.product;
        }
    }
    row_start_.push_back(column_.size());
    first_share_.push_back(static_cast<int>(shares_.size()));
    for (auto* list : {&column_, &first_share_}) list->shrink_to_fit();
    shares_.shrink_to_fit();
    values_.resize(column_.size());
    make_loads(springs, node_of);
}

void SpringCoupling::make_loads(const std::vector<CoupledSpring>& springs, const std::vector<int>& node_of) {
    std::vector<int> row_of, start;
    std::vector<Load> unsorted;
    for (const CoupledSpring& s : springs)
        for (const SpringTerm& term : s.terms) {
            row_of.push_back(node_of[at(term.vertex)]);
            unsorted.push_back({s.attachment, s.area_weight * std::abs(term.coefficient)});
        }
    const std::vector<Load> all = sorted_rows(nodes_.size(), row_of, unsorted, start,
                                              [](const Load& a, const Load& b) { return a.attachment < b.attachment; });
    for (std::size_t node = 0; node < nodes_.size(); ++node) {
        first_load_.push_back(loads_.size());
        for (int k = start[node]; k < start[node + 1]; ++k)
            if (const Load& load = all[at(k)]; k == start[node] || loads_.back().attachment != load.attachment)
                loads_.push_back(load);
            else
                loads_.back().area += load.area;
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
