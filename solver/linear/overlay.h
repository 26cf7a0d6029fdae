// Couplings that come and go, such as of what touches: the part of a symmetric matrix that lies outside of its pattern.
// Products know it; factors and grids are made without it, so that nothing is analysed anew where contacts change.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace sinew::solver {

/// A sum of elements. Each has four corners, a corner is a place that rows carry in shares: with u_c = sum of weight x
/// row over the carriers of corner c, an element is the form sum over c, d of u_c^T H_cd u_d.
class Overlay {
  public:
    static constexpr std::size_t corners = 4;
    /// H by corners (0,0), (0,1) … (0,3), (1,1) … (3,3).
    using Blocks = std::array<Mat3, 10>;
    struct Carrier {
        int corner, row;
        double weight;
    };
    /// Place of a pair of corners i <= j among the blocks.
    static std::size_t block_of(int i, int j) { return static_cast<std::size_t>(4 * i - i * (i - 1) / 2 + (j - i)); }

    void clear();
    void add(std::span<const Carrier> carriers, const Blocks& blocks);
    /// An element of which only H between corner 0 and the others is not zero: those of corners 1 to 3.
    void add_across(std::span<const Carrier> carriers, const std::array<Mat3, 3>& blocks);
    /// Rows whose flag is set, one a row, are moved by nothing: takes what elements have in them away, and elements
    /// of which nothing is left. Before finish.
    void hold(const std::vector<char>& rows);
    /// After the last element: sorts them by rows.
    void finish(int rows);
    bool empty() const { return elements_.empty(); }
    /// After finish: those that elements couple, ascending.
    const std::vector<int>& rows() const { return rows_; }
    /// After finish, for one of rows(): calls visit(column, factor, block, transposed) for what its elements add to its
    /// block with each column; a column may come several times.
    template <class Visit>
    void visit_row(int row, const Visit& visit) const;
    /// After finish: calls visit(row, other) for each element's first row with each of its rows.
    template <class Visit>
    void visit_couplings(const Visit& visit) const;
    /// y += O x, 3 numbers a row; the same bits for any number of threads.
    void add_product(const double* x, double* y) const;

  private:
    struct Element {
        std::size_t first_carrier, first_block;
        bool across; ///< 3 blocks, else 10
    };
    bool couples(const Element& element, const std::array<bool, corners>& moves) const;
    void add_element(std::span<const Carrier> carriers, std::span<const Mat3> blocks, bool across);

    std::vector<Element> elements_;           ///< one more after finish
    std::vector<Mat3> blocks_;                ///< of all elements
    std::vector<Carrier> carriers_;           ///< likewise
    std::vector<int> start_, entries_, next_; ///< per row, of carriers_
    std::vector<int> element_;                ///< per carrier
    std::vector<int> rows_;                   ///< that have entries
    mutable std::vector<std::array<Vec3, corners>> forces_;
};

template <class Visit>
void Overlay::visit_couplings(const Visit& visit) const {
    for (std::size_t i = 0; i < carriers_.size(); ++i)
        visit(carriers_[elements_[static_cast<std::size_t>(element_[i])].first_carrier].row, carriers_[i].row);
}

template <class Visit>
void Overlay::visit_row(int row, const Visit& visit) const {
    for (int k = start_[static_cast<std::size_t>(row)]; k < start_[static_cast<std::size_t>(row) + 1]; ++k) {
        const auto entry = static_cast<std::size_t>(entries_[static_cast<std::size_t>(k)]);
        const auto element = static_cast<std::size_t>(element_[entry]);
        const Element& e = elements_[element];
        const Carrier& own = carriers_[entry];
        for (std::size_t i = e.first_carrier; i < elements_[element + 1].first_carrier; ++i) {
            const Carrier& other = carriers_[i];
            const int low = std::min(own.corner, other.corner), high = std::max(own.corner, other.corner);
            if (e.across && (low > 0 || high == 0)) continue;
            const std::size_t block = e.across ? static_cast<std::size_t>(high - 1) : block_of(low, high);
            visit(other.row, own.weight * other.weight, blocks_[e.first_block + block], own.corner > other.corner);
        }
    }
}

} // namespace sinew::solver
