// Positive semi-definite part of a symmetric 3x3 matrix, by Jacobi rotations without branches.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/svd3.h"

namespace sinew::solver {

/// Diagonalises a symmetric matrix, 9 numbers row-major: a becomes its eigenvalues' diagonal, the columns of q their
/// eigenvectors.
template <class R>
inline void diagonalise_symmetric3(R* a, R* q) {
    for (int i = 0; i < 9; ++i) q[i] = R(i % 4 == 0 ? 1.0 : 0.0);
    constexpr int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (int sweep = 0; sweep < 5; ++sweep)
        for (const auto& pair : pairs) {
            const int p = pair[0], r = pair[1];
            const R d = a[4 * r] - a[4 * p], g = a[3 * p + r];
            const R sign = select(d < R(0.0), R(-1.0), R(1.0));
            const R t = sign * R(2.0) * g / (abs(d) + sqrt(d * d + R(4.0) * g * g) + R(1e-300));
            const R c = R(1.0) / sqrt(R(1.0) + t * t), s = c * t;
            svd3_detail::rotate_columns(a, p, r, c, s);
            svd3_detail::rotate_columns(q, p, r, c, s);
            for (int col = 0; col < 3; ++col) { // rows of a, the other half of J^T a J
                const R u = a[3 * p + col], v = a[3 * r + col];
                a[3 * p + col] = c * u - s * v;
                a[3 * r + col] = s * u + c * v;
            }
        }
}

/// diagonal[3] and off_diagonal[k] = entry of the two indices other than k; negative eigenvalues become zero.
template <class R>
inline void clamp_symmetric3(R* diagonal, R* off_diagonal) {
    R a[9], q[9];
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        a[4 * i] = diagonal[i];
        a[3 * j + k] = a[3 * k + j] = off_diagonal[i];
    }
    diagonalise_symmetric3(a, q);
    R e[3];
    for (int i = 0; i < 3; ++i) e[i] = max(a[4 * i], R(0.0));
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        diagonal[i] = R(0.0), off_diagonal[i] = R(0.0);
        for (int m = 0; m < 3; ++m) {
            diagonal[i] += e[m] * q[3 * i + m] * q[3 * i + m];
            off_diagonal[i] += e[m] * q[3 * j + m] * q[3 * k + m];
        }
    }
}

} // namespace sinew::solver
