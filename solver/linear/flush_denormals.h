// Numbers below 1e-38 do not matter to a preconditioner, and processors take far longer over them: what fills in far
// from the entries of a matrix fades away to them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace sinew::solver {

/// While this lives, this thread takes such single-precision numbers (of double precision those below 2e-308) for zero.
/// Every piece of work that threads share needs its own, or bits depend on which thread has it. Elsewhere than on x86
/// nothing happens: bits differ between architectures anyhow.
class FlushDenormals {
#if defined(__SSE2__)
  public:
    FlushDenormals()
        : before_(_mm_getcsr()) {
        _mm_setcsr(before_ | _MM_FLUSH_ZERO_ON | 0x0040); // and operands: denormals are zero
    }
    ~FlushDenormals() { _mm_setcsr(before_); }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

  private:
    unsigned before_;
#else
  public:
    FlushDenormals() {} // not trivial, so that it counts as used
#endif
};

} // namespace sinew::solver
