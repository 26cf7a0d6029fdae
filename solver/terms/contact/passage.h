// Whether two sides that are near have gone through each other, kept from iteration to iteration of a solve.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

namespace sinew::solver {

/// Of two sides, where the solve goes on from: how far they were apart, and whether they were through. Nothing meets on
/// a shorter way than that.
class Passage {
  public:
    /// They are farther apart than the range, or press with this gap, less than 0 where they are through [m].
    void leave(double range) { now_ = static_cast<float>(range); }
    void meet(double gap) { now_ = static_cast<float>(gap); }
    /// The solve goes on from here. Returns how far they are apart, rounded down [m].
    double accept() {
        was_through_ = now_ < 0;
        return 0.999 * std::abs(static_cast<double>(now_));
    }
    bool was_through() const { return was_through_; }

  private:
    float now_ = 0;
    bool was_through_ = false;
};

} // namespace sinew::solver
