// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_coupling.h"

#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/sort_into.h"

#include <algorithm>
#include <cmath>
#include <tbb/enumerable_thread_specific.h>
#include <tuple>

namespace sinew::solver {

namespace {

/// What one attachment's springs, or patches, make between a node and another.
struct Product {
    int column, pull; ///< `pull`: as the stage's stiffnesses are numbered
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

    /// Adds what a bundle's springs make between its vertex `own` and all of them; attachments must not fall.
    void add(const SpringBundles& bundles, std::size_t bundle, std::size_t own, const std::vector<int>& node_of) {
        const std::span<const int> vertices = bundles.vertices(bundle);
        sum_.assign(vertices.size(), 0);
        bundles.for_each_spring(bundle, [&](const SpringBundles::Spring& s) {
            const double weight = s.area_weight * s.coefficients[own];
            for (std::size_t j = 0; j < vertices.size(); ++j) sum_[j] += weight * s.coefficients[j];
        });
        for (std::size_t j = 0; j < vertices.size(); ++j)
            add(node_of[at(vertices[j])], bundles.attachment(bundle), sum_[j]);
    }

    /// Adds what a patch makes between a vertex that it pulls by `own` [m^2] and all of its vertices. `pull` rises, and
    /// is above those of bundles.
    void add(const SpringPatches& patches, std::size_t patch, double own, int pull, const std::vector<int>& node_of) {
        for (const SpringPatches::Pull& p : patches.pulls(patch))
            add(node_of[at(p.vertex)], pull, own * p.area / patches.area(patch));
    }

    /// By columns, and in each by pulls.
    std::vector<Product> sorted() const {
        std::vector<Product> out = products_;
        std::sort(out.begin(), out.end(), [](const Product& a, const Product& b) {
            return std::tie(a.column, a.pull) < std::tie(b.column, b.pull);
        });
        return out;
    }

  private:
    void add(int column, int pull, double product) {
        int& place = place_[at(column)];
        if (place < 0 || products_[at(place)].pull != pull) {
            place = static_cast<int>(products_.size());
            products_.push_back({column, pull, 0});
        }
        products_[at(place)].product += product;
    }

    std::vector<int> place_; ///< by columns: of the last product, or -1
    std::vector<Product> products_;
    std::vector<double> sum_;
};

} // namespace

void SpringCoupling::make(const Scene& scene, const SpringBundles& bundles, const SpringPatches& patches) {
    std::vector<int> node_of(scene.numbering().vertex_count(), -1);
    for (std::size_t b = 0; b < bundles.count(); ++b)
        for (const int vertex : bundles.vertices(b)) node_of[at(vertex)] = 0;
    int body = 0;
    for (std::size_t v = 0; v < node_of.size(); ++v) {
        if (node_of[v] < 0) continue;
        const int vertex = static_cast<int>(v);
        while (vertex >= scene.first_vertex(body) + static_cast<int>(scene.vertex_count(body))) ++body;
        node_of[v] = static_cast<int>(nodes_.size());
        nodes_.push_back({vertex, body});
    }

    find_places(bundles, node_of);
    std::vector<std::vector<std::pair<int, double>>> patches_of(nodes_.size()); // and how each pulls there
    for (std::size_t p = 0; p < patches.count(); ++p)
        for (const SpringPatches::Pull& pull : patches.pulls(p))
            patches_of[at(node_of[at(pull.vertex)])].emplace_back(static_cast<int>(p), pull.area);
    const int attachments = static_cast<int>(scene.description().attachments.size());
    std::vector<std::vector<Product>> rows(nodes_.size());
    std::vector<std::vector<Load>> row_loads(nodes_.size());
    tbb::enumerable_thread_specific<RowProducts> makers(nodes_.size());
    parallel_for(nodes_.size(), 16, [&](std::size_t node) {
        RowProducts& maker = makers.local();
        maker.begin();
        for (const auto& [b, i] : places(node)) {
            maker.add(bundles, at(b), at(i), node_of);
            const int attachment = bundles.attachment(at(b));
            std::vector<Load>& loads = row_loads[node];
            if (loads.empty() || loads.back().attachment != attachment) loads.push_back({attachment, 0});
            bundles.for_each_spring(at(b), [&, own = at(i)](const SpringBundles::Spring& s) {
                loads.back().area += s.area_weight * std::abs(s.coefficients[own]);
            });
        }
        for (const auto& [p, own] : patches_of[node])
            maker.add(patches, at(p), own, attachments + patches.attachment(at(p)), node_of);
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
            shares_.push_back({p.pull, p.product});
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

void SpringCoupling::find_places(const SpringBundles& bundles, const std::vector<int>& node_of) {
    std::vector<Place> all;
    for (std::size_t b = 0; b < bundles.count(); ++b)
        for (std::size_t i = 0; i < bundles.vertices(b).size(); ++i)
            all.push_back({static_cast<int>(b), static_cast<int>(i)});
    std::vector<int> order;
    sort_into(nodes_.size(), first_place_, order, [&](const auto& visit) {
        for (std::size_t p = 0; p < all.size(); ++p)
            visit(at(node_of[at(bundles.vertices(at(all[p].bundle))[at(all[p].vertex)])]), static_cast<int>(p));
    });
    places_.reserve(all.size());
    for (const int p : order) places_.push_back(all[at(p)]);
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
            elastic += pulls[at(shares_[at(i)].pull)].stiffness * shares_[at(i)].product;
            damped += pulls[at(shares_[at(i)].pull)].viscous * shares_[at(i)].product;
        }
        values_[e] = elastic + damped;
        if (viscous) elastic_values_[e] = elastic;
    });
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        square_stiffness_[n] = 0;
        for (std::size_t l = first_load_[n]; l < first_load_[n + 1]; ++l) {
            const auto attachment = at(loads_[l].attachment);
            const double stiffness =
                (pulls[attachment].stiffness + pulls[pulls.size() / 2 + attachment].stiffness) * loads_[l].area;
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
