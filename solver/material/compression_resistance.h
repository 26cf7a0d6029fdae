// Compression resistance, which artists add to laws that give way when squashed: k (1-J)^3 for J < 1, else nothing;
// twice continuously differentiable at J = 1.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/material/principal.h"
#include "solver/material/tensor_form.h"

namespace sinew::solver {

/// k = c E / ((1 - 2 nu) 2592) with c the artist's number, as in the public VegaFEM 4.0 formulation, so that values
/// known from production keep their meaning.
inline double compression_coefficient(double c, double youngs_modulus, double poissons_ratio) {
    return c * youngs_modulus / ((1 - 2 * poissons_ratio) * 2592);
}
template <class R>
inline void add_compression_resistance(const Strains<R>& e, R k, TensorForm<R>& out) {
    const R d = max(R(1.0) - e.j, R(0.0));
    out.energy += k * d * d * d;
    out.by_j += R(-3.0) * k * d * d;
    out.by_jj += R(6.0) * k * d;
}
template <class R>
inline void add_compression_resistance(const R* s, R k, Principal<R>& out) {
    const R d = max(R(1.0) - s[0] * s[1] * s[2], R(0.0));
    add_volumetric(s, k * d * d * d, R(-3.0) * k * d * d, R(6.0) * k * d, out);
}

} // namespace sinew::solver
