// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"

namespace sinew::solver {

void make_form(const State& before, const StepInputs& inputs, ImplicitForm& form) {
    switch (inputs.integrator) {
    case Integrator::backward_euler: backward_euler_form(before, inputs.step_size, form); break;
    case Integrator::quasi_static: quasi_static_form(before, form); break;
    }
}

void update_velocity(const ImplicitForm& form, const std::vector<double>& x, std::vector<double>& v) {
    v.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = form.velocity_factor * x[i] + form.velocity_offset[i];
}

} // namespace sinew::solver
