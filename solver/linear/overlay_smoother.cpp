// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/overlay_smoother.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>

namespace sinew::solver {

namespace {

constexpr std::size_t grain = 256;
/// One sweep each way takes a third more iterations than two, four save a seventh.
constexpr int sweeps = 2;

} // namespace

OverlaySmoother::OverlaySmoother(const RowBlocks& fine)
    : fine_(fine)
    , local_(at(fine.rows), -1)
    , swept_(3 * at(fine.rows))
    , rest_(3 * at(fine.rows)) {}

void OverlaySmoother::find_rows(const std::vector<int>& rows) {
    if (rows == rows_) return;
    constexpr int is_beside = -2;
    for (const RowStrip* strip : {&beside_, &within_})
        for (const int row : strip->rows) local_[at(row)] = -1;
    rows_ = rows;
    beside_.clear(), within_.clear();
    for (std::size_t k = 0; k < rows_.size(); ++k) local_[at(rows_[k])] = static_cast<int>(k);
    const auto visit = [&](int row, const auto& with) {
        fine_.for_each_entry(at(row), [&](std::size_t e) { with(static_cast<int>(e), fine_.column[e]); });
    };
    for (const int row : rows_) {
        visit(row, [&](int entry, int column) {
            if (local_[at(column)] >= 0) return;
            within_.entries.push_back(entry);
            if (local_[at(column)] == is_beside) return;
            local_[at(column)] = is_beside;
            visit(column, [&](int back, int j) {
                if (local_[at(j)] >= 0) beside_.entries.push_back(back);
            });
            beside_.end_row(column);
        });
        within_.end_row(row);
    }
}

/// The coupled rows' block: the pattern's entries and the overlay's, in fixed order.
void OverlaySmoother::gather(const Overlay& overlay) {
    row_start_.assign(1, 0), coupled_.column.clear(), coupled_.blocks.clear(), diagonal_.clear();
    place_.assign(rows_.size(), -1);
    const auto sum_with = [&](int column) -> FloatBlock& {
        int& place = place_[at(column)];
        if (place < 0) {
            place = static_cast<int>(columns_.size());
            columns_.push_back(column), sums_.emplace_back();
        }
        return sums_[at(place)];
    };
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const int row = rows_[k];
        columns_.clear(), sums_.clear();
        fine_.for_each_entry(at(row), [&](std::size_t e) {
            if (const int column = local_[at(fine_.column[e])]; column >= 0) sum_with(column) = fine_.blocks[e];
        });
        overlay.visit_row(row, [&](int column, double factor, const Mat3& block, bool transposed) {
            FloatBlock& sum = sum_with(local_[at(column)]);
            for (int c = 0; c < 3; ++c)
                for (int r = 0; r < 3; ++r)
                    sum(r, c) += static_cast<float>(factor * (transposed ? block(c, r) : block(r, c)));
        });
        std::sort(columns_.begin(), columns_.end());
        for (const int column : columns_) {
            if (at(column) == k) diagonal_.push_back(static_cast<int>(coupled_.blocks.size()));
            coupled_.column.push_back(column), coupled_.blocks.push_back(sums_[at(place_[at(column)])]);
            place_[at(column)] = -1;
        }
        row_start_.push_back(static_cast<int>(coupled_.blocks.size()));
    }
}

bool OverlaySmoother::set_values(const Overlay& overlay) {
    find_rows(overlay.rows());
    gather(overlay);
    right_.assign(3 * rows_.size() + 1, 0.f), x_.assign(3 * rows_.size() + 1, 0.f);
    added_.assign(rows_.size(), 0.f);
    return invert_diagonal(coupled_, diagonal_, added_, inverse_);
}

/// Makes the residual of a row zero.
void OverlaySmoother::relax(std::size_t k) {
    const Float4 sum = coupled_.product(row_start_[k], row_start_[k + 1], x_.data());
    float left[3];
    for (std::size_t c = 0; c < 3; ++c) left[c] = right_[3 * k + c] - sum[c];
    const FloatBlock& b = inverse_[k];
    const Float4 change = b.col(0) * left[0] + b.col(1) * left[1] + b.col(2) * left[2];
    for (std::size_t c = 0; c < 3; ++c) x_[3 * k + c] += change[c];
}

void OverlaySmoother::apply(const Inner& inner, const std::vector<double>& r, std::vector<double>& z) {
    const std::size_t count = rows_.size();
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t c = 0; c < 3; ++c) right_[3 * k + c] = static_cast<float>(r[3 * at(rows_[k]) + c]);
    std::fill(x_.begin(), x_.end(), 0.f);
    for (int s = 0; s < sweeps; ++s)
        for (std::size_t k = 0; k < count; ++k) relax(k);

    rest_ = r;
    parallel_for(count, grain, [&](std::size_t k) {
        const Float4 sum = coupled_.product(row_start_[k], row_start_[k + 1], x_.data());
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t i = 3 * at(rows_[k]) + c;
            rest_[i] -= static_cast<double>(sum[c]), swept_[i] = static_cast<double>(x_[3 * k + c]);
        }
    });
    parallel_for(beside_.rows.size(), grain, [&](std::size_t k) {
        const Vec3 p = beside_.product(fine_, k, swept_);
        for (std::size_t c = 0; c < 3; ++c) rest_[3 * at(beside_.rows[k]) + c] -= p[static_cast<Eigen::Index>(c)];
    });
    inner(rest_, z);
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
            double& own = z[3 * at(rows_[k]) + c];
            own += swept_[3 * at(rows_[k]) + c];
            x_[3 * k + c] = static_cast<float>(own);
        }
    parallel_for(count, grain, [&](std::size_t k) {
        const Float4 own = coupled_.product(row_start_[k], row_start_[k + 1], x_.data());
        const Vec3 others = within_.product(fine_, k, z);
        for (std::size_t c = 0; c < 3; ++c)
            right_[3 * k + c] -= own[c] + static_cast<float>(others[static_cast<Eigen::Index>(c)]);
    });
    std::fill(x_.begin(), x_.end(), 0.f);
    for (int s = 0; s < sweeps; ++s)
        for (std::size_t k = count; k-- > 0;) relax(k);
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t c = 0; c < 3; ++c) z[3 * at(rows_[k]) + c] += static_cast<double>(x_[3 * k + c]);
}

} // namespace sinew::solver
