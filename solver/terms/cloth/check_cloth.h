// What a cloth must be to be simulated.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/step_inputs.h"

namespace sinew::solver {

/// Throws Error with the body: FE201 (no faces), FE202 (not finite), FE203 (a face names no vertex), FE204 (layers that
/// do not fit), FE206 (no material), FE270 (an edge of more than two faces), FE271 (a vertex of no face), FE272 (a face
/// without area).
void check_cloth(const ClothRest& cloth, int body);

/// Throws Error with the body: FE304 (a value is not finite), FE273 (a stiffness or density that no step can take),
/// FE247 (a rest scale that leaves no rest shape).
void check_cloth_values(const ClothInputs& values, int body);

} // namespace sinew::solver
