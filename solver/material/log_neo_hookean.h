// Neo-Hookean with logarithms (Bonet and Wood): psi = mu/2 (I_C - 3) - mu ln J + lambda/2 (ln J)^2. The form that
// textbooks and engineering codes compare by. It is infinite at J = 0 and not defined beyond, so nothing that starts
// inverted can come back; for animation take the stable form (neo_hookean.h).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/material/principal.h"
#include "solver/material/tensor_form.h"

namespace sinew::solver {

struct LogNeoHookean {
    /// Not a number for J <= 0, which the line search refuses.
    template <class R>
    static void energy(const Strains<R>& e, R mu, R lambda, TensorForm<R>& out) {
        clear(out);
        const R inverse = R(1.0) / e.j, l = log(e.j);
        out.energy = mu * e.trace + (R(0.5) * lambda * l - mu) * l;
        out.uniform = mu;
        out.by_j = (lambda * l - mu) * inverse;
        out.by_jj = (lambda * (R(1.0) - l) + mu) * inverse * inverse;
    }
    template <class R>
    static void energy(const R* s, R mu, R lambda, Principal<R>& out) {
        clear(out);
        out.energy = R(0.5) * mu * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - R(3.0));
        for (int i = 0; i < 3; ++i) {
            out.first[i] = mu * s[i];
            out.diagonal[i] = out.flip[i] = out.twist[i] = mu;
        }
        const R j = s[0] * s[1] * s[2], inverse = R(1.0) / j, l = log(j);
        add_volumetric(s, (R(0.5) * lambda * l - mu) * l, (lambda * l - mu) * inverse,
                       (lambda * (R(1.0) - l) + mu) * inverse * inverse, out);
    }

    /// Its measure of volume, ln J: the part with lambda is lambda/2 (ln J)^2.
    template <class R>
    static void measure(const Strains<R>& e, TensorForm<R>& out) {
        clear(out);
        out.energy = log(e.j);
        out.by_j = R(1.0) / e.j;
        out.by_jj = -out.by_j * out.by_j;
    }
    template <class R>
    static void measure(const R* s, Principal<R>& out) {
        clear(out);
        const R j = s[0] * s[1] * s[2], inverse = R(1.0) / j;
        add_volumetric(s, log(j), inverse, -inverse * inverse, out);
    }
};

/// The same with ln J continued below a small J by its second-order Taylor series there, so that it knows tets that are
/// flat or inside out, and turns them back: for first guesses, never for what is kept.
struct ContinuedLogNeoHookean {
    /// Above it the law is its own. Smaller ones turn tets back more surely, and bend the energy more sharply there.
    static constexpr double least_j = 0.03;

    template <class R>
    struct Log {
        R value, first, second;
        explicit Log(R j) {
            const auto below = j < R(least_j);
            const R there = select(below, R(least_j), j), beyond = (j - there) / there;
            value = log(there) + beyond - R(0.5) * beyond * beyond;
            first = (R(1.0) - beyond) / there;
            second = -R(1.0) / (there * there);
        }
    };
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

} // namespace sinew::solver
