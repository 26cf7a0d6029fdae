// Singular value decomposition F = U diag(s) V^T of a 3x3 matrix with U and V rotations: the least singular value
// carries the sign of det F, so an inverted element is seen as such (Irving, Teran, Fedkiw 2004, "Invertible finite
// elements", section 4). One-sided Jacobi, which keeps small singular values accurate; no branches, so that it runs
// on packs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/simd.h"

namespace sinew::solver {

/// Matrices are row-major arrays of 9.
template <class R>
struct Svd3 {
    R u[9], s[3], v[9];
};

namespace svd3_detail {

template <class R>
inline void rotate_columns(R* m, int p, int q, R c, R s) {
    for (int r = 0; r < 3; ++r) {
        const R a = m[3 * r + p], b = m[3 * r + q];
        m[3 * r + p] = c * a - s * b;
        m[3 * r + q] = s * a + c * b;
    }
}

template <class R>
inline R column_dot(const R* m, int p, int q) {
    return m[p] * m[q] + m[3 + p] * m[3 + q] + m[6 + p] * m[6 + q];
}

/// Makes columns p and q of b orthogonal, and turns v alike.
template <class R>
inline void orthogonalise(R* b, R* v, int p, int q) {
    const R alpha = column_dot(b, p, p), beta = column_dot(b, q, q), gamma = column_dot(b, p, q);
    const R d = beta - alpha;
    const R sign = select(d < R(0.0), R(-1.0), R(1.0));
    // The tiny term keeps 0/0 out when both columns vanish or are already orthogonal and of equal length.
    const R t = sign * R(2.0) * gamma / (abs(d) + sqrt(d * d + R(4.0) * gamma * gamma) + R(1e-300));
    const R c = R(1.0) / sqrt(R(1.0) + t * t);
    rotate_columns(b, p, q, c, c * t);
    rotate_columns(v, p, q, c, c * t);
}

/// Puts the longer of columns p, q first; swaps with a sign so that v stays a rotation.
template <class R>
inline void order(R* b, R* v, int p, int q) {
    const auto shorter = column_dot(b, p, p) < column_dot(b, q, q);
    for (R* m : {b, v})
        for (int r = 0; r < 3; ++r) {
            const R a = m[3 * r + p], c = m[3 * r + q];
            m[3 * r + p] = select(shorter, c, a);
            m[3 * r + q] = select(shorter, -a, c);
        }
}

} // namespace svd3_detail

template <class R>
inline void svd3(const R* f, Svd3<R>& out) {
    using namespace svd3_detail;
    R b[9], *v = out.v, *u = out.u;
    for (int i = 0; i < 9; ++i) b[i] = f[i], v[i] = R(i % 4 == 0 ? 1.0 : 0.0);
    // Cyclic Jacobi converges quadratically; five sweeps reach rounding for every 3x3 matrix tried (tests: 1e5 random,
    // graded and singular ones).
    for (int sweep = 0; sweep < 5; ++sweep) {
        orthogonalise(b, v, 0, 1);
        orthogonalise(b, v, 0, 2);
        orthogonalise(b, v, 1, 2);
    }
    order(b, v, 0, 1);
    order(b, v, 0, 2);
    order(b, v, 1, 2);

    const R tiny(1e-290);
    const R n0 = sqrt(column_dot(b, 0, 0));
    const auto none = n0 < tiny; // F = 0: any rotation will do
    R u0[3], u1[3];
    for (int r = 0; r < 3; ++r) u0[r] = select(none, R(r == 0 ? 1.0 : 0.0), b[3 * r] / max(n0, tiny));
    const R along = u0[0] * b[1] + u0[1] * b[4] + u0[2] * b[7];
    for (int r = 0; r < 3; ++r) u1[r] = b[3 * r + 1] - along * u0[r];
    const R n1 = sqrt(u1[0] * u1[0] + u1[1] * u1[1] + u1[2] * u1[2]);
    // Rank one: any direction across u0, taken from the axis that u0 is farthest from.
    const auto flat = n1 < R(1e-15) * n0 + tiny;
    const auto x_small = abs(u0[0]) < R(0.6);
    const R ex = select(x_small, R(1.0), R(0.0)), ey = select(x_small, R(0.0), R(1.0));
    const R e_along = ex * u0[0] + ey * u0[1];
    const R px = ex - e_along * u0[0], py = ey - e_along * u0[1], pz = -e_along * u0[2];
    const R pn = sqrt(px * px + py * py + pz * pz);
    const R inv1 = R(1.0) / max(n1, tiny), invp = R(1.0) / pn;
    u1[0] = select(flat, px * invp, u1[0] * inv1);
    u1[1] = select(flat, py * invp, u1[1] * inv1);
    u1[2] = select(flat, pz * invp, u1[2] * inv1);
    const R u2[3] = {u0[1] * u1[2] - u0[2] * u1[1], u0[2] * u1[0] - u0[0] * u1[2], u0[0] * u1[1] - u0[1] * u1[0]};
    for (int r = 0; r < 3; ++r) u[3 * r] = u0[r], u[3 * r + 1] = u1[r], u[3 * r + 2] = u2[r];
    out.s[0] = n0;
    out.s[1] = u1[0] * b[1] + u1[1] * b[4] + u1[2] * b[7];
    out.s[2] = u2[0] * b[2] + u2[1] * b[5] + u2[2] * b[8];
}

} // namespace sinew::solver
