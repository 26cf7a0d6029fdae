// Material layers of a tissue, composited into one material a tet.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/step_inputs.h"
#include "solver/terms/elastic/rest_shape.h"

namespace sinew::solver {

/// Whether both make the same moduli and masses.
bool same_material(const TissueInputs& a, const TissueInputs& b);
/// Layers composited bottom to top: M_N = a m_N + (1 - a) M_{N-1}, a = envelope x weight; the first layer is opaque.
/// \param weights [layer][tet]
MaterialValues mix_layers(const std::vector<MaterialValues>& layers, const std::vector<std::vector<double>>& weights,
                          std::size_t tet);
/// The same of a whole tissue: its own layers and those of its parts, each by its share of the tet.
MaterialValues mix_layers(const TissueRest& rest, const TissueInputs& in, std::size_t tet);
/// What of a tet is the tissue's own, and no part's.
double own_share(const TissueRest& rest, std::size_t tet);
/// Throws Error FE304 that names the body where a value is not a finite number: further on it would only be an energy
/// that is none, of the whole scene. Likewise FE247 where they or the weights of targets leave no rest shape.
void check_values(const TissueInputs& in, const RestShapes& shapes, int body);

} // namespace sinew::solver
