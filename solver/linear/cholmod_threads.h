// What keeps CHOLMOD's bits the same on every run: one BLAS thread, no OpenMP regions, one analysis at a time.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mutex>

namespace sinew::solver {

/// Hold it during a symbolic analysis: METIS draws from the C library's rand(), so two analyses at once would disturb
/// each other's order, and with it the bits of the result.
std::mutex& analysis_mutex();

/// Sets OpenBLAS to one thread: with two, its sums differ in the last bits. Needs the analysis mutex.
void use_one_blas_thread();

/// CHOLMOD opens an OpenMP region for nearly every column. Where factors are made side by side, threads of its own only
/// stand in each other's way; while this lives, this thread opens none.
class OneOpenMpThread {
  public:
    OneOpenMpThread();
    ~OneOpenMpThread();
    OneOpenMpThread(const OneOpenMpThread&) = delete;
    OneOpenMpThread& operator=(const OneOpenMpThread&) = delete;

  private:
    int levels_;
};

} // namespace sinew::solver
