// Measuring times in turns: everything once, then everything again, so that what disturbs the machine for a while does
// not fall on one choice alone, and ratios compare runs that stood side by side.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace sinew::bench {

/// Seconds of each run: [choice][turn]. `run` gives the seconds of one; what takes longer than 5 s in its first turn is
/// run that once.
std::vector<std::vector<double>> in_turns(std::size_t choices, int turns,
                                          const std::function<double(std::size_t choice, int turn)>& run);

struct Timing {
    double seconds = 0, least = 0, most = 0; ///< median and range
    int repeats = 0;
};
Timing summary_of(const std::vector<double>& seconds);
/// "0.0978…0.121", in seconds.
std::string spread_of(const Timing& timing);

} // namespace sinew::bench
