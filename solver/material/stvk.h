// St. Venant-Kirchhoff: psi = mu |E|^2 + lambda/2 tr(E)^2 with the Green strain E = (F^T F - I)/2. Softens in
// compression (stress returns to zero at s = 0): that is the law, and what compression_resistance.h is for.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/material/principal.h"
#include "solver/material/tensor_form.h"

namespace sinew::solver {

struct StVK {
    template <class R>
    static void energy(const R* s, R mu, R lambda, Principal<R>& out) {
        clear(out);
        R e[3];
        for (int i = 0; i < 3; ++i) e[i] = R(0.5) * (s[i] * s[i] - R(1.0));
        const R trace = e[0] + e[1] + e[2];
        out.energy = mu * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + R(0.5) * lambda * trace * trace;
        for (int i = 0; i < 3; ++i) {
            const int a = (i + 1) % 3, b = (i + 2) % 3;
            out.first[i] = s[i] * (R(2.0) * mu * e[i] + lambda * trace);
            out.diagonal[i] = mu * (R(3.0) * s[i] * s[i] - R(1.0)) + lambda * (trace + s[i] * s[i]);
            out.off_diagonal[i] = lambda * s[a] * s[b];
            const R squares = s[a] * s[a] + s[b] * s[b] - R(1.0), product = s[a] * s[b];
            out.flip[i] = mu * (squares + product) + lambda * trace;
            out.twist[i] = mu * (squares - product) + lambda * trace;
        }
    }

    template <class R>
    static void energy(const Strains<R>& e, R mu, R lambda, TensorForm<R>& out) {
        clear(out);
        R squares(0.0);
        for (const R& g : e.green) squares += g * g;
        out.energy = mu * squares + R(0.5) * lambda * e.trace * e.trace;
        out.uniform = lambda * e.trace;
        out.uniform_slope = lambda;
        out.green = R(2.0) * mu;
    }

    /// Its measure of volume, tr E: the part with lambda is lambda/2 tr(E)^2.
    template <class R>
    static void measure(const Strains<R>& e, TensorForm<R>& out) {
        clear(out);
        out.energy = e.trace;
        out.uniform = R(1.0);
    }
    template <class R>
    static void measure(const R* s, Principal<R>& out) {
        clear(out);
        out.energy = R(0.5) * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - R(3.0));
        for (int i = 0; i < 3; ++i) {
            out.first[i] = s[i];
            out.diagonal[i] = out.flip[i] = out.twist[i] = R(1.0);
        }
    }
};

} // namespace sinew::solver
