// Kelvin-Voigt damping: a second Piola-Kirchhoff stress S = 2 mu E' + lambda tr(E') I from the rate E' of the Green
// strain, with the viscosities mu, lambda [Pa s] = stiffnessDamping x the Lamé parameters. About rest it is Rayleigh's
// damping by the stiffness matrix; rigid motions, which leave E alone, it does not touch, however far a body turns in a
// step. Within a time step E' = f (E - E_ref), so the stress is the derivative of f (mu |E - E_ref|^2 + lambda/2 tr(E -
// E_ref)^2).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/material/tensor_form.h"

namespace sinew::solver {

/// Components of a symmetric strain in a list: 00 11 22 12 02 01.
template <class R>
inline void list_strain(const R* e, R* out) {
    for (int i = 0; i < 3; ++i) out[i] = e[4 * i], out[3 + i] = e[3 * ((i + 1) % 3) + (i + 2) % 3];
}

/// (F^T G + G^T F)/2, listed: the rate of the Green strain where F changes at the rate G.
template <class R>
inline void strain_rate(const R* f, const R* g, R* out) {
    R m[9];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            m[3 * i + j] = R(0.5) * (f[i] * g[j] + f[3 + i] * g[3 + j] + f[6 + i] * g[6 + j] + f[j] * g[i] +
                                     f[3 + j] * g[3 + i] + f[6 + j] * g[6 + i]);
    list_strain(m, out);
}

/// Adds the damping; mu and lambda are the viscosities times f [Pa], `reference` is E_ref, listed.
template <class R>
inline void add_viscosity(const Strains<R>& e, const R* reference, R mu, R lambda, TensorForm<R>& out) {
    R d[6];
    list_strain(e.green, d);
    for (int i = 0; i < 6; ++i) d[i] -= reference[i];
    const R trace = d[0] + d[1] + d[2];
    out.energy += mu * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + R(2.0) * (d[3] * d[3] + d[4] * d[4] + d[5] * d[5])) +
                  R(0.5) * lambda * trace * trace;
    out.uniform += lambda * trace;
    out.uniform_slope += lambda;
    out.green += R(2.0) * mu;
    for (int i = 0; i < 6; ++i) out.constant[i] -= R(2.0) * mu * reference[i];
}

} // namespace sinew::solver
