// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"

namespace sinew::solver {

bool has_bdf2_history(const State& before, double step_size) {
    return before.history.step_size > 0 && step_size < 2.4 * before.history.step_size;
}

void bdf2_form(const State& before, double step_size, ImplicitForm& form) {
    if (!has_bdf2_history(before, step_size)) return backward_euler_form(before, step_size, form);
    const History& last = before.history;
    const std::size_t n = before.x.size();
    const double ratio = step_size / last.step_size;
    // Everything divided by the coefficient of x', so that x' = now x - then x_before + reach v'.
    const double lead = (1 + 2 * ratio) / (1 + ratio);
    const double now = (1 + ratio) / lead, then = ratio * ratio / (1 + ratio) / lead, reach = step_size / lead;
    form.mass_factor = 1 / (reach * reach);
    form.velocity_factor = 1 / reach;
    form.press = 1;
    set_bone_weights(before, step_size, 1, form);
    form.strain = {.x = &before.x, .start = now, .x_between = &last.x, .between = -then};
    form.target.resize(n);
    form.velocity_offset.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double x = now * before.x[i] - then * last.x[i], v = now * before.v[i] - then * last.v[i];
        form.target[i] = x + reach * v;
        form.velocity_offset[i] = -x / reach;
    }
}

} // namespace sinew::solver
