// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/fiber/line_of_action.h"

namespace sinew::solver {

namespace {

double value_of(const LineOfActionValues& v, const LineMemory& line, double acceleration) {
    const double full = line.rest_length * (1 + v.stretch_bias);
    const double sum = v.pos_sensitivity * (1 - line.length / full) - v.vel_sensitivity * line.rate / full -
                       v.acc_sensitivity * acceleration / full;
    return std::clamp(sum, 0.0, v.max_excitation);
}

} // namespace

LineMemory start_line(const LineOfActionValues& values, double length) {
    LineMemory out{.rest_length = length, .length = length};
    out.value = value_of(values, out, 0);
    return out;
}

LineMemory follow_line(const LineOfActionValues& values, const LineMemory& before, double length, double step) {
    LineMemory out{.rest_length = before.rest_length, .length = length, .step = step};
    out.rate = (length - before.length) / step;
    // Rates are those of the middles of their steps.
    const double acceleration = before.step > 0 ? 2 * (out.rate - before.rate) / (step + before.step) : 0;
    out.value = value_of(values, out, acceleration);
    return out;
}

} // namespace sinew::solver
