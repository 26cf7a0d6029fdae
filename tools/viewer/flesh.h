// Tets are larger than what they carry: a lattice reaches beyond its flesh, most where the flesh is thin. What is drawn
// of tets and fibres keeps to the flesh.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/viewer/view_data.h"

namespace sinew::viewer {

/// Fills ViewLattice::skin and the fibres' `centre` and `reach`, from the shapes at rest. Fibres of tets that hold
/// nothing of the flesh are left out. An open surface has no inside: there all is drawn as it is in the tets.
void keep_to_flesh(ViewBody& body);

/// Where a lattice's vertices are drawn at `frame`: those beside the flesh on its skin. The body must be there.
Coordinates drawn_lattice(const ViewBody& body, std::size_t frame);

} // namespace sinew::viewer
