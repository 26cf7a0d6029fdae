// Closest points and winding numbers against exhaustive search and exact sums.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/primitives.h"
#include "solver/mesh/triangle_math.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

using namespace sinew::solver;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Exhaustive search with the same rule for ties.
ClosestPoint slow_closest(const SurfaceMesh& mesh, const Vec3& p) {
    ClosestPoint best;
    best.distance = std::numeric_limits<double>::infinity();
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
        const Triangle& id = mesh.triangles[at(t)];
        const TrianglePoint c =
            closest_on_triangle(p, {mesh.points[at(id[0])], mesh.points[at(id[1])], mesh.points[at(id[2])]}, id);
        const double d = (c.point - p).norm();
        if (d < best.distance) best = {t, c.point, c.barycentric, d};
    }
    return best;
}

Points random_points(int count, const Box& box, double margin, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> u(-margin, 1 + margin);
    Points points;
    for (int i = 0; i < count; ++i)
        points.push_back(box.min + box.size().cwiseProduct(Vec3(u(random), u(random), u(random))));
    return points;
}

SurfaceMesh biceps() { return read_surface(SINEW_SOURCE_DIR "/graphs/scenes/arm_ziva/muscles/biceps.obj"); }

} // namespace

TEST_CASE("the tree finds the same triangle and distance as exhaustive search", "[mesh][closest]") {
    const SurfaceMesh mesh = biceps();
    const SurfaceTree tree(mesh.points, mesh.triangles);
    for (const Vec3& p : random_points(400, bounding_box(mesh.points), 0.5, 1)) {
        const ClosestPoint fast = tree.closest(p), slow = slow_closest(mesh, p);
        REQUIRE(fast.distance == Approx(slow.distance).epsilon(1e-14));
        REQUIRE(fast.triangle == slow.triangle);
        REQUIRE(fast.point == slow.point);
        const Triangle& t = mesh.triangles[at(fast.triangle)];
        Vec3 rebuilt = Vec3::Zero();
        for (int k = 0; k < 3; ++k) rebuilt += fast.barycentric[k] * mesh.points[at(t[at(k)])];
        REQUIRE((rebuilt - fast.point).norm() < 1e-12);
        REQUIRE(fast.barycentric.minCoeff() >= 0);
        REQUIRE(fast.barycentric.sum() == Approx(1).epsilon(1e-14));
    }
}

TEST_CASE("the point of a triangle is right in all seven regions", "[mesh][closest]") {
    const std::array<Vec3, 3> c{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
    const Triangle id{5, 3, 9};
    const auto point = [&](double x, double y, double z) { return closest_on_triangle({x, y, z}, c, id).point; };
    REQUIRE(point(1, 1, 2) == Vec3(1, 1, 0));
    REQUIRE(point(-1, -1, 1) == Vec3(0, 0, 0));
    REQUIRE(point(6, -1, 1) == Vec3(4, 0, 0));
    REQUIRE(point(-1, 6, 1) == Vec3(0, 4, 0));
    REQUIRE((point(1, -3, 1) - Vec3(1, 0, 0)).norm() < 1e-15);
    REQUIRE((point(-3, 2, 1) - Vec3(0, 2, 0)).norm() < 1e-15);
    REQUIRE((point(4, 4, 1) - Vec3(2, 2, 0)).norm() < 1e-15);
    // A triangle that is only a line, and one that is only a point.
    const std::array<Vec3, 3> line{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(3, 0, 0)};
    REQUIRE((closest_on_triangle({2, 5, 0}, line, id).point - Vec3(2, 0, 0)).norm() < 1e-15);
    const std::array<Vec3, 3> dot{Vec3(1, 1, 1), Vec3(1, 1, 1), Vec3(1, 1, 1)};
    REQUIRE(closest_on_triangle({2, 5, 0}, dot, id).point == Vec3(1, 1, 1));
}

TEST_CASE("ties go to the lowest triangle, whatever the order in the tree", "[mesh][closest]") {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    const SurfaceTree tree(sphere.points, sphere.triangles);
    for (int v = 0; v < static_cast<int>(sphere.points.size()); ++v) {
        int lowest = 1 << 30;
        for (int t = 0; t < static_cast<int>(sphere.triangles.size()); ++t)
            for (int corner : sphere.triangles[at(t)])
                if (corner == v) lowest = std::min(lowest, t);
        const ClosestPoint on_vertex = tree.closest(sphere.points[at(v)]);
        REQUIRE(on_vertex.distance == 0);
        REQUIRE(on_vertex.triangle == lowest);
        REQUIRE(tree.closest(1.5 * sphere.points[at(v)]).triangle == lowest);
    }
    // Edges: a point above the middle of an edge between two triangles of a roof.
    const Points roof{{0, 0, 1}, {1, 0, 1}, {0.5, 1, 0}, {0.5, -1, 0}};
    for (const auto& triangles :
         {std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}}, std::vector<Triangle>{{1, 0, 3}, {0, 1, 2}}}) {
        const SurfaceTree two(roof, triangles);
        for (double x : {0.1, 0.3, 1.0 / 3, 0.77}) REQUIRE(two.closest({x, 0.01, 2}).triangle == 0);
    }
}

TEST_CASE("a search radius and a mask limit what is found", "[mesh][closest]") {
    const SurfaceMesh cube = make_cube(2, 2, 2, 1, 1, 1);
    const SurfaceTree tree(cube.points, cube.triangles);
    REQUIRE(tree.closest({3, 0.1, 0.2}, 1.9).triangle == -1);
    REQUIRE(std::isinf(tree.closest({3, 0.1, 0.2}, 1.9).distance));
    REQUIRE(tree.closest({3, 0.1, 0.2}, 2.1).distance == Approx(2));
    std::vector<char> allowed(cube.triangles.size(), 0);
    REQUIRE(tree.closest({3, 0.1, 0.2}, allowed).triangle == -1);
    for (std::size_t t = 0; t < allowed.size(); ++t) {
        allowed.assign(allowed.size(), 0);
        allowed[t] = 1;
        REQUIRE(tree.closest({3, 0.1, 0.2}, allowed).triangle == static_cast<int>(t));
    }
    REQUIRE_THROWS_AS(tree.closest({0, 0, 0}, std::vector<char>(3, 1)), Error);
}

TEST_CASE("trees without triangles and queries that are not finite find nothing", "[mesh][closest]") {
    const SurfaceTree empty({}, {});
    REQUIRE(empty.closest({0, 0, 0}).triangle == -1);
    REQUIRE(empty.winding_number({0, 0, 0}) == 0);
    const SurfaceMesh cube = make_cube(2, 2, 2, 1, 1, 1);
    const SurfaceTree tree(cube.points, cube.triangles);
    REQUIRE(tree.closest({std::nan(""), 0, 0}).triangle == -1);
    REQUIRE(tree.winding_number({std::nan(""), 0, 0}) == 0);
    REQUIRE_THROWS_AS(SurfaceTree({{0, 0, 0}}, {{0, 0, 1}}), Error);
    REQUIRE_THROWS_AS(SurfaceTree({{0, std::nan(""), 0}}, {{0, 0, 0}}), Error);
    // Many triangles in one place do not break the tree.
    const SurfaceTree pile({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<Triangle>(1000, {0, 1, 2}));
    REQUIRE(pile.closest({0.2, 0.2, 1}).triangle == 0);
}

TEST_CASE("the solid angle of a cube's face seen from its centre is a sixth of the sphere", "[mesh][winding]") {
    const SurfaceMesh cube = make_cube(2, 2, 2, 1, 1, 1);
    double face = 0;
    for (std::size_t t = 0; t < 2; ++t) {
        const Triangle& c = cube.triangles[t];
        face += solid_angle({0, 0, 0}, cube.points[at(c[0])], cube.points[at(c[1])], cube.points[at(c[2])]);
    }
    REQUIRE(face == Approx(4 * std::numbers::pi / 6).epsilon(1e-14));
}

TEST_CASE("winding numbers of closed meshes are whole numbers", "[mesh][winding]") {
    for (const SurfaceMesh& mesh : {biceps(), make_sphere(1, 20, 20), make_helix(1, 0.2, 2, 3, 8, 50)}) {
        const SurfaceTree tree(mesh.points, mesh.triangles);
        double worst = 0, worst_exact = 0;
        int inside = 0;
        for (const Vec3& p : random_points(2000, bounding_box(mesh.points), 0.3, 2)) {
            const double exact = tree.winding_number_exact(p), fast = tree.winding_number(p);
            worst = std::max(worst, std::abs(fast - exact));
            worst_exact = std::max(worst_exact, std::abs(exact - std::round(exact)));
            inside += exact > 0.5;
            REQUIRE(tree.inside(p) == (exact > 0.5));
        }
        CAPTURE(worst, worst_exact, inside);
        REQUIRE(worst < SurfaceTree::winding_error);
        REQUIRE(worst_exact < 1e-12);
        REQUIRE(inside > 20);
    }
}

TEST_CASE("the fast winding number keeps its bound on torn and shuffled surfaces, and decides like the exact one",
          "[mesh][winding]") {
    std::mt19937 random(9);
    int undecided = 0;
    for (int trial = 0; trial < 6; ++trial) {
        SurfaceMesh mesh = trial % 2 ? biceps() : make_helix(1, 0.2, 2, 3, 8, 50);
        std::vector<Triangle> torn;
        for (Triangle t : mesh.triangles) {
            if (trial / 2 == 1 && random() % 100 < 40) continue;
            if (trial / 2 == 2 && random() % 2) std::swap(t[0], t[1]);
            torn.push_back(t);
        }
        const SurfaceTree tree(mesh.points, torn);
        double worst = 0;
        for (const Vec3& p : random_points(3000, bounding_box(mesh.points), 0.2, 4 + static_cast<unsigned>(trial))) {
            const double exact = tree.winding_number_exact(p), fast = tree.winding_number(p);
            worst = std::max(worst, std::abs(fast - exact));
            undecided += std::abs(std::abs(fast) - 0.5) <= SurfaceTree::winding_error;
            REQUIRE(tree.inside(p) == (exact > 0.5));
            REQUIRE(tree.inside_either_way(p) == (std::abs(exact) > 0.5));
        }
        CAPTURE(trial, worst);
        REQUIRE(worst < SurfaceTree::winding_error);
        REQUIRE(worst > 1e-5); // otherwise nothing was taken from afar
    }
    REQUIRE(undecided > 5);
}

TEST_CASE("winding numbers of many points agree with those of one, also on triangles and corners", "[mesh][winding]") {
    const SurfaceMesh mesh = biceps();
    const SurfaceTree tree(mesh.points, mesh.triangles);
    const double side = bounding_box(mesh.points).size().maxCoeff();
    std::mt19937 random(10);
    std::normal_distribution<double> g;
    for (int trial = 0; trial < 60; ++trial) {
        const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
        const Vec3 &a = mesh.points[at(t[0])], &b = mesh.points[at(t[1])], &c = mesh.points[at(t[2])];
        Points points{(a + b + c) / 3 + 1e-4 * (b - a).cross(c - a), (a + b + c) / 3 - 1e-4 * (b - a).cross(c - a)};
        for (int i = 0; i < 40; ++i)
            points.push_back(a + std::pow(10.0, -1 - trial % 4) * side * Vec3(g(random), g(random), g(random)));
        const std::vector<double> many = tree.winding_numbers(points);
        for (std::size_t i = 0; i < points.size(); ++i)
            REQUIRE(many[i] == Approx(tree.winding_number_exact(points[i])).margin(SurfaceTree::winding_error));
        // A corner of the mesh has no winding number, but it must not spoil its neighbours.
        points[3] = a;
        const std::vector<double> with_corner = tree.winding_numbers(points);
        REQUIRE(std::isfinite(with_corner[3]));
        REQUIRE(with_corner[0] == Approx(many[0]).margin(SurfaceTree::winding_error));
    }
    REQUIRE(tree.winding_numbers({}).empty());
    REQUIRE(tree.winding_numbers({Vec3(std::nan(""), 0, 0), Vec3(1e3, 0, 0)})[0] == 0);
}

TEST_CASE("inside is right a thousandth of an edge away from the surface", "[mesh][winding]") {
    const SurfaceMesh mesh = biceps();
    const SurfaceTree tree(mesh.points, mesh.triangles);
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.points[at(t[0])], &b = mesh.points[at(t[1])], &c = mesh.points[at(t[2])];
        const Vec3 normal = (b - a).cross(c - a);
        const Vec3 step = 1e-3 * normal / std::sqrt(normal.norm());
        REQUIRE(tree.inside((a + b + c) / 3 - step));
        REQUIRE_FALSE(tree.inside((a + b + c) / 3 + step));
    }
}

TEST_CASE("a cup's winding number fades through its opening and flips with its orientation", "[mesh][winding]") {
    SurfaceMesh sphere = make_sphere(1, 40, 40);
    std::vector<Triangle> cup, turned;
    for (const Triangle& t : sphere.triangles)
        if (sphere.points[at(t[0])].y() + sphere.points[at(t[1])].y() + sphere.points[at(t[2])].y() < 0) {
            cup.push_back(t);
            turned.push_back({t[0], t[2], t[1]});
        }
    const SurfaceTree tree(sphere.points, cup), other(sphere.points, turned);
    REQUIRE(tree.winding_number_exact({0, -0.9, 0}) > 0.8);
    REQUIRE(tree.winding_number_exact({0, 0, 0}) == Approx(0.5).margin(0.01));
    REQUIRE(tree.winding_number_exact({0, 2, 0}) < 0.2);
    for (double y : {-0.5, 0.0, 0.5, 3.0}) {
        REQUIRE(tree.winding_number({0.1, y, 0}) == Approx(tree.winding_number_exact({0.1, y, 0})).margin(0.02));
        REQUIRE(other.winding_number({0.1, y, 0}) == Approx(-tree.winding_number({0.1, y, 0})).margin(1e-12));
    }
}

TEST_CASE("distances of points that lie together are those of each, bit for bit", "[closest]") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> u(-1, 1);
    const auto place = [&] { return Vec3(u(random), u(random), u(random)); };
    SurfaceMesh soup;
    for (int t = 0; t < 60; ++t) {
        for (int c = 0; c < 3; ++c) soup.points.push_back(2 * place());
        soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    for (const SurfaceMesh& mesh : {soup, make_sphere(1, 24, 16), make_cube(1, 2, 3, 1, 1, 1)})
        for (const double extent : {1e-6, 0.1, 0.7, 5.0})
            for (const double most : {0.01, 0.2, 1e300}) {
                const SurfaceTree tree(mesh.points, mesh.triangles);
                Points points;
                const Vec3 middle = place();
                for (int i = 0; i < 40; ++i) points.push_back(middle + extent * place());
                const std::vector<double> found = tree.distances(points, most);
                REQUIRE(found.size() == points.size());
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const ClosestPoint nearest = tree.closest(points[i], most);
                    REQUIRE(found[i] == (nearest.triangle >= 0 ? nearest.distance : most));
                }
            }
    const SurfaceTree none({}, {});
    REQUIRE(none.distances({Vec3::Zero()}, 0.5) == std::vector<double>{0.5});
}
