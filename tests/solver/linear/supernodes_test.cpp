// Which blocks a factor has, against elimination of the pattern one row after another.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/supernodes.h"
#include "tests/support/grid_matrix.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

using namespace sinew::solver;
using namespace sinew::test;

TEST_CASE("supernodes hold all that elimination fills in, in an order of every row once", "[linear]") {
    const GridMatrix grid(7);
    const Supernodes s = find_supernodes(grid.pattern);
    const auto n = std::size_t(grid.pattern.rows);
    std::vector<int> place(n, -1);
    for (std::size_t k = 0; k < n; ++k) place[std::size_t(s.order[k])] = static_cast<int>(k);
    CHECK(std::count(place.begin(), place.end(), -1) == 0);
    // Below each column the rows that elimination reaches: those of the pattern, and those of columns eliminated
    // before.
    std::vector<std::set<int>> below(n);
    for (std::size_t i = 0; i < n; ++i)
        for (int e = grid.pattern.row_start[i] + 1; e < grid.pattern.row_start[i + 1]; ++e) {
            const int p = place[i], q = place[std::size_t(grid.pattern.column[std::size_t(e)])];
            below[std::size_t(std::min(p, q))].insert(std::max(p, q));
        }
    double operations = 0;
    std::size_t entries = 0;
    for (std::size_t k = 0; k < n; ++k) {
        if (!below[k].empty()) {
            const auto next = std::size_t(*below[k].begin());
            for (const int r : below[k])
                if (std::size_t(r) != next) below[next].insert(r);
        }
        entries += below[k].size() + 1;
        for (int c = 0; c < 3; ++c) {
            const double numbers = 3.0 * double(below[k].size() + 1) - c;
            operations += numbers * numbers;
        }
    }
    CHECK(s.operations == operations);
    std::size_t held = 0;
    int first = 0;
    for (const Supernode& node : s.nodes) {
        CHECK(node.first == first);
        first += node.width;
        const auto begin = s.rows.begin() + std::ptrdiff_t(node.row_start), end = begin + node.rows;
        CHECK(std::is_sorted(begin, end));
        for (int c = 0; c < node.width; ++c) {
            CHECK(*(begin + c) == node.first + c);
            for (const int r : below[std::size_t(node.first + c)]) CHECK(std::binary_search(begin, end, r));
            held += std::size_t(node.rows - c);
        }
        CHECK(node.rows <= s.most_rows);
    }
    CHECK(first == grid.pattern.rows);
    // Supernodes that are joined hold some zeros besides.
    CHECK(held >= entries);
    CHECK(double(held) < 1.4 * double(entries));
}
