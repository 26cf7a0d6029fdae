// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"

namespace sinew::solver {

void backward_euler_form(const State& before, double step_size, ImplicitForm& form) {
    const std::size_t n = before.x.size();
    form.mass_factor = 1 / (step_size * step_size);
    form.velocity_factor = 1 / step_size;
    form.press = 1;
    form.bones_within = nullptr;
    form.bone_position = {0, 0, 1};
    form.bone_velocity = {0, -1 / step_size, 1 / step_size};
    form.strain = {.x = &before.x};
    form.target.resize(n);
    form.velocity_offset.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        form.target[i] = before.x[i] + step_size * before.v[i];
        form.velocity_offset[i] = -before.x[i] / step_size;
    }
}

} // namespace sinew::solver
