// Which of its kernels OpenBLAS runs. They are chosen by the processor's model number, and of models that it does not
// know it takes those of the oldest processor with 64 bits: many times slower than the machine is.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace sinew::solver {

/// The name of the kernels in use, as OPENBLAS_CORETYPE would have it. Bits of factors differ between kernels.
std::string_view blas_kernel();

/// What bits hang on beside the inputs: the name of the kernels, and of avx2, fma and avx512f what the processor has,
/// since the C library chooses its exp and sin by them. For example "SkylakeX avx2 fma avx512f". Part of the keys of
/// what solves, so that results of one machine are never taken for those of another.
std::string machine_numerics();

/// Where OpenBLAS has taken kernels without AVX on a processor with AVX2 or AVX-512: takes those of Haswell or SkylakeX
/// instead. A kernel that OPENBLAS_CORETYPE names stays. For the start of a program: nothing else may be calling BLAS
/// meanwhile.
void choose_blas_kernel();

} // namespace sinew::solver
