// A body's surface with triangles as small as the tets that carry it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/surface/carrier_tets.h"

#include <array>
#include <vector>

namespace sinew::solver {

/// How dense a surface must be for what carries it: the tets of a body, or of both bodies that it ties together. None =
/// rigid, any density will do.
struct SurfaceDensity {
    struct Carrier {
        const CarrierTets* tets;
        ElementKind element;
    };
    std::vector<Carrier> carriers;
    double longest_edge = 0; ///< no edge may be longer [m]; 0 = any may
    double widths = 0.75;    ///< nor longer than so many widths of a tet that it passes

    /// Whether an edge is longer than the stated share of the tets that it passes (`widths` of them along it; judged at
    /// five points). Depends on the edge alone, so both triangles at it agree.
    bool too_long(const Vec3& a, const Vec3& b) const;
    /// Degree of polynomials that integration over a triangle of this size must be exact for: that of the square of
    /// what the tets carry (2, quadratic ones 4), or 1 where the triangle is much smaller than they are.
    int degree(const Vec3& a, const Vec3& b, const Vec3& c) const;
};

/// Triangles of a surface, cut in halves at their long edges. Conforming: no vertex lies inside of another triangle's
/// edge, so a closed surface stays closed.
struct SampledSurface {
    Points points;                           ///< the surface's vertices, then the middles of edges [m]
    std::vector<Triangle> triangles;         ///< oriented like those they come from
    std::vector<int> source;                 ///< per triangle: the one of the surface that it is a part of
    std::vector<std::array<Vec3, 3>> places; ///< per triangle: its corners' barycentric coordinates in that one
};

/// Cuts the triangles `which` of a surface. Throws Error FE232 if that would give more than 4 million.
SampledSurface cut_surface(const Points& points, const std::vector<Triangle>& triangles, const std::vector<int>& which,
                           const SurfaceDensity& density);

} // namespace sinew::solver
