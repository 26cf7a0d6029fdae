// The buffers of OpenBLAS where memory is tight. It takes one of 128 MB for each thread at its first call, and tries
// for ever where there is none.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace sinew::solver {

/// Takes the buffers of `threads` threads now, which they then use, and returns for how many there was room: of more,
/// whoever calls BLAS would not come back. Only a limit of the address space (`ulimit -v`) refuses memory before it is
/// used, so that without one there is no need of this.
int take_blas_buffers(int threads);

} // namespace sinew::solver
