// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/held_block.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>

namespace sinew::solver {

namespace {

constexpr std::size_t strip_grain = 256;

std::vector<int> held_rows_of(const HeldRows& held) {
    std::vector<int> out;
    for (std::size_t i = 0; i < held.rows.size(); ++i)
        if (held.rows[i] != Held::no) out.push_back(static_cast<int>(i));
    return out;
}

HeldPart part_of(const BlockPattern& pattern, const HeldRows& held) {
    HeldPart out;
    out.rows = held_rows_of(held);
    std::vector<int> local(at(pattern.rows), -1);
    for (std::size_t k = 0; k < out.rows.size(); ++k) local[at(out.rows[k])] = static_cast<int>(k);
    std::vector<std::pair<int, int>> couplings;
    for (const int i : out.rows)
        for (int e = pattern.row_start[at(i)]; e < pattern.row_start[at(i) + 1]; ++e) {
            const int j = local[at(pattern.column[at(e)])];
            if (j < 0) continue;
            couplings.emplace_back(local[at(i)], j);
            out.source.push_back(e); // rows and columns come sorted, as make_pattern keeps them
        }
    out.pattern = make_pattern(static_cast<int>(out.rows.size()), couplings);
    return out;
}

} // namespace

LinearCosts held_costs(const BlockPattern& pattern, const HeldRows& held) {
    if (held.rows.empty()) return {};
    return linear_costs(part_of(pattern, held).pattern);
}

HeldBlock::HeldBlock(const BlockPattern& pattern, const RowBlocks& fine, const HeldRows& held)
    : fine_(fine)
    , part_(part_of(pattern, held))
    , matrix_(part_.pattern)
    , factors_(part_.pattern, Factoring::single) {
    for (int i = 0; i < fine.rows; ++i) {
        const bool is_held = held.rows[at(i)] != Held::no;
        RowStrip& strip = is_held ? within_ : beside_;
        fine.for_each_entry(at(i), [&](std::size_t e) {
            const Held column = held.rows[at(fine.column[e])];
            if (is_held ? column != Held::pinned : column != Held::no) strip.entries.push_back(static_cast<int>(e));
        });
        if (is_held || at(strip.start.back()) != strip.entries.size()) strip.end_row(i);
    }
    in_.resize(3 * part_.rows.size()), out_.resize(in_.size());
    held_.resize(3 * at(fine.rows)), rest_.resize(held_.size());
}

bool HeldBlock::set_values(const BlockMatrix& a) {
    parallel_for(part_.source.size(), 1024,
                 [&](std::size_t k) { std::copy_n(a.block(at(part_.source[k])), 9, matrix_.block(k)); });
    return factors_.factorize(matrix_);
}

void HeldBlock::apply(Multigrid& cycle, const std::vector<double>& r, std::vector<double>& z) {
    for (std::size_t k = 0; k < part_.rows.size(); ++k)
        std::copy_n(r.data() + 3 * at(part_.rows[k]), 3, in_.data() + 3 * k);
    factors_.solve(in_.data(), out_.data());
    rest_ = r;
    for (std::size_t k = 0; k < part_.rows.size(); ++k) {
        std::copy_n(out_.data() + 3 * k, 3, held_.data() + 3 * at(part_.rows[k]));
        std::fill_n(rest_.data() + 3 * at(part_.rows[k]), 3, 0.0); // solved
    }
    parallel_for(beside_.rows.size(), strip_grain, [&](std::size_t k) {
        const Vec3 p = beside_.product(fine_, k, held_);
        for (std::size_t c = 0; c < 3; ++c) rest_[3 * at(beside_.rows[k]) + c] -= p[static_cast<Eigen::Index>(c)];
    });
    cycle.apply(rest_, z);
    parallel_for(part_.rows.size(), strip_grain, [&](std::size_t k) {
        const Vec3 p = within_.product(fine_, k, z);
        for (std::size_t c = 0; c < 3; ++c) in_[3 * k + c] = -p[static_cast<Eigen::Index>(c)];
    });
    std::vector<double>& again = out_;
    factors_.solve(in_.data(), again.data());
    for (std::size_t k = 0; k < part_.rows.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t i = 3 * at(part_.rows[k]) + c;
            z[i] += held_[i] + again[3 * k + c];
        }
}

} // namespace sinew::solver
