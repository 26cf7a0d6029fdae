// Integration points of a tet that is solid in part.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_moments.h"

namespace sinew::solver {

/// Four points of equal weight that integrate polynomials of degree 2 over part of a tet exactly, as the usual four do
/// over a whole one. Any such points are the mean plus the roots of the covariance times the corners of a regular tet,
/// in one of its turns (Stroud 1957); the turn taken is the one that comes closest to the third moments too, which
/// turns the corners to where the part has its own. For a whole tet they are the usual points, up to their order; for
/// whatever planes cut off they lie inside; for parts with dents or in pieces they may lie between.
struct FourPoints {
    std::array<Barycentric, 4> point;
    bool exact = true; ///< false: points would lie outside of the tet and were drawn in; then exact to degree 1
};
/// \param quartic moments of degree 4 (tet_moments.h) of a measure in the tet that is spread in three dimensions
FourPoints four_points(const double* quartic);

} // namespace sinew::solver
