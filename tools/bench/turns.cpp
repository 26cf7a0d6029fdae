// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/turns.h"

#include "tools/bench/beams.h"
#include "tools/bench/table.h"

#include <algorithm>

namespace sinew::bench {

namespace {

constexpr double longest_repeated = 5; // seconds; the table says how often each was run

} // namespace

std::vector<std::vector<double>> in_turns(std::size_t choices, int turns,
                                          const std::function<double(std::size_t, int)>& run) {
    std::vector<std::vector<double>> out(choices);
    for (int turn = 0; turn < turns; ++turn)
        for (std::size_t i = 0; i < choices; ++i)
            if (turn == 0 || out[i].front() <= longest_repeated) out[i].push_back(run(i, turn));
    return out;
}

Timing summary_of(const std::vector<double>& seconds) {
    const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
    return {median(seconds), *least, *most, static_cast<int>(seconds.size())};
}

std::string spread_of(const Timing& timing) { return number(timing.least, 3) + "…" + number(timing.most, 3); }

} // namespace sinew::bench
