// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/conjugate_gradients.h"

#include "solver/parallel.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

typedef float Float4 __attribute__((vector_size(16)));

constexpr std::size_t row_grain = 512, chunk = 1536; // a chunk of a dot product: 512 rows

Float4 load(const float* p) { return *reinterpret_cast<const Float4*>(p); }

} // namespace

ConjugateGradients::ConjugateGradients(const BlockPattern& pattern) : pattern_(pattern) {
    const std::size_t n = static_cast<std::size_t>(pattern.rows);
    row_start_.assign(n + 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
        const int lower = pattern.lower_start[i + 1] - pattern.lower_start[i];
        const int upper = pattern.row_start[i + 1] - pattern.row_start[i];
        row_start_[i + 1] = row_start_[i] + lower + upper;
        for (int e = pattern.lower_start[i]; e < pattern.lower_start[i + 1]; ++e) {
            const auto [index, column] = pattern.lower[static_cast<std::size_t>(e)];
            column_.push_back(column);
            source_.push_back(-index - 1);
        }
        for (int e = pattern.row_start[i]; e < pattern.row_start[i + 1]; ++e) {
            column_.push_back(pattern.column[static_cast<std::size_t>(e)]);
            source_.push_back(e);
        }
    }
    blocks_.resize(column_.size());
    inverse_.resize(9 * n);
    p_single_.resize(3 * n + 1);
    for (auto* v : {&r_, &z_, &p_, &ap_}) v->resize(3 * n);
    sums_.resize((3 * n + chunk - 1) / chunk);
}

void ConjugateGradients::set(const BlockMatrix& a) {
    matrix_ = &a;
    parallel_for(blocks_.size(), 2048, [&](std::size_t k) {
        const bool transposed = source_[k] < 0;
        const double* block = a.block(static_cast<std::size_t>(transposed ? -source_[k] - 1 : source_[k]));
        for (int c = 0; c < 3; ++c) {
            for (int r = 0; r < 3; ++r) blocks_[k].column[c][r] = static_cast<float>(transposed ? block[3 * c + r] : block[3 * r + c]);
            blocks_[k].column[c][3] = 0;
        }
    });
}

bool ConjugateGradients::invert_diagonal() {
    std::vector<char> bad((static_cast<std::size_t>(pattern_.rows) + row_grain - 1) / row_grain, 0);
    parallel_for(static_cast<std::size_t>(pattern_.rows), row_grain, [&](std::size_t i) {
        using Row3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
        const Row3 block = Eigen::Map<const Row3>(matrix_->block(static_cast<std::size_t>(pattern_.row_start[i])));
        const Eigen::LLT<Row3> factor(block);
        if (factor.info() != Eigen::Success) {
            bad[i / row_grain] = 1;
            return;
        }
        Eigen::Map<Row3>(inverse_.data() + 9 * i) = factor.solve(Row3::Identity());
    });
    return std::find(bad.begin(), bad.end(), 1) == bad.end();
}

void ConjugateGradients::multiply(const std::vector<float>& x, std::vector<double>& y) const {
    parallel_for(static_cast<std::size_t>(pattern_.rows), row_grain, [&](std::size_t i) {
        Float4 sum = {0, 0, 0, 0};
        for (int e = row_start_[i]; e < row_start_[i + 1]; ++e) {
            const Block& b = blocks_[static_cast<std::size_t>(e)];
            const float* v = x.data() + 3 * static_cast<std::size_t>(column_[static_cast<std::size_t>(e)]);
            sum += load(b.column[0]) * v[0] + load(b.column[1]) * v[1] + load(b.column[2]) * v[2];
        }
        for (std::size_t c = 0; c < 3; ++c) y[3 * i + c] = static_cast<double>(sum[c]);
    });
}

void ConjugateGradients::precondition(const std::vector<double>& r, std::vector<double>& z) const {
    parallel_for(static_cast<std::size_t>(pattern_.rows), 2 * row_grain, [&](std::size_t i) {
        const double* m = inverse_.data() + 9 * i;
        const double* v = r.data() + 3 * i;
        for (std::size_t c = 0; c < 3; ++c) z[3 * i + c] = m[3 * c] * v[0] + m[3 * c + 1] * v[1] + m[3 * c + 2] * v[2];
    });
}

double ConjugateGradients::dot(const std::vector<double>& a, const std::vector<double>& b) {
    parallel_for(sums_.size(), 4, [&](std::size_t k) {
        const std::size_t last = std::min((k + 1) * chunk, a.size());
        double sum[4] = {0, 0, 0, 0}; // four chains, so that additions need not wait for each other
        std::size_t i = k * chunk;
        for (; i + 4 <= last; i += 4)
            for (std::size_t c = 0; c < 4; ++c) sum[c] += a[i + c] * b[i + c];
        for (; i < last; ++i) sum[0] += a[i] * b[i];
        sums_[k] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    });
    double total = 0;
    for (const double s : sums_) total += s;
    return total;
}

ConjugateGradients::Result ConjugateGradients::solve(const double* b, double* x, double tolerance, int max_iterations,
                                                     const Preconditioner* preconditioner) {
    Result result;
    const auto apply = [&] { preconditioner ? (*preconditioner)(r_, z_) : precondition(r_, z_); };
    if (!preconditioner && !invert_diagonal()) {
        result.definite = false;
        return result;
    }
    const std::size_t n = r_.size();
    std::fill_n(x, n, 0.0);
    std::copy_n(b, n, r_.begin());
    apply();
    p_ = z_;
    double rz = dot(r_, z_);
    const double goal = tolerance * tolerance * rz;
    while (rz > goal && result.iterations < max_iterations) {
        ++result.iterations;
        parallel_for(n, 8192, [&](std::size_t i) { p_single_[i] = static_cast<float>(p_[i]); });
        multiply(p_single_, ap_);
        const double curvature = dot(p_, ap_);
        if (!(curvature > 0)) {
            result.definite = false;
            return result;
        }
        const double alpha = rz / curvature;
        parallel_for(n, 8192, [&](std::size_t i) {
            x[i] += alpha * p_[i];
            r_[i] -= alpha * ap_[i];
        });
        apply();
        const double rz_next = dot(r_, z_);
        const double beta = rz_next / rz;
        rz = rz_next;
        parallel_for(n, 8192, [&](std::size_t i) { p_[i] = z_[i] + beta * p_[i]; });
    }
    result.converged = rz <= goal;
    return result;
}

} // namespace sinew::solver
