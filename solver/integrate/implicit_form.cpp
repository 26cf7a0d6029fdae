// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"

namespace sinew::solver {

void update_velocity(const ImplicitForm& form, const std::vector<double>& x, std::vector<double>& v) {
    v.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = form.velocity_factor * x[i] + form.velocity_offset[i];
}

void implied_acceleration(const ImplicitForm& form, const std::vector<double>& x, std::vector<double>& acceleration) {
    acceleration.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) acceleration[i] = form.mass_factor * (x[i] - form.target[i]);
}

void set_bone_weights(const State& before, double step_size, double fraction, ImplicitForm& form) {
    const double t = fraction, h = step_size, last = before.history.step_size;
    if (last == 0 || before.history.bones.empty()) {
        form.bone_position = {0, 1 - t, t};
        form.bone_velocity = {0, -1 / h, 1 / h};
        return;
    }
    // Lagrange's parabola through -q, 0 and 1 in units of h.
    const double q = last / h;
    form.bone_position = {t * (t - 1) / (q * (q + 1)), (t + q) * (1 - t) / q, t * (t + q) / (1 + q)};
    form.bone_velocity = {(2 * t - 1) / (q * (q + 1)) / h, (1 - q - 2 * t) / q / h, (2 * t + q) / (1 + q) / h};
}

} // namespace sinew::solver
