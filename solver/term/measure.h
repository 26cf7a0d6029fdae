// Numbers that a term reports at the end of a frame, and what they mean: the fields of the report, the rows of the
// viewer's time line.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>
#include <vector>

namespace sinew::solver {

/// How the numbers of several frames become one.
enum class Combine { sum, most, last };

struct Measure {
    std::string_view term, name; ///< "attachment", "max_stretch_m": keys in the report
    std::string_view unit;       ///< "m"
    std::string_view title;      ///< for people: "largest attachment stretch"
    Combine combine = Combine::most;
};

struct Measured {
    const Measure* what = nullptr;
    double value = 0;
    int part = -1; ///< where each of a term's parts has its own number, counted from 0 among them; else -1
};

/// The measure of that name, of any known term; null if there is none.
const Measure* find_measure(std::string_view term, std::string_view name);
/// The value of one measure, of one of the term's parts where each has its own; 0 if it is not there.
double value_of(const std::vector<Measured>& measured, std::string_view term, std::string_view name, int part = -1);

} // namespace sinew::solver
