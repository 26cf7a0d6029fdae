// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/overlay_smoother.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>

namespace sinew::solver {

namespace {

constexpr std::size_t grain = 128;
/// Patches of fewer rows are not worth a piece of work of their own.
constexpr int least_rows = 48;
/// One sweep each way takes a third more iterations than two, four save a seventh.
constexpr int sweeps = 2;

} // namespace

OverlaySmoother::OverlaySmoother(const RowBlocks& fine)
    : fine_(fine)
    , coupled_place_(at(fine.rows), -1)
    , local_(at(fine.rows), -1)
    , swept_(3 * at(fine.rows))
    , rest_(3 * at(fine.rows)) {}

void OverlaySmoother::find_rows(const std::vector<int>& rows) {
    if (rows == rows_) return;
    constexpr int is_beside = -2;
    for (const RowStrip* strip : {&beside_, &within_})
        for (const int row : strip->rows) coupled_place_[at(row)] = local_[at(row)] = -1;
    rows_ = rows;
    beside_.clear(), within_.clear();
    for (std::size_t k = 0; k < rows_.size(); ++k) coupled_place_[at(rows_[k])] = static_cast<int>(k);
    const auto visit = [&](int row, const auto& with) {
        fine_.for_each_entry(at(row), [&](std::size_t e) { with(static_cast<int>(e), fine_.column[e]); });
    };
    for (const int row : rows_) {
        visit(row, [&](int entry, int column) {
            if (coupled_place_[at(column)] >= 0) return;
            within_.entries.push_back(entry);
            if (coupled_place_[at(column)] == is_beside) return;
            coupled_place_[at(column)] = is_beside;
            visit(column, [&](int back, int j) {
                if (coupled_place_[at(j)] >= 0) beside_.entries.push_back(back);
            });
            beside_.end_row(column);
        });
        within_.end_row(row);
    }
}

/// Rows that the matrix couples, be it through others, are a set. A set is in one patch as a whole; those that come
/// next go into the same one until it has enough rows.
void OverlaySmoother::find_patches(const Overlay& overlay) {
    const std::size_t count = rows_.size();
    sets_.reset(count);
    overlay.visit_couplings([&](int i, int j) { sets_.join(coupled_place_[at(i)], coupled_place_[at(j)]); });
    for (std::size_t k = 0; k < count; ++k)
        for (int e = fine_.lower_start[at(rows_[k])]; e < fine_.lower_start[at(rows_[k]) + 1]; ++e) {
            const int other = coupled_place_[at(fine_.column[at(e)])];
            if (other >= 0) sets_.join(static_cast<int>(k), other);
        }
    rows_at_.assign(count, 0), patch_at_.assign(count, -1);
    for (std::size_t k = 0; k < count; ++k) ++rows_at_[at(sets_.root(static_cast<int>(k)))];
    patch_count_ = 0;
    int missing = 0; // in the last patch
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t root = at(sets_.root(static_cast<int>(k)));
        if (root == k) { // its lowest row
            if (missing <= 0) {
                if (patches_.size() == patch_count_) patches_.emplace_back();
                patches_[patch_count_++].rows.clear();
                missing = least_rows;
            }
            missing -= rows_at_[k];
            patch_at_[k] = static_cast<int>(patch_count_) - 1;
        }
        std::vector<int>& rows = patches_[at(patch_at_[root])].rows;
        local_[at(rows_[k])] = static_cast<int>(rows.size());
        rows.push_back(rows_[k]);
    }
}

bool OverlaySmoother::set_values(const Overlay& overlay) {
    find_rows(overlay.rows());
    find_patches(overlay);
    definite_.resize(patch_count_);
    parallel_for(patch_count_, 1,
                 [&](std::size_t p) { definite_[p] = patches_[p].set_values(fine_, overlay, local_); });
    return std::ranges::find(definite_, 0) == definite_.end();
}

void OverlaySmoother::apply(const Inner& inner, const std::vector<double>& r, std::vector<double>& z) {
    rest_ = r;
    parallel_for(patch_count_, 1, [&](std::size_t p) {
        CoupledPatch& patch = patches_[p];
        const std::size_t count = patch.rows.size();
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t c = 0; c < 3; ++c)
                patch.right[3 * k + c] = static_cast<float>(r[3 * at(patch.rows[k]) + c]);
        patch.start_from_zero();
        for (int s = 0; s < sweeps; ++s) patch.sweep_down(s == 0);
        parallel_for(count, grain, [&](std::size_t k) {
            const Float4 sum = patch.product(k);
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t i = 3 * at(patch.rows[k]) + c;
                rest_[i] -= static_cast<double>(sum[c]), swept_[i] = static_cast<double>(patch.x[3 * k + c]);
            }
        });
    });
    parallel_for(beside_.rows.size(), grain, [&](std::size_t k) {
        const Vec3 p = beside_.product(fine_, k, swept_);
        for (std::size_t c = 0; c < 3; ++c) rest_[3 * at(beside_.rows[k]) + c] -= p[static_cast<Eigen::Index>(c)];
    });
    inner(rest_, z);
    parallel_for(patch_count_, 1, [&](std::size_t p) {
        CoupledPatch& patch = patches_[p];
        const std::size_t count = patch.rows.size();
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t c = 0; c < 3; ++c) {
                double& own = z[3 * at(patch.rows[k]) + c];
                own += swept_[3 * at(patch.rows[k]) + c];
                patch.x[3 * k + c] = static_cast<float>(own);
            }
        parallel_for(count, grain, [&](std::size_t k) {
            const Float4 own = patch.product(k);
            // Rows that are not coupled, so that no patch changes them.
            const Vec3 others = within_.product(fine_, at(coupled_place_[at(patch.rows[k])]), z);
            for (std::size_t c = 0; c < 3; ++c)
                patch.right[3 * k + c] -= own[c] + static_cast<float>(others[static_cast<Eigen::Index>(c)]);
        });
        patch.start_from_zero();
        for (int s = 0; s < sweeps; ++s) patch.sweep_up(s == 0);
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t c = 0; c < 3; ++c) z[3 * at(patch.rows[k]) + c] += static_cast<double>(patch.x[3 * k + c]);
    });
}

} // namespace sinew::solver
