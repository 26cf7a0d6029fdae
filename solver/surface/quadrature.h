// Points of a surface that stand for its area: integrals over painted parts of a skin become sums over them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/surface/paint.h"
#include "solver/surface/sampled_surface.h"

#include <vector>

namespace sinew::solver {

struct SurfaceSample {
    int triangle;  ///< of the surface
    Vec3 place;    ///< barycentric coordinates in it
    Vec3 point;    ///< [m]
    double area;   ///< that it stands for [m^2]
    double weight; ///< painted, interpolated
};

/// Samples of the triangles of a cut surface where the painted weight is above 0: 1, 3 or 6 a triangle, as `density`
/// asks for. Rules of degree 1, 2 and 4 with positive weights and points inside (Strang and Fix 1973).
std::vector<SurfaceSample> quadrature_samples(const SampledSurface& surface, const CornerWeights& paint,
                                              const SurfaceDensity& density);

} // namespace sinew::solver
