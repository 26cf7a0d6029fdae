// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/scalar_cholesky.h"

#include "solver/error.h"
#include "solver/linear/cholmod_threads.h"

#include <cholmod.h>
#include <cmath>
#include <new>
#include <string>

namespace sinew::solver {

struct ScalarCholesky::Impl {
    cholmod_common common{};
    cholmod_factor* factor = nullptr;
    cholmod_dense *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

    Impl() {
        cholmod_start(&common);
        common.print = 0;
        common.error_handler = nullptr;
        common.try_catch = 1;
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.final_ll = 1;
        common.quick_return_if_not_posdef = 1;
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_METIS;
        common.postorder = 1;
    }
    ~Impl() {
        cholmod_free_dense(&solution, &common);
        cholmod_free_dense(&work_y, &common);
        cholmod_free_dense(&work_e, &common);
        cholmod_free_factor(&factor, &common);
        cholmod_finish(&common);
    }
};

namespace {

/// The matrix as CHOLMOD sees it, without a copy. CHOLMOD does not write to it.
cholmod_sparse view(const Eigen::SparseMatrix<double>& a) {
    cholmod_sparse out{};
    out.nrow = static_cast<std::size_t>(a.rows());
    out.ncol = static_cast<std::size_t>(a.cols());
    out.nzmax = static_cast<std::size_t>(a.nonZeros());
    out.p = const_cast<int*>(a.outerIndexPtr());
    out.i = const_cast<int*>(a.innerIndexPtr());
    out.x = const_cast<double*>(a.valuePtr());
    out.stype = -1; // symmetric, lower triangle
    out.itype = CHOLMOD_INT;
    out.xtype = CHOLMOD_REAL;
    out.dtype = CHOLMOD_DOUBLE;
    out.sorted = 1;
    out.packed = 1;
    return out;
}

} // namespace

ScalarCholesky::ScalarCholesky(const Eigen::SparseMatrix<double>& pattern)
    : impl_(std::make_unique<Impl>()) {
    const std::lock_guard lock(analysis_mutex());
    use_one_blas_thread();
    cholmod_sparse a = view(pattern);
    impl_->factor = cholmod_analyze(&a, &impl_->common);
    if (!impl_->factor)
        throw Error("FE305", "the symbolic analysis of a matrix of " + std::to_string(a.nrow) +
                                 " unknowns failed (out of memory?)");
}

ScalarCholesky::~ScalarCholesky() = default;

bool ScalarCholesky::factorize(const Eigen::SparseMatrix<double>& a) {
    // LAPACK kernels differ in whether they notice a NaN among their pivots.
    if (!std::isfinite(Eigen::Map<const Eigen::VectorXd>(a.valuePtr(), a.nonZeros()).sum())) return false;
    const OneOpenMpThread guard;
    cholmod_sparse seen = view(a);
    const int ok = cholmod_factorize(&seen, impl_->factor, &impl_->common);
    if (impl_->common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    return ok && impl_->common.status == CHOLMOD_OK && impl_->factor->minor == impl_->factor->n;
}

Eigen::VectorXd ScalarCholesky::solve(const Eigen::VectorXd& b) const {
    const OneOpenMpThread guard;
    cholmod_dense right{};
    right.nrow = right.nzmax = right.d = static_cast<std::size_t>(b.size());
    right.ncol = 1;
    right.x = const_cast<double*>(b.data());
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    if (!cholmod_solve2(CHOLMOD_A, impl_->factor, &right, nullptr, &impl_->solution, nullptr, &impl_->work_y,
                        &impl_->work_e, &impl_->common))
        throw Error("FE305", "not enough memory to solve for " + std::to_string(b.size()) + " unknowns");
    return Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(impl_->solution->x), b.size());
}

} // namespace sinew::solver
