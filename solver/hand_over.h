// Tells the thread sanitizer what passes between threads where TBB, which is not instrumented, starts pieces of work
// and waits for them: all that was written before is seen by every piece, and all that pieces write by what comes
// after. Between pieces nothing is said, so a race between two of them is found. Costs nothing without that sanitizer.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace sinew::solver {

class HandOver {
#if defined(__SANITIZE_THREAD__)
  public:
    HandOver() { __tsan_release(&start_); }
    ~HandOver() { __tsan_acquire(&end_); }
    HandOver(const HandOver&) = delete;
    void begin_piece() const { __tsan_acquire(&start_); }
    void end_piece() const { __tsan_release(&end_); }

  private:
    mutable char start_ = 0, end_ = 0;
#else
  public:
    HandOver() {}
    ~HandOver() {}
    HandOver(const HandOver&) = delete;
    void begin_piece() const {}
    void end_piece() const {}
#endif
};

} // namespace sinew::solver
