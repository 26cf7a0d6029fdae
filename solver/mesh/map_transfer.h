// Painted maps from one mesh to another, by the closest point.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

/// Where each vertex of the new mesh lies on the old one, and each vertex of the old one on the new: searched
/// once, used for any number of maps.
struct MapTransfer {
    struct Place {
        Triangle corners{};              ///< vertices of the other mesh
        Vec3 barycentric = Vec3::Zero(); ///< of the closest point
        int nearest() const;             ///< the corner with the largest share; the first of equals
    };
    std::vector<Place> on_old; ///< one per vertex of the new mesh
    std::vector<Place> on_new; ///< one per vertex of the old mesh
};

/// Both meshes in the same place and units. Throws Error FE201 (no triangles), FE202, FE203.
MapTransfer find_places(const Points& old_points, const std::vector<Triangle>& old_triangles, const Points& new_points,
                        const std::vector<Triangle>& new_triangles);

/// Each new vertex takes the value at its closest point on the old mesh, linear on triangles; so values stay
/// within those of the old map, an unchanged mesh keeps its map to the bit, and linear maps come out linear
/// where the new mesh lies on the old one. Throws Error FE204 unless there is one value per old vertex.
std::vector<double> transfer_map(const MapTransfer& places, const std::vector<double>& values);

/// Fibre ends, which must not be blurred: values of 0.9 and more count as 1, of 0.1 and less as 0, all others
/// as 0.5. Each new vertex takes the value of the old vertex nearest to its closest point; then every old end
/// that no new vertex has taken marks the new vertex nearest to it, so that ends survive on a coarser mesh.
/// Throws Error FE204 unless there is one value per old vertex.
std::vector<double> transfer_ends(const MapTransfer& places, const std::vector<double>& values);

} // namespace sinew::solver
