// Which kernels OpenBLAS runs.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/blas_kernel.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <string>

using namespace sinew::solver;

TEST_CASE("a processor with AVX2 gets kernels with AVX2 whatever its model number", "[linear]") {
    // The test program has called choose_blas_kernel at its start.
    if (std::getenv("OPENBLAS_CORETYPE")) return;
#if defined(__x86_64__)
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return;
    const std::string kernel(blas_kernel());
    INFO(kernel);
    CHECK((kernel == "Haswell" || kernel == "Zen" || kernel == "SkylakeX" || kernel == "Cooperlake" ||
           kernel == "Sapphirerapids"));
    choose_blas_kernel(); // and again changes nothing
    CHECK(blas_kernel() == kernel);
#endif
}
