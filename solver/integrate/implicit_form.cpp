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

namespace {

/// Lagrange's parabola through -q, 0 and 1 in units of h.
void set_parabola(double q, double t, double h, ImplicitForm& form) {
    form.bone_position = {t * (t - 1) / (q * (q + 1)), (t + q) * (1 - t) / q, t * (t + q) / (1 + q)};
    form.bone_velocity = {(2 * t - 1) / (q * (q + 1)) / h, (1 - q - 2 * t) / q / h, (2 * t + q) / (1 + q) / h};
}

} // namespace

void set_bone_weights(const State& before, double step_size, double fraction, ImplicitForm& form) {
    const double t = fraction, h = step_size, last = before.history.step_size;
    form.bones_within = nullptr;
    if (last != 0 && !before.history.bones.empty()) return set_parabola(last / h, t, h, form);
    form.bone_position = {0, 1 - t, t};
    form.bone_velocity = {0, -1 / h, 1 / h};
}

void set_bone_weights(const std::vector<Points>& at_gamma, double step_size, double fraction, ImplicitForm& form) {
    form.bones_within = &at_gamma;
    set_parabola(-tr_bdf2_gamma, fraction, step_size, form);
}

std::array<const std::vector<Points>*, 3> bones_weighed(const ImplicitForm& form, const State& before,
                                                        const std::vector<Points>& after) {
    const std::vector<Points>* first = form.bones_within              ? form.bones_within
                                       : before.history.bones.empty() ? &before.bones
                                                                      : &before.history.bones;
    return {first, &before.bones, &after};
}

void place_bone(const ImplicitForm& form, const std::array<const std::vector<Points>*, 3>& weighed, std::size_t body,
                Points& out) {
    out.assign((*weighed[2])[body].size(), Vec3::Zero());
    for (std::size_t time = 0; time < 3; ++time) {
        const double weight = form.bone_position[time];
        if (weight == 0) continue;
        const Points& then = (*weighed[time])[body];
        for (std::size_t v = 0; v < out.size(); ++v) out[v] += weight * then[v];
    }
}

} // namespace sinew::solver
