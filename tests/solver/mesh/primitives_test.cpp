// Primitives: counts, orientation, volumes, Maya's numbering.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/primitives.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace sinew::solver;

namespace {

void require_solid(const SurfaceMesh& mesh, double volume, double tolerance) {
    check_usable(mesh);
    REQUIRE(is_closed(mesh.triangles));
    REQUIRE(enclosed_volume(mesh.points, mesh.triangles) == Approx(volume).epsilon(tolerance));
}

} // namespace

TEST_CASE("a sphere of 20 by 20 has 382 vertices and 400 faces, numbered like Maya's", "[mesh][primitives]") {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    REQUIRE(sphere.points.size() == 382);
    REQUIRE(sphere.face_sizes.size() == 400);
    REQUIRE(sphere.triangles.size() == 760);
    require_solid(sphere, 4.0949, 1e-4);
    REQUIRE((sphere.points[0] - Vec3(0.148778, -0.987688, -0.048341)).norm() < 1e-6);
    REQUIRE(sphere.points[380] == Vec3(0, -1, 0));
    REQUIRE(sphere.points[381] == Vec3(0, 1, 0));
    for (const Vec3& p : sphere.points) REQUIRE(p.norm() == Approx(1).epsilon(1e-14));
}

TEST_CASE("a sphere's volume converges to the exact one at second order", "[mesh][primitives]") {
    double error[3];
    for (int k = 0; k < 3; ++k) {
        const SurfaceMesh s = make_sphere(2, 16 << k, 8 << k);
        error[k] = std::abs(enclosed_volume(s.points, s.triangles) - 32 * std::numbers::pi / 3);
    }
    REQUIRE(std::log2(error[0] / error[1]) == Approx(2).margin(0.05));
    REQUIRE(std::log2(error[1] / error[2]) == Approx(2).margin(0.02));
}

TEST_CASE("a cube has Maya's eight corners and six faces", "[mesh][primitives]") {
    const SurfaceMesh cube = make_cube(1, 1, 1, 1, 1, 1);
    const Points corners{{-.5, -.5, .5}, {.5, -.5, .5}, {-.5, .5, .5},   {.5, .5, .5},
                         {-.5, .5, -.5}, {.5, .5, -.5}, {-.5, -.5, -.5}, {.5, -.5, -.5}};
    REQUIRE(cube.points == corners);
    REQUIRE(cube.face_sizes == std::vector<int>(6, 4));
    require_solid(cube, 1, 1e-14);
}

TEST_CASE("subdivided boxes are closed and have the counts of their grids", "[mesh][primitives]") {
    for (int w = 1; w < 4; ++w)
        for (int h = 1; h < 4; ++h)
            for (int d = 1; d < 4; ++d) {
                const SurfaceMesh box = make_cube(2, 3, 4, w, h, d);
                REQUIRE(box.face_sizes.size() == static_cast<std::size_t>(2 * (w * h + h * d + d * w)));
                REQUIRE(box.points.size() == static_cast<std::size_t>(2 * (w * h + h * d + d * w) + 2));
                require_solid(box, 24, 1e-13);
            }
}

TEST_CASE("a plane lies in xz and faces up", "[mesh][primitives]") {
    const SurfaceMesh plane = make_plane(2, 4, 3, 5);
    REQUIRE(plane.points.size() == 24);
    REQUIRE(plane.face_sizes.size() == 15);
    REQUIRE_FALSE(is_closed(plane.triangles));
    for (const Vec3& n : vertex_normals(plane.points, plane.triangles)) REQUIRE((n - Vec3(0, 1, 0)).norm() < 1e-15);
    REQUIRE(bounding_box(plane.points).size() == Vec3(2, 0, 4));
}

TEST_CASE("cylinders are closed with every kind of cap", "[mesh][primitives]") {
    for (int caps = 0; caps < 4; ++caps) {
        const SurfaceMesh c = make_cylinder(1.5, 2, 20, 3, caps);
        const double area = 0.5 * 20 * std::sin(2 * std::numbers::pi / 20) * 1.5 * 1.5;
        require_solid(c, 2 * area, 1e-13);
    }
    REQUIRE(make_cylinder(1, 2, 20, 1, 1).points.size() == 42);
    REQUIRE(make_cylinder(1, 2, 20, 1, 0).points.size() == 40);
    REQUIRE(make_cylinder(1, 2, 20, 1, 0).face_sizes.size() == 22);
    REQUIRE((make_cylinder(1, 2, 20, 1, 1).points[0] - Vec3(0.951057, -1, -0.309017)).norm() < 1e-6);
}

TEST_CASE("a helix is a closed tube of the length of its path", "[mesh][primitives]") {
    const double radius = 1, tube = 0.1, height = 2, coils = 3;
    const SurfaceMesh helix = make_helix(radius, tube, height, coils, 32, 100);
    REQUIRE(helix.points.size() == 32 * 301);
    const double length = std::hypot(2 * std::numbers::pi * radius * coils, height);
    require_solid(helix, std::numbers::pi * tube * tube * length, 0.01);
    // Its ends are n-gons that look away from the tube.
    REQUIRE(helix.face_sizes.back() == 32);
    require_solid(make_helix(1, 0.3, 0.5, 0.4, 8, 20),
                  0.09 * std::numbers::pi * std::hypot(0.8 * std::numbers::pi, 0.5), 0.15);
}

TEST_CASE("primitives refuse sizes and counts that make no mesh", "[mesh][primitives]") {
    REQUIRE_THROWS_AS(make_sphere(0, 20, 20), Error);
    REQUIRE_THROWS_AS(make_sphere(1, 2, 20), Error);
    REQUIRE_THROWS_AS(make_sphere(1, 20, 1), Error);
    REQUIRE_THROWS_AS(make_sphere(std::nan(""), 20, 20), Error);
    REQUIRE_THROWS_AS(make_cube(1, -1, 1, 1, 1, 1), Error);
    REQUIRE_THROWS_AS(make_cube(1, 1, 1, 1, 0, 1), Error);
    REQUIRE_THROWS_AS(make_plane(1, 1, 0, 1), Error);
    REQUIRE_THROWS_AS(make_cylinder(1, 1, 20, 1, -1), Error);
    REQUIRE_THROWS_AS(make_cylinder(1, 1, 2000000000, 1, 1), Error);
    REQUIRE_THROWS_AS(make_helix(1, 2, 1, 1, 8, 8), Error);
    REQUIRE_THROWS_AS(make_helix(1, 0.1, 1, 1e9, 8, 50), Error);
}
