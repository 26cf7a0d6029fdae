// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/standing_form.h"

namespace sinew::solver {

void standing_form(const State& before, ImplicitForm& form) {
    form.mass_factor = 0;
    form.velocity_factor = 1;
    form.press = 1;
    form.target = before.x;
    form.velocity_offset.resize(before.x.size());
    for (std::size_t i = 0; i < before.x.size(); ++i) form.velocity_offset[i] = before.v[i] - before.x[i];
    form.strain = {.x = &before.x, .v = &before.v, .rate = -1};
    form.bone_position = {0, 1, 0};
    form.bone_velocity = {};
    if (const double h = before.history.step_size; h > 0 && !before.history.bones.empty())
        form.bone_velocity = {-1 / h, 1 / h, 0};
}

} // namespace sinew::solver
