// Stable neo-Hookean (Smith, de Goes, Kim 2018, "Stable neo-Hookean flesh simulation", eq. 14 with the parameters of
// section 3.4): psi = m/2 (I_C - 3) - m/2 ln(I_C + 1) + l/2 (J - a)^2 with
//   m = 4/3 mu, l = lambda + 5/6 mu, a = 1 + m/l - m/(4 l),
// so that the small-strain limit is exactly (mu, lambda), rest is stress-free, and the energy is finite and drives back
// for every F, inverted or collapsed to a point. We subtract the constant that makes psi(I) = 0.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/material/measure_by_j.h"

namespace sinew::solver {

struct StableNeoHookean : MeasureByJ {
    template <class R>
    static void energy(const Strains<R>& e, R mu, R lambda, TensorForm<R>& out) {
        clear(out);
        const R m = R(4.0 / 3.0) * mu, l = lambda + R(5.0 / 6.0) * mu;
        const R a = R(1.0) + R(0.75) * m / l, d = e.j - a;
        const R above = R(2.0) * e.trace + R(4.0), inverse = R(1.0) / above; // I_C + 1
        out.energy =
            m * e.trace - R(0.5) * m * log(R(0.25) * above) + R(0.5) * l * (d * d - (R(1.0) - a) * (R(1.0) - a));
        out.uniform = m * (R(1.0) - inverse);
        out.uniform_slope = R(2.0) * m * inverse * inverse;
        out.by_j = l * d;
        out.by_jj = l;
    }

    template <class R>
    static void energy(const R* s, R mu, R lambda, Principal<R>& out) {
        clear(out);
        const R m = R(4.0 / 3.0) * mu, l = lambda + R(5.0 / 6.0) * mu;
        const R a = R(1.0) + R(0.75) * m / l;
        const R ic = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
        const R inverse = R(1.0) / (ic + R(1.0));
        const R rest = R(0.5) * l * (R(1.0) - a) * (R(1.0) - a) - R(0.5) * m * R(1.3862943611198906); // ln 4
        out.energy = R(0.5) * m * (ic - R(3.0)) - R(0.5) * m * log(ic + R(1.0)) - rest;
        // g(I_C): first derivative in I_C is (m/2)(1 - 1/(I_C+1)), second (m/2)/(I_C+1)^2.
        const R g1 = m * (R(1.0) - inverse), g2 = R(2.0) * m * inverse * inverse;
        for (int i = 0; i < 3; ++i) {
            const int p = (i + 1) % 3, q = (i + 2) % 3;
            out.first[i] = g1 * s[i];
            out.diagonal[i] = g1 + g2 * s[i] * s[i];
            out.off_diagonal[i] = g2 * s[p] * s[q];
            out.flip[i] = g1;
            out.twist[i] = g1;
        }
        const R d = s[0] * s[1] * s[2] - a;
        add_volumetric(s, R(0.5) * l * d * d, l * d, l, out);
    }
};

} // namespace sinew::solver
