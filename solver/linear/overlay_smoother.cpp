// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/overlay_smoother.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace sinew::solver {

namespace {

constexpr std::size_t grain = 256;
/// One sweep each way takes a third more iterations, four save a seventh.
constexpr int sweeps = 2;

FloatBlock in_columns(const Mat3& m) {
    FloatBlock out{};
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) out.column[c][r] = static_cast<float>(m(r, c));
    return out;
}

Mat3 in_double(const FloatBlock& b) {
    Mat3 out;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) out(r, c) = static_cast<double>(b.column[c][r]);
    return out;
}

} // namespace

OverlaySmoother::OverlaySmoother(const RowBlocks& fine)
    : fine_(fine)
    , local_(at(fine.rows), -1)
    , seen_(at(fine.rows), 0)
    , rest_(3 * at(fine.rows)) {
    gathered_.place.assign(at(fine.rows), -1);
}

void OverlaySmoother::find_rows(const std::vector<int>& rows) {
    if (rows == rows_) return;
    for (const int row : rows_) local_[at(row)] = -1;
    for (const int row : beside_) seen_[at(row)] = 0;
    rows_ = rows, beside_.clear();
    for (std::size_t k = 0; k < rows_.size(); ++k) local_[at(rows_[k])] = static_cast<int>(k);
    for (const int row : rows_)
        for (int e = fine_.row_start[at(row)]; e < fine_.row_start[at(row) + 1]; ++e) {
            const int other = fine_.column[at(e)];
            if (local_[at(other)] >= 0 || seen_[at(other)]) continue;
            seen_[at(other)] = 1;
            beside_.push_back(other);
        }
}

/// The coupled rows' block: the pattern's entries and the overlay's, in fixed order.
void OverlaySmoother::gather(const Overlay& overlay) {
    start_.assign(1, 0), column_.clear(), blocks_.clear();
    Gathered& g = gathered_;
    for (const int row : rows_) {
        g.columns.clear(), g.blocks.clear();
        const auto block_with = [&](int column) -> Mat3& {
            int& place = g.place[at(column)];
            if (place < 0) {
                place = static_cast<int>(g.columns.size());
                g.columns.push_back(column), g.blocks.push_back(Mat3::Zero());
            }
            return g.blocks[at(place)];
        };
        for (int e = fine_.row_start[at(row)]; e < fine_.row_start[at(row) + 1]; ++e)
            if (const int column = local_[at(fine_.column[at(e)])]; column >= 0)
                block_with(column) += in_double(fine_.blocks[at(e)]);
        overlay.visit_row(row, [&](int column, double factor, const Mat3& block, bool transposed) {
            Mat3& to = block_with(local_[at(column)]);
            if (transposed)
                to += factor * block.transpose();
            else
                to += factor * block;
        });
        for (std::size_t i = 0; i < g.columns.size(); ++i) {
            g.place[at(g.columns[i])] = -1;
            column_.push_back(g.columns[i]), blocks_.push_back(in_columns(g.blocks[i]));
        }
        start_.push_back(static_cast<int>(column_.size()));
    }
}

bool OverlaySmoother::set_values(const Overlay& overlay) {
    find_rows(overlay.rows());
    gather(overlay);
    inverse_.resize(rows_.size());
    right_.assign(3 * rows_.size() + 1, 0.f), x_.assign(3 * rows_.size() + 1, 0.f);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        Mat3 diagonal = Mat3::Zero();
        for (int e = start_[k]; e < start_[k + 1]; ++e)
            if (at(column_[at(e)]) == k) diagonal = in_double(blocks_[at(e)]);
        const Eigen::LLT<Mat3> factor(diagonal);
        if (factor.info() != Eigen::Success) return false;
        inverse_[k] = in_columns(factor.solve(Mat3::Identity()));
    }
    return true;
}

Float4 OverlaySmoother::coupled(std::size_t k, const float* x) const {
    Float4 sum = {0, 0, 0, 0};
    for (int e = start_[k]; e < start_[k + 1]; ++e) {
        const FloatBlock& b = blocks_[at(e)];
        const float* v = x + 3 * at(column_[at(e)]);
        sum += b.col(0) * v[0] + b.col(1) * v[1] + b.col(2) * v[2];
    }
    return sum;
}

/// Of a row, over the columns that are coupled, or all others.
Vec3 OverlaySmoother::fine_product(std::size_t row, bool inside, const std::vector<double>& x) const {
    Float4 sum = {0, 0, 0, 0};
    for (int e = fine_.row_start[row]; e < fine_.row_start[row + 1]; ++e) {
        const std::size_t column = at(fine_.column[at(e)]);
        if ((local_[column] >= 0) != inside) continue;
        const FloatBlock& b = fine_.blocks[at(e)];
        const float* own = inside ? x_.data() + 3 * at(local_[column]) : nullptr;
        const double* all = x.data() + 3 * column;
        const auto v = [&](std::size_t c) { return inside ? own[c] : static_cast<float>(all[c]); };
        sum += b.col(0) * v(0) + b.col(1) * v(1) + b.col(2) * v(2);
    }
    return {sum[0], sum[1], sum[2]};
}

/// Makes the residual of a row zero.
void OverlaySmoother::relax(std::size_t k) {
    const Float4 sum = coupled(k, x_.data());
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
        const Float4 sum = coupled(k, x_.data());
        for (std::size_t c = 0; c < 3; ++c) rest_[3 * at(rows_[k]) + c] -= static_cast<double>(sum[c]);
    });
    parallel_for(beside_.size(), grain, [&](std::size_t k) {
        const Vec3 p = fine_product(at(beside_[k]), true, r);
        for (std::size_t c = 0; c < 3; ++c) rest_[3 * at(beside_[k]) + c] -= p[static_cast<Eigen::Index>(c)];
    });
    inner(rest_, z);
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
            double& own = z[3 * at(rows_[k]) + c];
            own += static_cast<double>(x_[3 * k + c]);
            x_[3 * k + c] = static_cast<float>(own);
        }
    parallel_for(count, grain, [&](std::size_t k) {
        const Float4 own = coupled(k, x_.data());
        const Vec3 others = fine_product(at(rows_[k]), false, z);
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
