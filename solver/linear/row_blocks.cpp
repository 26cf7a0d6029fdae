// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/row_blocks.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <Eigen/Cholesky>
#include <atomic>

namespace sinew::solver {

RowBlocks make_row_blocks(const BlockPattern& pattern, std::vector<int>& source) {
    RowBlocks out;
    out.rows = pattern.rows;
    const std::size_t n = at(pattern.rows), count = 2 * pattern.block_count() - n;
    out.column.reserve(count);
    source.clear();
    source.reserve(count);
    out.lower_start.reserve(n + 1), out.upper_start.reserve(n + 1);
    for (std::size_t i = 0; i < n; ++i) {
        out.lower_start.push_back(static_cast<int>(out.column.size()));
        for (int e = pattern.lower_start[i]; e < pattern.lower_start[i + 1]; ++e) {
            const auto [index, column] = pattern.lower[at(e)];
            out.column.push_back(column);
            source.push_back(-index - 1);
        }
    }
    out.lower_start.push_back(static_cast<int>(out.column.size()));
    for (std::size_t i = 0; i < n; ++i) {
        out.upper_start.push_back(static_cast<int>(out.column.size()));
        for (int e = pattern.row_start[i]; e < pattern.row_start[i + 1]; ++e) {
            out.column.push_back(pattern.column[at(e)]);
            source.push_back(e);
        }
    }
    out.upper_start.push_back(static_cast<int>(out.column.size()));
    out.blocks.resize(out.column.size());
    return out;
}

void copy_blocks(const BlockMatrix& a, const std::vector<int>& source, RowBlocks& out,
                 std::vector<FloatBlock>& row_sums) {
    row_sums.resize(at(out.rows));
    parallel_for(at(out.rows), 128, [&](std::size_t i) {
        double sum[9] = {};
        out.for_each_entry(i, [&](std::size_t k) {
            const bool transposed = source[k] < 0;
            const double* block = a.block(at(transposed ? -source[k] - 1 : source[k]));
            for (int c = 0; c < 3; ++c) {
                for (int r = 0; r < 3; ++r) {
                    const double v = transposed ? block[3 * c + r] : block[3 * r + c];
                    sum[3 * c + r] += v;
                    out.blocks[k](r, c) = static_cast<float>(v);
                }
            }
        });
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) row_sums[i](r, c) = static_cast<float>(sum[3 * c + r]);
    });
}

bool invert_diagonal(const BlockList& a, const std::vector<int>& diagonal, const std::vector<float>& added,
                     std::vector<FloatBlock>& inverse) {
    const std::size_t n = added.size();
    inverse.resize(n);
    std::atomic<bool> good = true;
    parallel_for(n, 512, [&](std::size_t i) {
        const FloatBlock& block = a.blocks[at(diagonal[i])];
        Eigen::Matrix3d m;
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r)
                m(r, c) = static_cast<double>(block(r, c)) + (r == c ? static_cast<double>(added[i]) : 0);
        const Eigen::LLT<Eigen::Matrix3d> factor(m);
        if (factor.info() != Eigen::Success) {
            good = false;
            return;
        }
        m = factor.solve(Eigen::Matrix3d::Identity());
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) inverse[i](r, c) = static_cast<float>(m(r, c));
    });
    return good;
}

} // namespace sinew::solver
