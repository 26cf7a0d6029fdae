// What a value must come below at the next step of a line search that lets it rise at times: a mean of what it was, in
// which older ones fade (Zhang and Hager, "A nonmonotone line search technique", 2004). A step of a sheet often ends
// where more presses than its quadratic model knew of. Sheets are so soft across that a value which may never rise
// makes them creep from one contact to the next; let on, the next step sees what presses and brings it down farther.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

namespace sinew::solver {

class FadingMean {
  public:
    /// Each older value counts so much of the next one.
    static constexpr double fading = 0.5;

    /// What came before says nothing: another function.
    void forget() { weight_ = 0; }
    /// Takes the value of now in. Returns the mean, or the value if that is higher.
    double take(double value) {
        const double kept = fading * weight_;
        weight_ = kept + 1;
        mean_ = (kept * mean_ + value) / weight_;
        return std::max(mean_, value);
    }
    /// All values so far are higher by so much now.
    void raise(double by) { mean_ += by; }

  private:
    double mean_ = 0, weight_ = 0;
};

} // namespace sinew::solver
