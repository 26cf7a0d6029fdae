// Pieces of a muscle's mesh that lie away from what holds the muscle.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/reach.h"

namespace sinew::rig {

/// Warns (DG158) of muscles that are held, but of whose meshes a piece is neither painted nor touches anything, nor
/// lies within a tet of a piece that does: it would fall.
void doubt_loose_pieces(Rig& rig, const AllDistances& all);

} // namespace sinew::rig
