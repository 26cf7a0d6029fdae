// Numbers that rounding alone tells apart count as equal, so that a mesh gives the same tets wherever it stands: what
// is chosen by size goes by order where sizes tie, and they do all over a lattice.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

namespace sinew::solver {

/// `value` in steps of a sixteen-millionth of `unit`, which is of about its size. Numbers to be compared take the same
/// unit.
inline double rounded_off(double value, double unit) {
    constexpr double steps = 1 << 24;
    return std::round(value / unit * steps);
}

/// Of two of any size.
inline bool clearly_less(double a, double b) { return a < (1 - 1e-9) * b; }

} // namespace sinew::solver
