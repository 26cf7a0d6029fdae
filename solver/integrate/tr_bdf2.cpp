// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"

namespace sinew::solver {

namespace {

void set_bones(const State& before, double step_size, double fraction, const std::vector<Points>* at_gamma,
               ImplicitForm& form) {
    if (at_gamma)
        set_bone_weights(*at_gamma, step_size, fraction, form);
    else
        set_bone_weights(before, step_size, fraction, form);
}

} // namespace

void tr_bdf2_trapezoid_form(const State& before, double step_size, const std::vector<Points>* bones_at_gamma,
                            ImplicitForm& form) {
    const std::vector<double>& a = before.history.acceleration;
    const std::size_t n = before.x.size();
    const double half = 0.5 * tr_bdf2_gamma * step_size;
    form.mass_factor = 1 / (half * half);
    form.velocity_factor = 1 / half;
    form.press = 2;
    set_bones(before, step_size, tr_bdf2_gamma, bones_at_gamma, form);
    form.strain = {.x = &before.x, .v = &before.v, .takes_known_rate = true, .rate = half};
    form.target.resize(n);
    form.velocity_offset.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        form.target[i] = before.x[i] + half * (2 * before.v[i] + half * a[i]);
        form.velocity_offset[i] = -before.x[i] / half - before.v[i];
    }
}

void tr_bdf2_bdf2_form(const State& before, const std::vector<double>& x_gamma, const std::vector<double>& v_gamma,
                       double step_size, const std::vector<Points>* bones_at_gamma, ImplicitForm& form) {
    const std::size_t n = before.x.size();
    const double g = tr_bdf2_gamma;
    // x' = middle x_gamma - start x + reach v'; reach = gamma h / 2 for this gamma.
    const double middle = 1 / (g * (2 - g)), start = (1 - g) * (1 - g) * middle, reach = 0.5 * g * step_size;
    form.mass_factor = 1 / (reach * reach);
    form.velocity_factor = 1 / reach;
    form.press = 1;
    set_bones(before, step_size, 1, bones_at_gamma, form);
    form.strain = {.x = &before.x, .start = -start, .x_between = &x_gamma, .between = middle};
    form.target.resize(n);
    form.velocity_offset.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double x = middle * x_gamma[i] - start * before.x[i], v = middle * v_gamma[i] - start * before.v[i];
        form.target[i] = x + reach * v;
        form.velocity_offset[i] = -x / reach;
    }
}

} // namespace sinew::solver
