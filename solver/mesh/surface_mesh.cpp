// Polygon surfaces.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/surface_mesh.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/coordinates.h"
#include "solver/mesh/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace sinew::solver {
SurfaceMesh SurfaceMesh::from_triangles(Points points, std::vector<Triangle> triangles) {
    SurfaceMesh mesh;
    mesh.face_sizes.assign(triangles.size(), 3);
    mesh.face_vertices.reserve(3 * triangles.size());
    for (const Triangle& t : triangles) mesh.face_vertices.insert(mesh.face_vertices.end(), t.begin(), t.end());
    mesh.points = std::move(points);
    mesh.triangles = std::move(triangles);
    return mesh;
}

SurfaceMesh SurfaceMesh::from_polygons(Points points, std::vector<int> face_sizes, std::vector<int> face_vertices) {
    check_faces(points.size(), face_sizes, face_vertices);
    SurfaceMesh mesh;
    std::size_t first = 0;
    for (int size : face_sizes) {
        triangulate_polygon(points, {face_vertices.data() + first, at(size)}, mesh.triangles);
        first += at(size);
    }
    mesh.points = std::move(points);
    mesh.face_sizes = std::move(face_sizes);
    mesh.face_vertices = std::move(face_vertices);
    return mesh;
}

void check_faces(std::size_t vertices, std::span<const int> face_sizes, std::span<const int> face_vertices) {
    const auto text = [](auto number) { return std::to_string(number); };
    std::size_t first = 0;
    for (std::size_t f = 0; f < face_sizes.size(); ++f) {
        const int size = face_sizes[f];
        if (size < 3)
            throw Error("FE208", "face " + text(f) + " has " + text(size) + " corners", "a face has three or more");
        if (face_vertices.size() - first < at(size))
            throw Error("FE208",
                        "the " + text(face_vertices.size()) + " corners end within face " + text(f) + " of " +
                            text(face_sizes.size()),
                        "give as many as the sizes of the faces sum up to");
        for (std::size_t c = 0; c < at(size); ++c)
            if (const int v = face_vertices[first + c]; v < 0 || at(v) >= vertices)
                throw Error("FE203",
                            "corner " + text(c) + " of face " + text(f) + " is vertex " + text(v) + "; there are " +
                                text(vertices) + " vertices, counted from 0",
                            "give the points and the faces of one mesh");
        first += at(size);
    }
    if (first != face_vertices.size())
        throw Error("FE208", text(face_vertices.size()) + " corners, but the faces have " + text(first),
                    "give as many as the sizes of the faces sum up to");
}

void check_usable(const SurfaceMesh& mesh) {
    if (mesh.points.empty()) throw Error("FE201", "the mesh has no vertices");
    if (mesh.triangles.empty()) throw Error("FE201", "the mesh has no faces");
    check_coordinates(mesh.points);
    const int count = static_cast<int>(mesh.points.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int v : mesh.triangles[t])
            if (v < 0 || v >= count)
                throw Error("FE203", "triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " +
                                         std::to_string(count));
}

Box bounding_box(const Points& points) {
    if (points.empty()) return {Vec3::Zero(), Vec3::Zero()};
    Box box{points[0], points[0]};
    for (const Vec3& p : points) {
        box.min = box.min.cwiseMin(p);
        box.max = box.max.cwiseMax(p);
    }
    return box;
}

std::vector<double> vertex_areas(const Points& points, const std::vector<Triangle>& triangles) {
    std::vector<double> areas(points.size(), 0.0);
    for (const Triangle& t : triangles) {
        const Vec3& a = points[at(t[0])];
        const double third = (points[at(t[1])] - a).cross(points[at(t[2])] - a).norm() / 6;
        for (int v : t) areas[at(v)] += third;
    }
    return areas;
}

double enclosed_volume(const Points& points, const std::vector<Triangle>& triangles) {
    if (triangles.empty()) return 0;
    // About a vertex of the mesh: for a closed mesh any origin gives the same, a near one loses no digits.
    const Vec3& origin = points[at(triangles[0][0])];
    double six_volumes = 0;
    for (const Triangle& t : triangles)
        six_volumes += (points[at(t[0])] - origin).dot((points[at(t[1])] - origin).cross(points[at(t[2])] - origin));
    return six_volumes / 6;
}

bool is_closed(const std::vector<Triangle>& triangles) {
    if (triangles.empty()) return false;
    struct Edge {
        int low, high;
        bool forward;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * triangles.size());
    for (const Triangle& t : triangles)
        for (int k = 0; k < 3; ++k) {
            const int a = t[at(k)], b = t[at((k + 1) % 3)];
            if (a == b) return false;
            edges.push_back({std::min(a, b), std::max(a, b), a < b});
        }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        if (a.low != b.low) return a.low < b.low;
        if (a.high != b.high) return a.high < b.high;
        return a.forward < b.forward;
    });
    if (edges.size() % 2) return false;
    for (std::size_t i = 0; i < edges.size(); i += 2) {
        const Edge &a = edges[i], &b = edges[i + 1];
        if (a.low != b.low || a.high != b.high || a.forward == b.forward) return false;
        if (i + 2 < edges.size() && edges[i + 2].low == a.low && edges[i + 2].high == a.high) return false;
    }
    return true;
}

Points vertex_normals(const Points& points, const std::vector<Triangle>& triangles) {
    Points normals(points.size(), Vec3::Zero());
    for (const Triangle& t : triangles) {
        const Vec3& a = points[at(t[0])];
        const Vec3 n = (points[at(t[1])] - a).cross(points[at(t[2])] - a);
        for (int v : t) normals[at(v)] += n;
    }
    for (Vec3& n : normals) {
        const double length = n.norm();
        n = length > 0 ? Vec3(n / length) : Vec3::Zero();
    }
    return normals;
}

} // namespace sinew::solver
