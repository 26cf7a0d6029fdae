// How fast this machine multiplies matrices: the yardstick for the direct solver.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace sinew::solver {

/// Floating-point operations a second of BLAS' dgemm on square matrices of size n, with `threads` of its own threads:
/// the median of `repeats` products after one to warm up. Leaves BLAS at one thread, as the direct solver wants it.
double dgemm_rate(int n, int threads, int repeats);

} // namespace sinew::solver
