// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/cholmod_threads.h"

extern "C" {
void openblas_set_num_threads(int);
// Of OpenMP's runtime, which CHOLMOD brings. Its header belongs to a compiler, and not each has one.
int omp_get_max_active_levels(void);
void omp_set_max_active_levels(int);
}

namespace sinew::solver {

std::mutex& analysis_mutex() {
    static std::mutex mutex;
    return mutex;
}

void use_one_blas_thread() { openblas_set_num_threads(1); }

OneOpenMpThread::OneOpenMpThread()
    : levels_(omp_get_max_active_levels()) {
    omp_set_max_active_levels(0);
}

OneOpenMpThread::~OneOpenMpThread() { omp_set_max_active_levels(levels_); }

} // namespace sinew::solver
