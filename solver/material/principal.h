// Isotropic laws as functions of the principal stretches. A law gives its energy, first and second derivatives and the
// two quotients that make up the Hessian's other six eigenvalues, each in closed form without a division by a
// difference of stretches. With F = U diag(s) V^T the 9x9 Hessian of the energy in the frame of U and V is
//   - the 3x3 block d2psi/ds_i ds_j on the diagonal entries of dF,
//   - for each pair (i,j): flip  = (psi_i - psi_j)/(s_i - s_j) on the symmetric mode  (dF_ij + dF_ji)/sqrt 2,
//                          twist = (psi_i + psi_j)/(s_i + s_j) on the antisymmetric mode (dF_ij - dF_ji)/sqrt 2
// (Smith, de Goes, Kim 2019, "Analytic eigensystems for isotropic distortion energies", section 4; Zhu 2021).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/simd.h"

namespace sinew::solver {

/// Lamé parameters [Pa] of linear elasticity.
struct Lame {
    double mu, lambda;
};
inline Lame lame(double youngs_modulus, double poissons_ratio) {
    return {youngs_modulus / (2 * (1 + poissons_ratio)),
            youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio))};
}

/// Values of a law at one s. Pair k is (i,j) = the two indices other than k. All [Pa].
template <class R>
struct Principal {
    R energy;
    R first[3];
    R diagonal[3], off_diagonal[3]; ///< second derivatives; off_diagonal[k] belongs to pair k
    R flip[3], twist[3];
};

/// Adds a function g(J) of J = s0 s1 s2, given its value and derivatives.
template <class R>
inline void add_volumetric(const R* s, R g, R g1, R g2, Principal<R>& out) {
    const R j[3] = {s[1] * s[2], s[0] * s[2], s[0] * s[1]};
    out.energy += g;
    for (int i = 0; i < 3; ++i) {
        const int a = (i + 1) % 3, b = (i + 2) % 3;
        out.first[i] += g1 * j[i];
        out.diagonal[i] += g2 * j[i] * j[i];
        out.off_diagonal[i] += g2 * j[a] * j[b] + g1 * s[i];
        out.flip[i] -= g1 * s[i];
        out.twist[i] += g1 * s[i];
    }
}

template <class R>
inline void clear(Principal<R>& out) {
    out.energy = R(0.0);
    for (int i = 0; i < 3; ++i)
        out.first[i] = out.diagonal[i] = out.off_diagonal[i] = out.flip[i] = out.twist[i] = R(0.0);
}

} // namespace sinew::solver
