// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/cholesky.h"

#include "solver/index.h"
#include "solver/linear/cholmod_analysis.h"
#include "solver/linear/cholmod_threads.h"
#include "solver/parallel.h"

#include <cmath>
#include <cstring>
#include <new>
#include <optional>

namespace sinew::solver {

struct Cholesky::Impl {
    CholmodAnalysis analysis;
    bool own_threads;
    cholmod_dense *right, *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

    Impl(const BlockPattern& pattern, bool own_threads)
        : analysis(pattern)
        , own_threads(own_threads)
        , right(cholmod_zeros(analysis.matrix->nrow, 1, CHOLMOD_REAL, &analysis.common)) {}
    ~Impl() {
        cholmod_free_dense(&right, &analysis.common);
        cholmod_free_dense(&solution, &analysis.common);
        cholmod_free_dense(&work_y, &analysis.common);
        cholmod_free_dense(&work_e, &analysis.common);
    }
};

Cholesky::Cholesky(const BlockPattern& pattern, bool own_threads)
    : impl_(std::make_unique<Impl>(pattern, own_threads)) {}

Cholesky::~Cholesky() = default;

bool BlockView::finite() const {
    return std::isfinite(ordered_sum(pattern->block_count(), [&](std::size_t b) {
        double sum = 0;
        for (std::size_t k = 0; k < 9; ++k) sum += number(b, k);
        return sum;
    }));
}

bool Cholesky::factorize(const BlockView& a) {
    if (!a.finite()) return false;
    const BlockPattern& p = *a.pattern;
    double* value = static_cast<double*>(impl_->analysis.matrix->x);
    const int* start = static_cast<const int*>(impl_->analysis.matrix->p);
    parallel_for(at(p.rows), 256, [&](std::size_t i) {
        for (int c = 0; c < 3; ++c) {
            double* out = value + start[3 * i + at(c)];
            const double* diagonal = a.block(at(p.row_start[i]));
            for (int r = c; r < 3; ++r) *out++ = diagonal[3 * r + c];
            for (int e = p.row_start[i] + 1; e < p.row_start[i + 1]; ++e) {
                const double* block = a.block(at(e));
                for (int r = 0; r < 3; ++r) *out++ = block[3 * c + r]; // entry (3j+r, 3i+c) of the lower triangle
            }
        }
    });
    std::optional<OneOpenMpThread> guard;
    if (!impl_->own_threads) guard.emplace();
    const int ok = cholmod_factorize(impl_->analysis.matrix, impl_->analysis.factor, &impl_->analysis.common);
    if (impl_->analysis.common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    return ok && impl_->analysis.common.status == CHOLMOD_OK &&
           impl_->analysis.factor->minor == impl_->analysis.factor->n;
}

void Cholesky::release() {
    cholmod_change_factor(CHOLMOD_PATTERN, 1, 1, 1, 1, impl_->analysis.factor, &impl_->analysis.common);
}

std::size_t Cholesky::bytes() const {
    const cholmod_factor& f = *impl_->analysis.factor;
    return f.xtype == CHOLMOD_PATTERN ? 0 : f.xsize * sizeof(double);
}

double Cholesky::factor_operations() const { return impl_->analysis.operations; }

void Cholesky::solve(const double* b, double* x) {
    std::memcpy(impl_->right->x, b, impl_->right->nrow * sizeof(double));
    if (!cholmod_solve2(CHOLMOD_A, impl_->analysis.factor, impl_->right, nullptr, &impl_->solution, nullptr,
                        &impl_->work_y, &impl_->work_e, &impl_->analysis.common))
        throw std::bad_alloc();
    std::memcpy(x, impl_->solution->x, impl_->right->nrow * sizeof(double));
}

} // namespace sinew::solver
