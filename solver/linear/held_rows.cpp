// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/held_rows.h"

#include "solver/index.h"

#include <algorithm>

namespace sinew::solver {

namespace {

/// What ties an unknown to another body [N/m].
struct Tie {
    int row, body;
    double stiffness;
};

/// Sorted by unknowns, then by bodies, each pair once.
std::vector<Tie> ties_of(const BlockPattern& pattern, std::span<const double> springs, const std::vector<int>& body) {
    std::vector<Tie> all;
    for (std::size_t i = 0; i < at(pattern.rows); ++i)
        for (int e = pattern.row_start[i] + 1; e < pattern.row_start[i + 1]; ++e) {
            const std::size_t j = at(pattern.column[at(e)]);
            if (body[i] == body[j] || !(springs[at(e)] < 0)) continue;
            all.push_back({static_cast<int>(i), body[j], -springs[at(e)]});
            all.push_back({static_cast<int>(j), body[i], -springs[at(e)]});
        }
    std::stable_sort(all.begin(), all.end(),
                     [](const Tie& a, const Tie& b) { return a.row != b.row ? a.row < b.row : a.body < b.body; });
    std::vector<Tie> out;
    for (const Tie& t : all)
        if (!out.empty() && out.back().row == t.row && out.back().body == t.body)
            out.back().stiffness += t.stiffness;
        else
            out.push_back(t);
    return out;
}

} // namespace

HeldRows find_held_rows(const BlockPattern& pattern, std::span<const double> springs, std::span<const double> elastic,
                        const UnknownPlaces& places) {
    if (std::ranges::none_of(springs, [](double k) { return k > 0; })) return {};
    const std::size_t n = at(pattern.rows);
    // A row of springs between unknowns sums to zero; what is left goes to bones.
    std::vector<double> to_fixed(n, 0.0), to_others(n, 0.0);
    for (std::size_t i = 0; i < n; ++i)
        for (int e = pattern.row_start[i]; e < pattern.row_start[i + 1]; ++e) {
            const std::size_t j = at(pattern.column[at(e)]);
            to_fixed[i] += springs[at(e)];
            if (j != i) to_fixed[j] += springs[at(e)];
        }
    const std::vector<Tie> ties = ties_of(pattern, springs, places.body);
    for (const Tie& t : ties) to_others[at(t.row)] += t.stiffness;

    HeldRows out;
    std::vector<double> tied(places.spacing.size(), 0.0), count(places.spacing.size(), 0.0);
    bool any = false;
    out.rows.assign(n, Held::no);
    for (std::size_t i = 0; i < n; ++i) {
        if (to_fixed[i] > elastic[i])
            out.rows[i] = Held::pinned;
        else if (to_others[i] > elastic[i])
            out.rows[i] = Held::tied;
        any = any || out.rows[i] != Held::no;
        tied[at(places.body[i])] += out.rows[i] == Held::tied;
        ++count[at(places.body[i])];
    }
    if (!any) return {};
    for (std::size_t k = 0; k < tied.size(); ++k) tied[k] /= std::max(count[k], 1.0);
    // The body of which more is tied leads: a tendon's grid carries the ends of the heads that pull at it.
    out.grid_of = places.body;
    for (std::size_t t = 0; t < ties.size();) {
        const int row = ties[t].row;
        std::size_t best = t;
        for (; t < ties.size() && ties[t].row == row; ++t)
            if (ties[t].stiffness > ties[best].stiffness) best = t;
        const int own = places.body[at(row)], other = ties[best].body;
        const bool leads = tied[at(other)] != tied[at(own)] ? tied[at(other)] > tied[at(own)] : other < own;
        if (out.rows[at(row)] == Held::tied && leads) out.grid_of[at(row)] = other;
    }
    return out;
}

} // namespace sinew::solver
