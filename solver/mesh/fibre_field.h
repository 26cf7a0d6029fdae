// Which way muscle fibres run between the painted ends of a muscle.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/paint_samples.h"

#include <vector>

namespace sinew::solver {

/// What fibres follow: the gradient in each tet of the harmonic field through whose source as much flows in per area
/// everywhere, and through whose sink out, and nothing through what is not painted. So as many fibres begin on each
/// piece of an end, however broad it is, and run along together from there. (Held at 0 and 1 on the ends, a field
/// leaves a broad end through its rim; behind that it fades by a factor of twenty a thickness, and its direction with
/// it.) Only integrals over the ends enter, so that surfaces may cut through the tets, and fibres that are straight
/// from end to end are straight to rounding. Gradients are zero in connected parts of the tets that lack one of the
/// ends, and in tets all of whose vertices hang on nothing solid. The same bits on every run.
/// \param values  0 where fibres begin, 1 where they end, one per vertex of the surface
/// \param painted at which vertices they do; between vertices of both ends, or of an end and of none, there is no end
/// Throws Error FE212 (no point is painted), FE202 (a painted value is not finite), FE215 (a tet without volume), FE208
/// (a degenerate mesh), and as cut_paint does.
Points fibre_gradients(const TetMesh& mesh, const PaintedSurface& surface, const std::vector<double>& values,
                       const std::vector<char>& painted);
/// Gradients, or means of them over parts of the tets, as unit vectors. Tets that hardly a fibre reaches, with a
/// gradient below a thousandth of what fibres meet in the mean, take the mean direction of their neighbours.
Points fibre_directions(const TetMesh& mesh, Points gradients);

} // namespace sinew::solver
