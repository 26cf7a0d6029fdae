// A surface cut along the faces of the tets that carry it: each piece lies in one tet, where it moves by that tet's
// shape functions alone, so that integrals over the surface are exact.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/surface/carrier_tets.h"

#include <array>
#include <vector>

namespace sinew::solver {

/// A triangle, oriented like the one of the surface that it is a part of.
struct SurfacePiece {
    int triangle;                                ///< of the surface
    int tet;                                     ///< that carries it
    std::array<Vec3, 3> place;                   ///< its corners' barycentric coordinates in the surface's triangle
    std::array<std::array<double, 4>, 3> inside; ///< and in the tet; negative where it lies outside of all tets
};

struct ClippedSurface {
    std::vector<SurfacePiece> pieces; ///< by triangles, which they fill without overlap
    std::vector<char> is_outside;     ///< per triangle: a part of it lies in no tet and is carried by the nearest ones
};

/// What lies on a face between tets belongs to one of them. Throws Error FE232 if there are more than 4 million pieces.
ClippedSurface clip_surface(const Points& points, const std::vector<Triangle>& triangles, const CarrierTets& tets);

} // namespace sinew::solver
