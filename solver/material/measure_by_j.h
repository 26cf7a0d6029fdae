// The measure of volume J - 1, for laws whose part with lambda is no function of another one.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/material/principal.h"
#include "solver/material/tensor_form.h"

namespace sinew::solver {

struct MeasureByJ {
    template <class R>
    static void measure(const Strains<R>& e, TensorForm<R>& out) {
        clear(out);
        out.energy = e.j - R(1.0);
        out.by_j = R(1.0);
    }
    template <class R>
    static void measure(const R* s, Principal<R>& out) {
        clear(out);
        add_volumetric(s, s[0] * s[1] * s[2] - R(1.0), R(1.0), R(0.0), out);
    }
};

} // namespace sinew::solver
