// A first path for a line of action: through the middles of a muscle's sections from origin to insertion.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/paint_samples.h"

#include <vector>

namespace sinew::solver {

/// The middle of the area where `field`, linear in each tet, takes a value; areas count by the tets' coverage. Zero
/// vector and false where it takes it nowhere.
bool section_middle(const TetMesh& mesh, const std::vector<double>& field, double value, Vec3& middle);
/// `count` points, two or more: the middle of the painted source, of sections at evenly rising values of the harmonic
/// field between the painted ends, with values within theirs, and of the painted sink. Sections that are nowhere
/// are left out. Any unit of length.
/// \param ends per vertex of the surface: 0 source, 1 sink; where `painted`, else free
/// Throws Error as harmonic_extensions does.
Points muscle_path(const TetMesh& mesh, const PaintedSurface& surface, const std::vector<double>& ends,
                   const std::vector<char>& painted, int count);

} // namespace sinew::solver
