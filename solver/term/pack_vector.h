// Vectors of packs, for kernels over several stencils at once.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/simd.h"

#include <array>

namespace sinew::solver {

struct PackVector {
    Pack x, y, z;
    friend PackVector operator+(PackVector a, PackVector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend PackVector operator-(PackVector a, PackVector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend PackVector operator*(Pack s, PackVector a) { return {s * a.x, s * a.y, s * a.z}; }
    friend Pack dot(PackVector a, PackVector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    friend PackVector cross(PackVector a, PackVector b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
};

inline PackVector select(Pack::Mask m, PackVector a, PackVector b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// 3 x 3 numbers, row-major.
using PackMatrix = std::array<Pack, 9>;

/// The matrix of u -> v x u.
inline PackMatrix cross_matrix(PackVector v) {
    const Pack zero(0.0);
    return {zero, -v.z, v.y, v.z, zero, -v.x, -v.y, v.x, zero};
}

/// m += a b^T.
inline void add_outer(PackMatrix& m, PackVector a, PackVector b) {
    const Pack rows[3] = {a.x, a.y, a.z}, columns[3] = {b.x, b.y, b.z};
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) m[3 * r + c] += rows[r] * columns[c];
}

} // namespace sinew::solver
