// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/blas_speed.h"

#include <algorithm>
#include <chrono>
#include <vector>

extern "C" void openblas_set_num_threads(int);
extern "C" void dgemm_(const char* transpose_a, const char* transpose_b, const int* m, const int* n, const int* k,
                       const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
                       const double* beta, double* c, const int* ldc);

namespace sinew::solver {

double dgemm_rate(int n, int threads, int repeats) {
    using Clock = std::chrono::steady_clock;
    const std::size_t size = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
    std::vector<double> a(size, 1.0 / 3), b(size, 0.25), c(size, 0.0), seconds;
    const double one = 1, zero = 0;
    openblas_set_num_threads(threads);
    for (int i = 0; i <= repeats; ++i) {
        const auto start = Clock::now();
        dgemm_("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n);
        if (i > 0) seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    }
    openblas_set_num_threads(1);
    std::nth_element(seconds.begin(), seconds.begin() + repeats / 2, seconds.end());
    return 2.0 * n * n * n / seconds[static_cast<std::size_t>(repeats / 2)];
}

} // namespace sinew::solver
