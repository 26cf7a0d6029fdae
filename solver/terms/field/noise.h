// Smooth noise in space and time: gradient noise (Perlin 1985, with the quintic blend of Perlin 2002) over a grid of
// four dimensions, three components. No tables and no state: gradients come from mixing the grid's numbers (SplitMix64,
// Steele et al. 2014), so the same place and time give the same bits on every machine.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/field/dual.h"

#include <cstdint>

namespace sinew::solver {

/// Noise of grid size 1: its mean is 0, its root mean square over all space (of the vector's length) is 1, its second
/// derivatives are continuous. `T`: double, or Dual for derivatives. Time is in grid cells, without a derivative along
/// it; another layer is another noise.
template <class T>
Triple<T> noise(const Triple<T>& place, double time, int layer);

} // namespace sinew::solver
