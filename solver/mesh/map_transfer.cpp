// Painted maps from one mesh to another.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/map_transfer.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/parallel.h"

#include <algorithm>

namespace sinew::solver {
namespace {

std::vector<MapTransfer::Place> places_on(const Points& points, const std::vector<Triangle>& triangles,
                                          const Points& seekers) {
    const SurfaceTree tree(points, triangles);
    std::vector<MapTransfer::Place> out(seekers.size());
    parallel_for(seekers.size(), 64, [&](std::size_t i) {
        const ClosestPoint c = tree.closest(seekers[i]);
        out[i] = {triangles[at(c.triangle)], c.barycentric};
    });
    return out;
}

void check_size(std::size_t values, std::size_t vertices) {
    if (values != vertices)
        throw Error("FE204",
                    std::to_string(values) + " values for a mesh of " + std::to_string(vertices) + " vertices");
}

constexpr double between = 0.5;

double snapped(double value) { return value >= 0.9 ? 1 : value <= 0.1 ? 0 : between; }

} // namespace

int MapTransfer::Place::nearest() const {
    int best = 0;
    for (int k = 1; k < 3; ++k)
        if (barycentric[k] > barycentric[best]) best = k;
    return corners[at(best)];
}

MapTransfer find_places(const Points& old_points, const std::vector<Triangle>& old_triangles, const Points& new_points,
                        const std::vector<Triangle>& new_triangles) {
    check_usable(SurfaceMesh::from_triangles(old_points, old_triangles));
    check_usable(SurfaceMesh::from_triangles(new_points, new_triangles));
    return {places_on(old_points, old_triangles, new_points), places_on(new_points, new_triangles, old_points)};
}

std::vector<double> transfer_map(const MapTransfer& places, const std::vector<double>& values) {
    check_size(values.size(), places.on_new.size());
    std::vector<double> out;
    for (const MapTransfer::Place& p : places.on_old) {
        double low = values[at(p.corners[0])], high = low, sum = 0;
        for (int k = 0; k < 3; ++k) {
            const double v = values[at(p.corners[at(k)])];
            low = std::min(low, v), high = std::max(high, v);
            sum += p.barycentric[k] * v;
        }
        out.push_back(std::clamp(sum, low, high)); // against rounding
    }
    return out;
}

std::vector<double> transfer_ends(const MapTransfer& places, const std::vector<double>& values) {
    check_size(values.size(), places.on_new.size());
    std::vector<double> out;
    std::vector<char> taken(values.size(), 0);
    for (const MapTransfer::Place& p : places.on_old) {
        const std::size_t from = at(p.nearest());
        out.push_back(snapped(values[from]));
        taken[from] = 1;
    }
    for (std::size_t v = 0; v < values.size(); ++v) {
        double& there = out[at(places.on_new[v].nearest())];
        if (!taken[v] && there == between) there = snapped(values[v]);
    }
    return out;
}

} // namespace sinew::solver
