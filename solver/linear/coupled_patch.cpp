// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/coupled_patch.h"

#include "solver/index.h"

#include <algorithm>

namespace sinew::solver {

/// The pattern's entries and the overlay's, in fixed order.
bool CoupledPatch::set_values(const RowBlocks& fine, const Overlay& overlay, const std::vector<int>& local) {
    start_.assign(1, 0), block_.column.clear(), block_.blocks.clear(), diagonal_.clear();
    place_.assign(rows.size(), -1);
    const auto sum_with = [&](int column) -> FloatBlock& {
        int& place = place_[at(column)];
        if (place < 0) {
            place = static_cast<int>(columns_.size());
            columns_.push_back(column), sums_.emplace_back();
        }
        return sums_[at(place)];
    };
    for (std::size_t k = 0; k < rows.size(); ++k) {
        columns_.clear(), sums_.clear();
        fine.for_each_entry(at(rows[k]), [&](std::size_t e) {
            if (const int column = local[at(fine.column[e])]; column >= 0) sum_with(column) = fine.blocks[e];
        });
        overlay.visit_row(rows[k], [&](int column, double factor, const Mat3& block, bool transposed) {
            FloatBlock& sum = sum_with(local[at(column)]);
            for (int c = 0; c < 3; ++c)
                for (int r = 0; r < 3; ++r)
                    sum(r, c) += static_cast<float>(factor * (transposed ? block(c, r) : block(r, c)));
        });
        std::sort(columns_.begin(), columns_.end());
        for (const int column : columns_) {
            if (at(column) == k) diagonal_.push_back(static_cast<int>(block_.blocks.size()));
            block_.column.push_back(column), block_.blocks.push_back(sums_[at(place_[at(column)])]);
            place_[at(column)] = -1;
        }
        start_.push_back(static_cast<int>(block_.blocks.size()));
    }
    right.assign(3 * rows.size() + 1, 0.f), x.assign(3 * rows.size() + 1, 0.f);
    added_.assign(rows.size(), 0.f);
    return invert_diagonal(block_, diagonal_, added_, inverse_);
}

void CoupledPatch::start_from_zero() { std::ranges::fill(x, 0.f); }

/// Makes the residual of a row zero; entries before `begin` and from `end` on find zeros.
void CoupledPatch::relax(std::size_t k, int begin, int end) {
    const Float4 sum = block_.product(begin, end, x.data());
    float left[3];
    for (std::size_t c = 0; c < 3; ++c) left[c] = right[3 * k + c] - sum[c];
    const FloatBlock& b = inverse_[k];
    const Float4 change = b.col(0) * left[0] + b.col(1) * left[1] + b.col(2) * left[2];
    for (std::size_t c = 0; c < 3; ++c) x[3 * k + c] += change[c];
}

void CoupledPatch::sweep_down(bool first) {
    for (std::size_t k = 0; k < rows.size(); ++k) relax(k, start_[k], first ? diagonal_[k] : start_[k + 1]);
}

void CoupledPatch::sweep_up(bool first) {
    for (std::size_t k = rows.size(); k-- > 0;) relax(k, first ? diagonal_[k] + 1 : start_[k], start_[k + 1]);
}

} // namespace sinew::solver
