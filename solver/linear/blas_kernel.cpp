// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/blas_kernel.h"

#include <algorithm>
#include <array>
#include <cstdlib>

extern "C" {
char* openblas_get_corename(void);
// Of builds with several kernels (DYNAMIC_ARCH, as Debian's); others have no choice.
void gotoblas_dynamic_quit(void) __attribute__((weak));
void gotoblas_dynamic_init(void) __attribute__((weak));
}

namespace sinew::solver {

namespace {

/// OpenBLAS's names of kernels for x86-64 without AVX.
constexpr std::array<std::string_view, 9> without_avx = {"Prescott",     "Core2",     "Penryn", "Dunnington", "Nehalem",
                                                         "Opteron_SSE3", "Barcelona", "Bobcat", "Atom"};

} // namespace

std::string_view blas_kernel() { return openblas_get_corename(); }

std::string machine_numerics() {
    std::string out(blas_kernel());
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) out += " avx2";
    if (__builtin_cpu_supports("fma")) out += " fma";
    if (__builtin_cpu_supports("avx512f")) out += " avx512f";
#endif
    return out;
}

void choose_blas_kernel() {
#if defined(__x86_64__)
    if (std::getenv("OPENBLAS_CORETYPE") || !gotoblas_dynamic_quit || !gotoblas_dynamic_init) return;
    if (std::find(without_avx.begin(), without_avx.end(), blas_kernel()) == without_avx.end()) return;
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return;
    const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    setenv("OPENBLAS_CORETYPE", avx512 ? "SkylakeX" : "Haswell", 1);
    gotoblas_dynamic_quit();
    gotoblas_dynamic_init();
    unsetenv("OPENBLAS_CORETYPE");
#endif
}

} // namespace sinew::solver
