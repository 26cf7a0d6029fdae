// Primitive meshes with Maya's conventions.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"

#include "solver/error.h"

#include <cmath>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <string>

namespace sinew::solver {
namespace {

void require_sizes(std::initializer_list<double> sizes) {
    for (double s : sizes)
        if (!(s > 0) || !std::isfinite(s))
            throw Error("FE222", "a primitive's size must be positive, not " + std::to_string(s));
}

void require_count(int count, int least, const char* what) {
    if (count < least || count > 4096)
        throw Error("FE222", std::string(what) + " must lie in " + std::to_string(least) + " to 4096, not " +
                                 std::to_string(count));
}

/// Corner j of a ring of n about the y axis. Maya's first corner stands one step from the x axis, towards -z.
Vec3 on_ring(int j, int n, double radius, double y) {
    const double angle = 2 * std::numbers::pi * (j + 1) / n;
    return {radius * std::cos(angle), y, -radius * std::sin(angle)};
}

struct Faces {
    std::vector<int> sizes, corners;
    void add(std::initializer_list<int> face) {
        sizes.push_back(static_cast<int>(face.size()));
        corners.insert(corners.end(), face);
    }
    /// Quads between two rings of n corners; seen from outside the second ring is above the first.
    void add_band(int lower, int upper, int n) {
        for (int j = 0; j < n; ++j) {
            const int k = (j + 1) % n;
            add({lower + j, lower + k, upper + k, upper + j});
        }
    }
    /// Triangles between a ring and a point above it.
    void add_cap(int ring, int apex, int n, bool apex_is_above) {
        for (int j = 0; j < n; ++j) {
            const int k = (j + 1) % n;
            if (apex_is_above)
                add({ring + j, ring + k, apex});
            else
                add({ring + k, ring + j, apex});
        }
    }
    /// One n-gon that closes a ring.
    void add_lid(int ring, int n, bool faces_up) {
        sizes.push_back(n);
        for (int j = 0; j < n; ++j) corners.push_back(faces_up ? ring + j : ring + n - 1 - j);
    }
};

} // namespace

SurfaceMesh make_sphere(double radius, int subdivisions_axis, int subdivisions_height) {
    require_sizes({radius});
    require_count(subdivisions_axis, 3, "subdivisions about the axis");
    require_count(subdivisions_height, 2, "subdivisions along the height");
    const int n = subdivisions_axis, rings = subdivisions_height - 1;
    Points points;
    Faces faces;
    for (int i = 1; i <= rings; ++i) {
        const double latitude = std::numbers::pi * (static_cast<double>(i) / subdivisions_height - 0.5);
        for (int j = 0; j < n; ++j)
            points.push_back(on_ring(j, n, radius * std::cos(latitude), radius * std::sin(latitude)));
    }
    const int south = rings * n, north = south + 1;
    points.emplace_back(0, -radius, 0);
    points.emplace_back(0, radius, 0);
    for (int i = 0; i + 1 < rings; ++i) faces.add_band(i * n, (i + 1) * n, n);
    faces.add_cap(0, south, n, false);
    faces.add_cap((rings - 1) * n, north, n, true);
    return SurfaceMesh::from_polygons(std::move(points), std::move(faces.sizes), std::move(faces.corners));
}

SurfaceMesh make_cube(double width, double height, double depth, int sub_width, int sub_height, int sub_depth) {
    require_sizes({width, height, depth});
    require_count(sub_width, 1, "subdivisions along the width");
    require_count(sub_height, 1, "subdivisions along the height");
    require_count(sub_depth, 1, "subdivisions along the depth");
    // Rows of sub_width + 1 vertices wind about the x axis: up the front (+z), back over the top, down the
    // back, forward below. The inner vertices of the right and the left side follow.
    const int columns = sub_width + 1, around = 2 * (sub_height + sub_depth);
    Points points;
    const auto y_of = [&](int i) { return height * (static_cast<double>(i) / sub_height - 0.5); };
    const auto z_of = [&](int i) { return depth * (0.5 - static_cast<double>(i) / sub_depth); };
    const auto row_place = [&](int row) -> std::array<int, 2> { // steps up, steps back
        if (row <= sub_height) return {row, 0};
        if (row <= sub_height + sub_depth) return {sub_height, row - sub_height};
        if (row <= 2 * sub_height + sub_depth) return {2 * sub_height + sub_depth - row, sub_depth};
        return {0, around - row};
    };
    for (int row = 0; row < around; ++row) {
        const auto [up, back] = row_place(row);
        for (int i = 0; i < columns; ++i)
            points.emplace_back(width * (static_cast<double>(i) / sub_width - 0.5), y_of(up), z_of(back));
    }
    Faces faces;
    for (int row = 0; row < around; ++row) {
        const int a = row * columns, b = (row + 1) % around * columns;
        for (int i = 0; i < sub_width; ++i) faces.add({a + i, a + i + 1, b + i + 1, b + i});
    }
    for (int side : {1, 0}) { // right, left
        const int first = static_cast<int>(points.size());
        for (int back = 1; back < sub_depth; ++back)
            for (int up = 1; up < sub_height; ++up) points.emplace_back(width * (side - 0.5), y_of(up), z_of(back));
        const auto vertex = [&](int up, int back) {
            const int column = side * sub_width;
            if (back == 0) return up * columns + column;
            if (up == sub_height) return (sub_height + back) * columns + column;
            if (back == sub_depth) return (2 * sub_height + sub_depth - up) * columns + column;
            if (up == 0) return (around - back) * columns + column;
            return first + (back - 1) * (sub_height - 1) + up - 1;
        };
        for (int back = 0; back < sub_depth; ++back)
            for (int up = 0; up < sub_height; ++up) {
                const int a = vertex(up, back), b = vertex(up, back + 1), c = vertex(up + 1, back + 1),
                          d = vertex(up + 1, back);
                if (side == 1)
                    faces.add({a, b, c, d});
                else
                    faces.add({b, a, d, c});
            }
    }
    return SurfaceMesh::from_polygons(std::move(points), std::move(faces.sizes), std::move(faces.corners));
}

SurfaceMesh make_plane(double width, double height, int sub_width, int sub_height) {
    require_sizes({width, height});
    require_count(sub_width, 1, "subdivisions along the width");
    require_count(sub_height, 1, "subdivisions along the height");
    Points points;
    Faces faces;
    for (int j = 0; j <= sub_height; ++j)
        for (int i = 0; i <= sub_width; ++i)
            points.emplace_back(width * (static_cast<double>(i) / sub_width - 0.5), 0,
                                height * (0.5 - static_cast<double>(j) / sub_height));
    const int columns = sub_width + 1;
    for (int j = 0; j < sub_height; ++j)
        for (int i = 0; i < sub_width; ++i) {
            const int a = j * columns + i;
            faces.add({a, a + 1, a + 1 + columns, a + columns});
        }
    return SurfaceMesh::from_polygons(std::move(points), std::move(faces.sizes), std::move(faces.corners));
}

SurfaceMesh make_cylinder(double radius, double height, int sub_axis, int sub_height, int sub_caps) {
    require_sizes({radius, height});
    require_count(sub_axis, 3, "subdivisions about the axis");
    require_count(sub_height, 1, "subdivisions along the height");
    require_count(sub_caps, 0, "subdivisions of the caps");
    const int n = sub_axis;
    Points points;
    Faces faces;
    for (int i = 0; i <= sub_height; ++i)
        for (int j = 0; j < n; ++j)
            points.push_back(on_ring(j, n, radius, height * (static_cast<double>(i) / sub_height - 0.5)));
    for (int i = 0; i < sub_height; ++i) faces.add_band(i * n, (i + 1) * n, n);
    for (bool is_top : {false, true}) {
        int outer = is_top ? sub_height * n : 0;
        const double y = is_top ? 0.5 * height : -0.5 * height;
        if (sub_caps == 0) {
            faces.add_lid(outer, n, is_top);
            continue;
        }
        for (int ring = 1; ring < sub_caps; ++ring) {
            const int inner = static_cast<int>(points.size());
            for (int j = 0; j < n; ++j) points.push_back(on_ring(j, n, radius * (sub_caps - ring) / sub_caps, y));
            if (is_top)
                faces.add_band(outer, inner, n);
            else
                faces.add_band(inner, outer, n);
            outer = inner;
        }
        points.emplace_back(0, y, 0);
        faces.add_cap(outer, static_cast<int>(points.size()) - 1, n, is_top);
    }
    return SurfaceMesh::from_polygons(std::move(points), std::move(faces.sizes), std::move(faces.corners));
}

SurfaceMesh make_helix(double radius, double tube_radius, double height, double coils, int sub_axis, int sub_coil) {
    require_sizes({radius, tube_radius, coils});
    if (!(height >= 0) || !std::isfinite(height)) throw Error("FE222", "a helix' height must not be negative");
    if (!(tube_radius < radius)) throw Error("FE222", "the tube of a helix must be thinner than the helix is wide");
    require_count(sub_axis, 3, "subdivisions about the tube");
    require_count(sub_coil, 3, "subdivisions of a coil");
    const double exact = coils * sub_coil;
    if (exact > 1e6) throw Error("FE222", "the helix would have over a million rings");
    const int segments = std::max(1, static_cast<int>(std::lround(exact)));
    Points points;
    Faces faces;
    for (int i = 0; i <= segments; ++i) {
        const double t = static_cast<double>(i) / segments, angle = 2 * std::numbers::pi * coils * t;
        const Vec3 out(std::cos(angle), 0, -std::sin(angle)); // from the axis, turning like a ring's corners
        const Vec3 around(-std::sin(angle), 0, -std::cos(angle));
        const Vec3 tangent = (radius * 2 * std::numbers::pi * coils * around + Vec3(0, height, 0)).normalized();
        const Vec3 up = tangent.cross(out); // out, up, and the way back make a right-handed frame
        const Vec3 middle = radius * out + Vec3(0, height * (t - 0.5), 0);
        for (int j = 0; j < sub_axis; ++j) {
            const double a = 2 * std::numbers::pi * j / sub_axis;
            points.push_back(middle + tube_radius * (std::cos(a) * out + std::sin(a) * up));
        }
    }
    for (int i = 0; i < segments; ++i) faces.add_band(i * sub_axis, (i + 1) * sub_axis, sub_axis);
    faces.add_lid(0, sub_axis, false);
    faces.add_lid(segments * sub_axis, sub_axis, true);
    return SurfaceMesh::from_polygons(std::move(points), std::move(faces.sizes), std::move(faces.corners));
}

} // namespace sinew::solver
