// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/cholesky.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/linear/cholmod_threads.h"
#include "solver/parallel.h"

#include <cholmod.h>
#include <cmath>
#include <cstring>
#include <optional>

namespace sinew::solver {

struct Cholesky::Impl {
    cholmod_common common{};
    cholmod_sparse* matrix = nullptr; // lower triangle, columns sorted
    cholmod_factor* factor = nullptr;
    double factor_operations = 0;
    bool own_threads = false;
    cholmod_dense *right = nullptr, *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

    Impl() {
        cholmod_start(&common);
        common.print = 0;
        common.error_handler = nullptr;
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.final_ll = 1;
        common.try_catch = 1;
        common.quick_return_if_not_posdef = 1;
    }
    ~Impl() {
        cholmod_free_dense(&right, &common);
        cholmod_free_dense(&solution, &common);
        cholmod_free_dense(&work_y, &common);
        cholmod_free_dense(&work_e, &common);
        cholmod_free_factor(&factor, &common);
        cholmod_free_sparse(&matrix, &common);
        cholmod_finish(&common);
    }

    /// The scalar lower triangle: column 3i+c holds rows 3i+c…3i+2, then three rows a block (i, j > i).
    void build_structure(const BlockPattern& p) {
        std::size_t entries = 0;
        for (int i = 0; i < p.rows; ++i) entries += 6 + 9 * at(p.row_start[at(i) + 1] - p.row_start[at(i)] - 1);
        const std::size_t n = 3 * at(p.rows);
        matrix = cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_REAL, &common);
        if (!matrix) throw Error("FE305", "not enough memory for a matrix of " + std::to_string(n) + " unknowns");
        int* start = static_cast<int*>(matrix->p);
        int* row = static_cast<int*>(matrix->i);
        int next = 0;
        for (int i = 0; i < p.rows; ++i)
            for (int c = 0; c < 3; ++c) {
                start[3 * i + c] = next;
                for (int r = c; r < 3; ++r) row[next++] = 3 * i + r;
                for (int e = p.row_start[at(i)] + 1; e < p.row_start[at(i) + 1]; ++e)
                    for (int r = 0; r < 3; ++r) row[next++] = 3 * p.column[at(e)] + r;
            }
        start[n] = next;
    }

    /// Fill-reducing order of the vertices, three unknowns each.
    std::vector<int> order_vertices(const BlockPattern& p) {
        const std::size_t n = at(p.rows);
        cholmod_sparse* graph = cholmod_allocate_sparse(n, n, p.block_count(), 1, 1, -1, CHOLMOD_PATTERN, &common);
        std::memcpy(graph->p, p.row_start.data(), (n + 1) * sizeof(int));
        std::memcpy(graph->i, p.column.data(), p.block_count() * sizeof(int));
        std::vector<int> vertices(n), unknowns(3 * n);
        const int ok = cholmod_metis(graph, nullptr, 0, 1, vertices.data(), &common);
        cholmod_free_sparse(&graph, &common);
        if (!ok)
            for (std::size_t i = 0; i < n; ++i) vertices[i] = static_cast<int>(i);
        for (std::size_t i = 0; i < n; ++i)
            for (int c = 0; c < 3; ++c) unknowns[3 * i + at(c)] = 3 * vertices[i] + c;
        return unknowns;
    }
};

Cholesky::Cholesky(const BlockPattern& pattern, bool own_threads)
    : impl_(std::make_unique<Impl>()) {
    impl_->own_threads = own_threads;
    const std::lock_guard lock(analysis_mutex());
    use_one_blas_thread();
    impl_->build_structure(pattern);
    std::vector<int> order = impl_->order_vertices(pattern);
    impl_->common.nmethods = 1;
    impl_->common.method[0].ordering = CHOLMOD_GIVEN;
    impl_->common.postorder = 1;
    impl_->factor = cholmod_analyze_p(impl_->matrix, order.data(), nullptr, 0, &impl_->common);
    if (!impl_->factor) throw Error("FE305", "the symbolic analysis of the stiffness matrix failed (out of memory?)");
    impl_->factor_operations = impl_->common.fl;
    impl_->right = cholmod_zeros(impl_->matrix->nrow, 1, CHOLMOD_REAL, &impl_->common);
}

Cholesky::~Cholesky() = default;

bool Cholesky::factorize(const BlockMatrix& a) {
    // LAPACK kernels differ in whether they notice a NaN among their pivots.
    if (!std::isfinite(ordered_sum(a.values.size(), [&](std::size_t i) { return a.values[i]; }))) return false;
    const BlockPattern& p = *a.pattern;
    double* value = static_cast<double*>(impl_->matrix->x);
    const int* start = static_cast<const int*>(impl_->matrix->p);
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
    const int ok = cholmod_factorize(impl_->matrix, impl_->factor, &impl_->common);
    return ok && impl_->common.status == CHOLMOD_OK && impl_->factor->minor == impl_->factor->n;
}

double Cholesky::factor_operations() const { return impl_->factor_operations; }

void Cholesky::solve(const double* b, double* x) {
    std::memcpy(impl_->right->x, b, impl_->right->nrow * sizeof(double));
    cholmod_solve2(CHOLMOD_A, impl_->factor, impl_->right, nullptr, &impl_->solution, nullptr, &impl_->work_y,
                   &impl_->work_e, &impl_->common);
    std::memcpy(x, impl_->solution->x, impl_->right->nrow * sizeof(double));
}

} // namespace sinew::solver
