// Active muscle stress: energy per rest volume 1/2 k max(0, lf - c)^2 with the fibre stretch lf = |F a|,
// k = strength x weight x envelope x excitation [Pa] and c the contraction limit: the fibre pulls towards the length
// c and never past it. Several fibres of a tissue add.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/tet_batch.h"
#include "solver/scene.h"

namespace sinew::solver {

/// One fibre field on one batch.
struct FiberBatch {
    double direction[3][lanes]; ///< unit vectors at rest
    double weight[lanes];       ///< 0 where there is no fibre
};

/// A field that pulls in this step.
struct ActiveFiber {
    const FiberBatch* batch;
    double stiffness; ///< strength x envelope x excitation [Pa]
    double contraction_limit;
};

std::vector<FiberBatch> make_fiber_batches(const FiberRest& fiber, std::size_t batch_count);

/// Adds to the gradient by the corners, the energy [J] and the sum of squared fibre forces [N^2] of a point with
/// deformation gradient f and this volume [m^3].
void add_fiber_gradient(const TetBatch& batch, const ActiveFiber& fiber, const Pack* f, Pack volume, Pack g[4][3],
                        Pack& energy, Pack& squares);
/// Adds to the Hessian blocks of corners 1…3 (upper triangle by rows, row-major each). Positive semi-definite: it is
/// zero wherever the fibre does not pull.
void add_fiber_hessian(const TetBatch& batch, const ActiveFiber& fiber, const Pack* f, Pack volume, Pack blocks[6][9]);

} // namespace sinew::solver
