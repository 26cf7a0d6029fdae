// Surfaces: triangulation, checks, areas, volumes, normals.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/triangulate.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

using namespace sinew::solver;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::string code_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& e) {
        return e.code;
    }
    return "none";
}

double area_along(const Points& points, const std::vector<Triangle>& triangles, const Vec3& normal,
                  double* least = nullptr) {
    double sum = 0;
    for (const Triangle& t : triangles) {
        const double area =
            0.5 * (points[at(t[1])] - points[at(t[0])]).cross(points[at(t[2])] - points[at(t[0])]).dot(normal);
        if (least) *least = std::min(*least, area);
        sum += area;
    }
    return sum;
}

} // namespace

TEST_CASE("a convex polygon is a fan from its first corner", "[mesh]") {
    const Points points{{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {2, 2, 0}, {0, 2, 0}};
    const SurfaceMesh mesh = SurfaceMesh::from_polygons(points, {5}, {0, 1, 2, 3, 4});
    REQUIRE(mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
}

TEST_CASE("a concave polygon is cut into ears that cover it once", "[mesh]") {
    // A comb with four teeth, tilted and far from the origin.
    Points points;
    std::vector<int> ring;
    points.emplace_back(0, -1, 0);
    points.emplace_back(8, -1, 0);
    for (int tooth = 3; tooth >= 0; --tooth) {
        points.emplace_back(2 * tooth + 2, 3, 0);
        points.emplace_back(2 * tooth + 1, 0, 0);
    }
    points.emplace_back(0, 3, 0);
    for (int i = 0; i < static_cast<int>(points.size()); ++i) ring.push_back(i);
    Vec3 area = Vec3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) area += 0.5 * points[i].cross(points[(i + 1) % points.size()]);
    const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
    for (Vec3& p : points) p = turn * p + Vec3(1000, -500, 200);

    std::vector<Triangle> triangles;
    triangulate_polygon(points, ring, triangles);
    REQUIRE(triangles.size() == points.size() - 2);
    double least = 1e9;
    REQUIRE(area_along(points, triangles, turn * Vec3(0, 0, 1), &least) == Approx(area.z()).epsilon(1e-10));
    REQUIRE(least > 0);
}

TEST_CASE("random star-shaped polygons are covered exactly by positive triangles", "[mesh]") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> radius(0.2, 1.0);
    for (int trial = 0; trial < 200; ++trial) {
        const int n = 4 + trial % 20;
        Points points;
        std::vector<int> ring(at(n));
        std::iota(ring.begin(), ring.end(), 0);
        double twice_area = 0;
        for (int i = 0; i < n; ++i) {
            const double a = 2 * std::numbers::pi * i / n, r = radius(random);
            points.emplace_back(r * std::cos(a), r * std::sin(a), 0);
        }
        for (int i = 0; i < n; ++i) twice_area += points[at(i)].cross(points[at((i + 1) % n)]).z();
        std::vector<Triangle> triangles;
        triangulate_polygon(points, ring, triangles);
        REQUIRE(triangles.size() == at(n - 2));
        double least = 1e9;
        REQUIRE(area_along(points, triangles, Vec3(0, 0, 1), &least) == Approx(0.5 * twice_area));
        REQUIRE(least >= 0);
    }
}

TEST_CASE("a polygon of twenty thousand jagged corners is cut like a small one", "[mesh]") {
    // Looking at every corner anew at every cut would be 8e12 looks.
    const int n = 20000;
    Points points;
    std::vector<int> ring(at(n));
    std::iota(ring.begin(), ring.end(), 0);
    for (int i = 0; i < n; ++i) {
        const double a = 2 * std::numbers::pi * i / n, r = 1 + 0.3 * std::sin(37.0 * i);
        points.emplace_back(r * std::cos(a), r * std::sin(a), 0);
    }
    double twice_area = 0;
    for (int i = 0; i < n; ++i) twice_area += points[at(i)].cross(points[at((i + 1) % n)]).z();
    std::vector<Triangle> triangles;
    triangulate_polygon(points, ring, triangles);
    REQUIRE(triangles.size() == at(n - 2));
    double least = 1e9;
    REQUIRE(area_along(points, triangles, Vec3(0, 0, 1), &least) == Approx(0.5 * twice_area));
    REQUIRE(least >= 0);
}

TEST_CASE("a polygon of very many corners is a fan, or refused at once", "[mesh]") {
    const std::size_t n = most_clipped_corners + 1;
    Points points;
    std::vector<int> corners(n);
    std::iota(corners.begin(), corners.end(), 0);
    for (std::size_t i = 0; i < n; ++i) {
        const double a = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
        points.emplace_back(std::cos(a), std::sin(a), 0);
    }
    REQUIRE(SurfaceMesh::from_polygons(points, {static_cast<int>(n)}, corners).triangles.size() == n - 2);
    points[7] *= 0.5; // not convex any more
    try {
        SurfaceMesh::from_polygons(points, {static_cast<int>(n)}, corners);
        FAIL("it was cut");
    } catch (const Error& e) {
        REQUIRE(e.code == "FE208");
        REQUIRE(std::string(e.what()).find("50001 corners") != std::string::npos);
    }
}

TEST_CASE("polygons that cross themselves or have no area still give n - 2 triangles", "[mesh]") {
    const Points bow{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 3, 0}, {0.4, -1, 0}};
    const Points line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1.5, 0, 0}, {0.2, 0, 0}};
    const std::vector<int> ring{0, 1, 2, 3, 4, 5};
    for (const Points& points : {bow, line}) {
        std::vector<Triangle> triangles;
        triangulate_polygon(points, ring, triangles);
        REQUIRE(triangles.size() == 4);
    }
}

TEST_CASE("polygons are refused with a code that says why", "[mesh]") {
    const Points points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const auto told = [&](const std::vector<int>& sizes, const std::vector<int>& corners) {
        try {
            SurfaceMesh::from_polygons(points, sizes, corners);
        } catch (const Error& e) {
            return e.code + " " + e.what();
        }
        return std::string("taken");
    };
    CHECK(told({3, 3}, {0, 1, 2, 2, 1, 0}) == "taken");
    CHECK(told({3, 2}, {0, 1, 2, 0, 1}) == "FE208 face 1 has 2 corners");
    CHECK(told({-1}, {}) == "FE208 face 0 has -1 corners");
    CHECK(told({3, 4}, {0, 1, 2, 0, 1, 2}) == "FE208 the 6 corners end within face 1 of 2");
    CHECK(told({3}, {0, 1, 2, 0}) == "FE208 4 corners, but the faces have 3");
    CHECK(told({3}, {0, 1, 3}) == "FE203 corner 2 of face 0 is vertex 3; there are 3 vertices, counted from 0");
    CHECK(told({3, 3}, {0, 1, 2, 0, -1, 2}) ==
          "FE203 corner 1 of face 1 is vertex -1; there are 3 vertices, counted from 0");
}

TEST_CASE("a surface is checked for emptiness, finite vertices and indices", "[mesh]") {
    REQUIRE(code_of([] { check_usable(SurfaceMesh{}); }) == "FE201");
    REQUIRE(code_of([] { check_usable(SurfaceMesh::from_triangles({{0, 0, 0}}, {})); }) == "FE201");
    REQUIRE(code_of([] { check_usable(SurfaceMesh::from_triangles({{0, 0, 0}}, {{0, 0, 1}})); }) == "FE203");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    try {
        check_usable(SurfaceMesh::from_triangles({{0, 0, 0}, {1, 0, 0}, {0, nan, 0}, {0, nan, 0}}, {{0, 1, 2}}));
        FAIL("not refused");
    } catch (const Error& e) {
        REQUIRE(e.code == "FE202");
        REQUIRE(std::string(e.what()).find("vertex 2") != std::string::npos);
    }
    check_usable(make_cube(1, 1, 1, 1, 1, 1));
}

TEST_CASE("a box has its area, volume, normals and box, also far from the origin", "[mesh]") {
    SurfaceMesh box = make_cube(2, 3, 5, 2, 3, 4);
    const Vec3 shift(1e5, -2e5, 3e5);
    for (Vec3& p : box.points) p += shift;
    const std::vector<double> areas = vertex_areas(box.points, box.triangles);
    REQUIRE(std::accumulate(areas.begin(), areas.end(), 0.0) == Approx(62));
    REQUIRE(enclosed_volume(box.points, box.triangles) == Approx(30).epsilon(1e-9));
    REQUIRE(is_closed(box.triangles));
    REQUIRE((bounding_box(box.points).size() - Vec3(2, 3, 5)).norm() < 1e-9);
    REQUIRE((bounding_box(box.points).centre() - shift).norm() < 1e-9);
    const Points normals = vertex_normals(box.points, box.triangles);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        REQUIRE(normals[i].norm() == Approx(1));
        REQUIRE(normals[i].dot(box.points[i] - shift) > 0);
    }
}

TEST_CASE("closed means two triangles of opposite direction at every edge", "[mesh]") {
    const std::vector<Triangle> tet{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    REQUIRE(is_closed(tet));
    REQUIRE_FALSE(is_closed({}));
    std::vector<Triangle> open(tet.begin(), tet.end() - 1);
    REQUIRE_FALSE(is_closed(open));
    std::vector<Triangle> turned = tet;
    std::swap(turned[0][0], turned[0][1]);
    REQUIRE_FALSE(is_closed(turned));
    std::vector<Triangle> twice = tet;
    twice.insert(twice.end(), tet.begin(), tet.end());
    REQUIRE_FALSE(is_closed(twice));
    REQUIRE_FALSE(is_closed({{0, 0, 1}, {0, 1, 0}}));
}

TEST_CASE("normals of vertices without faces are zero", "[mesh]") {
    const Points normals = vertex_normals({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}}, {{0, 1, 2}});
    REQUIRE(normals[0] == Vec3(0, 0, 1));
    REQUIRE(normals[3] == Vec3(0, 0, 0));
}
