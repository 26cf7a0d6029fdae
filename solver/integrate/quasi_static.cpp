// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"

namespace sinew::solver {

void quasi_static_form(const State& before, ImplicitForm& form) {
    form.mass_factor = 0;
    form.velocity_factor = 0;
    form.press = 1;
    form.bones_within = nullptr;
    form.bone_position = {0, 0, 1};
    form.bone_velocity = {};
    form.strain = {};
    form.target = before.x;
    form.velocity_offset.assign(before.x.size(), 0.0);
}

} // namespace sinew::solver
