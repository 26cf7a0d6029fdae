// How far zIsoMesh's result is from what it shall be: the level set of the polygons' distance.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

namespace sinew::solver {

struct IsoDeviation {
    double distance = 0; ///< largest of those measured
    Vec3 place = Vec3::Zero();
    /// Of the result to that of the polygons, for an iso value of 0 around closed polygons that neither overlap nor are
    /// in part turned inside out; NaN where it cannot be told.
    double volume_ratio = 0;
};

/// Both one-sided distances between the result and the level set (Hausdorff's is the larger one), at vertices and
/// triangles' middles, evenly thinned out to 20,000 triangles of each mesh: of the result's points to the level set,
/// and, for iso >= 0, of the polygons' points to where the result should be, at least iso farther out. Parts of
/// polygons that lie within others count for nothing. Throws Error FE201 to FE203, FE224.
IsoDeviation measure_iso_mesh(const Points& points, const std::vector<Triangle>& triangles, double iso,
                              const Points& result_points, const std::vector<Triangle>& result_triangles);

} // namespace sinew::solver
