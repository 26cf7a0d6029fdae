// Co-rotational linear elasticity with exact derivatives: psi = mu |F - R|^2 + lambda/2 tr(S - I)^2, F = R S.
// The twist quotient has the pole (s_i + s_j) -> 0, where R itself jumps; it is held at a distance there.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/material/principal.h"

namespace sinew::solver {

struct Corotational {
    template <class R>
    static void energy(const R* s, R mu, R lambda, Principal<R>& out) {
        clear(out);
        const R trace = s[0] + s[1] + s[2] - R(3.0);
        R squares(0.0);
        for (int i = 0; i < 3; ++i) {
            const int a = (i + 1) % 3, b = (i + 2) % 3;
            const R d = s[i] - R(1.0);
            squares += d * d;
            out.first[i] = R(2.0) * mu * d + lambda * trace;
            out.diagonal[i] = R(2.0) * mu + lambda;
            out.off_diagonal[i] = lambda;
            out.flip[i] = R(2.0) * mu;
            const R sum = s[a] + s[b];
            const R held = select(abs(sum) < R(1e-6), R(1e-6), sum);
            out.twist[i] = R(2.0) * mu + (R(2.0) * lambda * trace - R(4.0) * mu) / held;
        }
        out.energy = mu * squares + R(0.5) * lambda * trace * trace;
    }

    /// Its measure of volume, tr S - 3: the part with lambda is lambda/2 (tr S - 3)^2.
    template <class R>
    static void measure(const R* s, Principal<R>& out) {
        clear(out);
        out.energy = s[0] + s[1] + s[2] - R(3.0);
        for (int i = 0; i < 3; ++i) {
            const R sum = s[(i + 1) % 3] + s[(i + 2) % 3];
            out.first[i] = R(1.0);
            out.twist[i] = R(2.0) / select(abs(sum) < R(1e-6), R(1e-6), sum);
        }
    }
};

} // namespace sinew::solver
