// Polygon surfaces: n-gons as they were read, and the triangles that the simulation uses.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <span>
#include <vector>

namespace sinew::solver {

struct SurfaceMesh {
    Points points;
    std::vector<int> face_sizes;     ///< corners of each polygon, >= 3
    std::vector<int> face_vertices;  ///< corner indices, faces one after the other
    std::vector<Triangle> triangles; ///< the polygons, triangulated; same orientation

    /// From triangles alone.
    static SurfaceMesh from_triangles(Points points, std::vector<Triangle> triangles);
    /// From polygons; triangulates each (fan for convex, ear clipping otherwise). Throws Error FE203/FE208.
    static SurfaceMesh from_polygons(Points points, std::vector<int> face_sizes, std::vector<int> face_vertices);
};

/// Faces that are no faces of `vertices` points. Throws Error FE208 (fewer than three corners, or another number of
/// them than the sizes sum up to) and FE203 (a corner that is no vertex), with the first such face.
void check_faces(std::size_t vertices, std::span<const int> face_sizes, std::span<const int> face_vertices);

/// Throws Error FE201 (empty), FE202 (NaN or infinite, with the first vertex), FE203 (index out of range).
void check_usable(const SurfaceMesh& mesh);

struct Box {
    Vec3 min, max;
    Vec3 size() const { return max - min; }
    Vec3 centre() const { return 0.5 * (min + max); }
};
Box bounding_box(const Points& points);

/// Area of each vertex: a third of its triangles' areas [m^2].
std::vector<double> vertex_areas(const Points& points, const std::vector<Triangle>& triangles);
/// Signed volume enclosed by a closed, outward oriented mesh.
double enclosed_volume(const Points& points, const std::vector<Triangle>& triangles);
/// Every edge has exactly two triangles of opposite direction.
bool is_closed(const std::vector<Triangle>& triangles);
/// Area-weighted vertex normals, unit length (zero where undefined).
Points vertex_normals(const Points& points, const std::vector<Triangle>& triangles);

} // namespace sinew::solver
