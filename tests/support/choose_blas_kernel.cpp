// Before any test: OpenBLAS's kernels for this processor, as the program takes them.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/blas_kernel.h"

namespace {
[[maybe_unused]] const bool chosen = (sinew::solver::choose_blas_kernel(), true);
}
