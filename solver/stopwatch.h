// Adds the wall time of a scope to a counter of the report. Times are for people: nothing else reads them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>

namespace sinew::solver {

class Stopwatch {
  public:
    explicit Stopwatch(double& seconds)
        : seconds_(seconds)
        , start_(std::chrono::steady_clock::now()) {}
    ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
    Stopwatch(const Stopwatch&) = delete;

  private:
    double& seconds_;
    std::chrono::steady_clock::time_point start_;
};

} // namespace sinew::solver
