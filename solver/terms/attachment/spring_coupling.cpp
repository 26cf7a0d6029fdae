// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_coupling.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace sinew::solver {

namespace {

/// Springs with the same attachment and vertices, which have the same blocks: places in the list of springs.
std::vector<std::vector<std::size_t>> groups_of(const std::vector<CoupledSpring>& springs) {
    const auto before = [&](std::size_t a, std::size_t b) {
        const CoupledSpring &s = springs[a], &t = springs[b];
        if (s.attachment != t.attachment) return s.attachment < t.attachment;
        return std::lexicographical_compare(s.terms.begin(), s.terms.end(), t.terms.begin(), t.terms.end(),
                                            [](const auto& v, const auto& w) { return v.vertex < w.vertex; });
    };
    std::vector<std::size_t> order(springs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), before);
    std::vector<std::vector<std::size_t>> groups;
    for (const std::size_t s : order) {
        if (groups.empty() || before(groups.back().front(), s)) groups.emplace_back();
        groups.back().push_back(s);
    }
    return groups;
}

} // namespace

void SpringCoupling::make(const Scene& scene, const std::vector<CoupledSpring>& springs) {
    std::vector<int> vertices;
    for (const CoupledSpring& s : springs)
        for (const SpringTerm& term : s.terms) vertices.push_back(term.vertex);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    const auto node_of = [&](int vertex) {
        return static_cast<int>(std::lower_bound(vertices.begin(), vertices.end(), vertex) - vertices.begin());
    };
    int body = 0;
    for (const int v : vertices) {
        while (v >= scene.first_vertex(body) + static_cast<int>(scene.vertex_count(body))) ++body;
        nodes_.push_back({v, body});
    }

    struct Product {
        int row, column, attachment;
        double product;
    };
    std::vector<Product> products;
    std::vector<int> of_term;
    for (const std::vector<std::size_t>& group : groups_of(springs)) {
        const CoupledSpring& first = springs[group.front()];
        of_term.clear();
        for (const SpringTerm& term : first.terms) of_term.push_back(node_of(term.vertex));
        for (std::size_t i = 0; i < of_term.size(); ++i)
            for (std::size_t j = 0; j < of_term.size(); ++j) {
                double sum = 0;
                for (const std::size_t s : group)
                    sum += springs[s].area_weight * springs[s].terms[i].coefficient * springs[s].terms[j].coefficient;
                products.push_back({of_term[i], of_term[j], first.attachment, sum});
            }
    }
    std::stable_sort(products.begin(), products.end(), [](const Product& a, const Product& b) {
        return std::tie(a.row, a.column, a.attachment) < std::tie(b.row, b.column, b.attachment);
    });
    int row = -1, column = -1;
    for (const Product& p : products) {
        const bool is_new = p.row != row || p.column != column;
        for (; row < p.row; ++row) row_start_.push_back(column_.size());
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
    row_start_.push_back(column_.size());
    first_share_.push_back(shares_.size());
    values_.resize(column_.size());
    make_loads(springs, node_of);
}

template <class NodeOf>
void SpringCoupling::make_loads(const std::vector<CoupledSpring>& springs, const NodeOf& node_of) {
    struct At {
        int node;
        Load load;
    };
    std::vector<At> all;
    for (const CoupledSpring& s : springs)
        for (const SpringTerm& term : s.terms)
            all.push_back({node_of(term.vertex), {s.attachment, s.area_weight * std::abs(term.coefficient)}});
    std::stable_sort(all.begin(), all.end(), [](const At& a, const At& b) {
        return std::tie(a.node, a.load.attachment) < std::tie(b.node, b.load.attachment);
    });
    int node = -1;
    for (const At& a : all) {
        const bool is_new = a.node != node;
        for (; node < a.node; ++node) first_load_.push_back(loads_.size());
        if (is_new || loads_.back().attachment != a.load.attachment)
            loads_.push_back(a.load);
        else
            loads_.back().area += a.load.area;
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
