// Active muscle stress: energy per rest volume 1/2 k max(0, lf - c)^2 with the fibre stretch lf = |F a|,
// k = strength x weight x envelope x excitation [Pa] and c the contraction limit: the fibre pulls towards the length
// c and never past it. Several fibres of a tissue add.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/linear_tets.h"

namespace sinew::solver {

/// One fibre field on one batch.
struct FiberBatch {
    double direction[3][lanes]; ///< unit vectors at rest
    double weight[lanes];       ///< 0 where there is no fibre
};

std::vector<FiberBatch> make_fiber_batches(const FiberRest& fiber, std::size_t batch_count);

/// Adds energy and gradient to `out`. `stiffness` = strength x envelope x excitation [Pa].
void add_fiber_gradient(const TetBatch& batch, const FiberBatch& fiber, double stiffness, double contraction_limit,
                        const double* x, TetGradient& out);
/// Adds the Hessian, which is positive semi-definite wherever the fibre pulls (lf > c) and zero elsewhere.
void add_fiber_hessian(const TetBatch& batch, const FiberBatch& fiber, double stiffness, double contraction_limit,
                       const double* x, TetHessian& out);

} // namespace sinew::solver
