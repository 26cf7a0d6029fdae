// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/conjugate_gradients.h"

#include "solver/parallel.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

constexpr std::size_t row_grain = 512, chunk = 1536; // a chunk of a dot product: 512 rows

} // namespace

ConjugateGradients::ConjugateGradients(const BlockPattern& pattern)
    : matrix_(make_row_blocks(pattern, source_)) {
    const std::size_t n = static_cast<std::size_t>(pattern.rows);
    for (auto* v : {&r_, &z_, &p_, &ap_}) v->resize(3 * n);
    sums_.resize((3 * n + chunk - 1) / chunk);
}

void ConjugateGradients::set(const BlockMatrix& a) {
    copy_blocks(a, source_, matrix_, row_sums_);
    overlay_ = &a.overlay;
}

void ConjugateGradients::multiply(const std::vector<double>& x, std::vector<double>& y) const {
    // sum_j A_ij x_j = sum_j A_ij (x_j - x_i) + (sum_j A_ij) x_i: on smooth x the terms of the first form cancel to
    // less than single precision holds, and the curvature along x comes out with the wrong sign on large meshes.
    parallel_for(static_cast<std::size_t>(matrix_.rows), row_grain, [&](std::size_t i) {
        const double* own = x.data() + 3 * i;
        const FloatBlock& total = row_sums_[i];
        Float4 sum = total.col(0) * static_cast<float>(own[0]) + total.col(1) * static_cast<float>(own[1]) +
                     total.col(2) * static_cast<float>(own[2]);
        matrix_.for_each_entry(i, [&](std::size_t e) {
            const FloatBlock& b = matrix_.blocks[e];
            const double* v = x.data() + 3 * static_cast<std::size_t>(matrix_.column[e]);
            sum += b.col(0) * static_cast<float>(v[0] - own[0]) + b.col(1) * static_cast<float>(v[1] - own[1]) +
                   b.col(2) * static_cast<float>(v[2] - own[2]);
        });
        for (std::size_t c = 0; c < 3; ++c) y[3 * i + c] = static_cast<double>(sum[c]);
    });
    if (!overlay_->empty()) overlay_->add_product(x.data(), y.data());
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
                                                     const Preconditioner& preconditioner) {
    Result result;
    const std::size_t n = r_.size();
    std::fill_n(x, n, 0.0);
    std::copy_n(b, n, r_.begin());
    preconditioner(r_, z_);
    p_ = z_;
    double rz = dot(r_, z_);
    if (!(rz >= 0)) result.definite = false; // the preconditioner was made from an indefinite matrix
    const double goal = tolerance * tolerance * rz;
    while (result.definite && rz > goal && result.iterations < max_iterations) {
        ++result.iterations;
        multiply(p_, ap_);
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
        preconditioner(r_, z_);
        const double rz_next = dot(r_, z_);
        if (!(rz_next >= 0)) {
            result.definite = false;
            return result;
        }
        const double beta = rz_next / rz;
        rz = rz_next;
        parallel_for(n, 8192, [&](std::size_t i) { p_[i] = z_[i] + beta * p_[i]; });
    }
    result.converged = result.definite && rz <= goal;
    return result;
}

} // namespace sinew::solver
