// Isotropic laws without singular values: as functions of the Green strain E and of J = det F, with
//   P = F S + by_j cof F,  S = uniform I + green E + constant,
// where `uniform` depends on tr E only and `green` and `constant` do not depend on F. All that a step needs except the
// projection, which wants eigenvalues and takes the law in principal stretches (principal.h): the singular values cost
// more than all the rest.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/simd.h"

namespace sinew::solver {

/// What such laws read. Matrices are row-major; symmetric ones are kept whole.
template <class R>
struct Strains {
    R f[9], green[9], cofactor[9]; ///< F, E = (F^T F - I)/2, dJ/dF
    R trace, j;                    ///< tr E, det F
};

template <class R>
inline void set_strains(const R* f, Strains<R>& out) {
    for (int i = 0; i < 9; ++i) out.f[i] = f[i];
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) {
            const R c = f[i] * f[j] + f[3 + i] * f[3 + j] + f[6 + i] * f[6 + j];
            out.green[3 * i + j] = out.green[3 * j + i] = R(0.5) * (i == j ? c - R(1.0) : c);
        }
    out.trace = out.green[0] + out.green[4] + out.green[8];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            out.cofactor[3 * i + j] = f[3 * a + c] * f[3 * b + d] - f[3 * a + d] * f[3 * b + c];
        }
    out.j = f[0] * out.cofactor[0] + f[1] * out.cofactor[1] + f[2] * out.cofactor[2];
}

/// Energy density and its derivatives [Pa].
template <class R>
struct TensorForm {
    R energy;
    R uniform, uniform_slope; ///< of S; the slope by tr E
    R green;                  ///< of S
    R constant[6];            ///< of S: 00 11 22 12 02 01
    R by_j, by_jj;            ///< first and second derivative by J
};

template <class R>
inline void clear(TensorForm<R>& out) {
    out.energy = out.uniform = out.uniform_slope = out.green = out.by_j = out.by_jj = R(0.0);
    for (R& c : out.constant) c = R(0.0);
}

/// S [Pa].
template <class R>
inline void second_stress(const Strains<R>& e, const TensorForm<R>& law, R* s) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        s[4 * i] = law.uniform + law.green * e.green[4 * i] + law.constant[i];
        s[3 * j + k] = s[3 * k + j] = law.green * e.green[3 * j + k] + law.constant[3 + i];
    }
}

/// P [Pa].
template <class R>
inline void tensor_stress(const Strains<R>& e, const TensorForm<R>& law, R* p) {
    R s[9];
    second_stress(e, law, s);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            p[3 * i + j] = e.f[3 * i] * s[j] + e.f[3 * i + 1] * s[3 + j] + e.f[3 * i + 2] * s[6 + j] +
                           law.by_j * e.cofactor[3 * i + j];
}

/// Hessian blocks of the nodes a <= b of 0…2 with shape gradients n[a], times `factor`; order 00 01 02 11 12 22,
/// row-major. Not `geometric`: without the part of S, which may be negative; what is left of a form without by_j is
/// not.
template <bool geometric = true, class R>
inline void tensor_blocks(const Strains<R>& e, const TensorForm<R>& law, const R n[3][3], R factor, R blocks[6][9]) {
    const auto times = [](const R* m, const R* v, R* out) {
        for (int i = 0; i < 3; ++i) out[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
    };
    const R slope = factor * law.uniform_slope, half_green = factor * R(0.5) * law.green, jj = factor * law.by_jj;
    R fn[3][3], cn[3][3], sn[3][3], s[9]; // F n, cof F n, factor S n
    second_stress(e, law, s);
    for (int a = 0; a < 3; ++a) {
        times(e.f, n[a], fn[a]);
        times(e.cofactor, n[a], cn[a]);
        times(s, n[a], sn[a]);
        for (int i = 0; i < 3; ++i) sn[a][i] *= geometric ? factor : R(0.0);
    }
    R left[9]; // factor green/2 F F^T
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            left[3 * i + j] = left[3 * j + i] =
                half_green *
                (e.f[3 * i] * e.f[3 * j] + e.f[3 * i + 1] * e.f[3 * j + 1] + e.f[3 * i + 2] * e.f[3 * j + 2]);
    int index = 0;
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++index) {
            R* k = blocks[index];
            const R nn = n[a][0] * n[b][0] + n[a][1] * n[b][1] + n[a][2] * n[b][2];
            const R by_stress = sn[a][0] * n[b][0] + sn[a][1] * n[b][1] + sn[a][2] * n[b][2];
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    k[3 * i + j] = slope * fn[a][i] * fn[b][j] + half_green * fn[b][i] * fn[a][j] +
                                   nn * left[3 * i + j] + jj * cn[a][i] * cn[b][j] + (i == j ? by_stress : R(0.0));
            if (a == b) continue;
            // d cof F: the cross product with F (n_a x n_b).
            const R across[3] = {n[a][1] * n[b][2] - n[a][2] * n[b][1], n[a][2] * n[b][0] - n[a][0] * n[b][2],
                                 n[a][0] * n[b][1] - n[a][1] * n[b][0]};
            R w[3];
            times(e.f, across, w);
            for (int i = 0; i < 3; ++i) {
                const int p = (i + 1) % 3, q = (i + 2) % 3;
                const R entry = factor * law.by_j * w[i];
                k[3 * p + q] += entry;
                k[3 * q + p] -= entry;
            }
        }
}

} // namespace sinew::solver
