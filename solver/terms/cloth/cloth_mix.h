// Material layers of a cloth, composited into one material a vertex.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/step_inputs.h"

namespace sinew::solver {

/// Layers composited bottom to top at each vertex: M_N = a m_N + (1 - a) M_{N-1}, a = envelope x weight; the first
/// layer is opaque.
void mix_layers(const ClothRest& rest, const ClothInputs& in, std::vector<ClothMaterial>& out);
/// What weighs at each vertex of mixed layers: a third of each of its triangles, whose density is the mean of their
/// corners' [kg].
void cloth_masses(const ClothRest& rest, const std::vector<ClothMaterial>& mixed, std::vector<double>& out);

} // namespace sinew::solver
