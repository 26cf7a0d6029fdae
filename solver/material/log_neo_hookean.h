// Neo-Hookean with logarithms (Bonet and Wood): psi = mu/2 (I_C - 3) - mu ln J + lambda/2 (ln J)^2. The form that
// textbooks and engineering codes compare by. It is infinite at J = 0 and not defined beyond, so nothing that starts
// inverted can come back; for animation take the stable form (neo_hookean.h).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/material/principal.h"
#include "solver/material/tensor_form.h"

namespace sinew::solver {

/// ln J and its derivatives; not a number for J <= 0, which the line search refuses.
template <class R>
struct PlainLog {
    R value, first, second;
    explicit PlainLog(R j)
        : value(log(j))
        , first(R(1.0) / j)
        , second(-first * first) {}
};

/// The same, continued below a small J by its second-order Taylor series there.
template <class R>
struct ContinuedLog {
    /// Smaller ones would turn tets back more surely, and bend the energy more sharply there.
    static constexpr double least_j = 0.03;
    R value, first, second;
    explicit ContinuedLog(R j) {
        const auto below = j < R(least_j);
        const R there = select(below, R(least_j), j), beyond = (j - there) / there;
        value = log(there) + beyond - R(0.5) * beyond * beyond;
        first = (R(1.0) - beyond) / there;
        second = -R(1.0) / (there * there);
    }
};

template <template <class> class Log>
struct LogNeoHookeanBy {
    template <class R>
    static void energy(const Strains<R>& e, R mu, R lambda, TensorForm<R>& out) {
        clear(out);
        const Log<R> l(e.j);
        const R slope = lambda * l.value - mu;
        out.energy = mu * e.trace + (R(0.5) * lambda * l.value - mu) * l.value;
        out.uniform = mu;
        out.by_j = slope * l.first;
        out.by_jj = lambda * l.first * l.first + slope * l.second;
    }
    template <class R>
    static void energy(const R* s, R mu, R lambda, Principal<R>& out) {
        clear(out);
        out.energy = R(0.5) * mu * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - R(3.0));
        for (int i = 0; i < 3; ++i) {
            out.first[i] = mu * s[i];
            out.diagonal[i] = out.flip[i] = out.twist[i] = mu;
        }
        const Log<R> l(R(s[0] * s[1] * s[2]));
        const R slope = lambda * l.value - mu;
        add_volumetric(s, (R(0.5) * lambda * l.value - mu) * l.value, slope * l.first,
                       lambda * l.first * l.first + slope * l.second, out);
    }

    /// Its measure of volume, ln J: the part with lambda is lambda/2 (ln J)^2.
    template <class R>
    static void measure(const Strains<R>& e, TensorForm<R>& out) {
        clear(out);
        const Log<R> l(e.j);
        out.energy = l.value, out.by_j = l.first, out.by_jj = l.second;
    }
    template <class R>
    static void measure(const R* s, Principal<R>& out) {
        clear(out);
        const Log<R> l(R(s[0] * s[1] * s[2]));
        add_volumetric(s, l.value, l.first, l.second, out);
    }
};

using LogNeoHookean = LogNeoHookeanBy<PlainLog>;
/// It knows tets that are flat or inside out, and turns them back: for first guesses, never for what is kept.
using ContinuedLogNeoHookean = LogNeoHookeanBy<ContinuedLog>;

} // namespace sinew::solver
