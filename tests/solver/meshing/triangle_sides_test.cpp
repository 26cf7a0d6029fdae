// What lies below and above the triangles of closed surfaces: asked once for parts with nothing near them.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "soups.h"

#include "solver/meshing/triangle_sides.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace soups;

namespace {

FoundSides sides_of(const Solid& solid, bool is_each_asked = false) {
    const MeshingControl control;
    return find_sides(solid.points, solid.triangles, solid.tree,
                      {solid.box.size().maxCoeff(), solid.is_closed, is_each_asked}, {control, 0, 1, "looking"});
}

/// A turned prism with n sides and caps that are fans or strips of long triangles.
Shape prism(int n, double height) {
    std::vector<std::vector<int>> polygons(2);
    SurfaceMesh mesh;
    const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (int i = 0; i < 2 * n; ++i) {
        const double angle = 2 * M_PI * (i % n) / n;
        mesh.points.push_back(turn * Vec3(std::cos(angle), i < n ? 0 : height, std::sin(angle)));
    }
    std::vector<Triangle> triangles;
    for (int i = 1; i + 1 < n; ++i) {
        triangles.push_back({0, i, i + 1});
        triangles.push_back({n, n + i + 1, n + i});
    }
    for (int i = 0; i < n; ++i) {
        const int j = (i + 1) % n;
        triangles.push_back({i, n + i, n + j});
        triangles.push_back({i, n + j, j});
    }
    return {"prism", mesh.points, triangles};
}

/// A turned prism whose n sides fold forth and back between two radii, with caps that are fans about their middles.
Shape star(int n, double inner, double height) {
    Shape s{"star", {}, {}};
    const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (const double y : {0.0, height})
        for (int i = 0; i < n; ++i) {
            const double angle = 2 * M_PI * i / n, radius = i % 2 == 1 ? 2 : inner;
            s.points.push_back(turn * Vec3(radius * std::cos(angle), y, radius * std::sin(angle)));
        }
    s.points.push_back(turn * Vec3(0, 0, 0)), s.points.push_back(turn * Vec3(0, height, 0));
    for (int i = 0; i < n; ++i) {
        const int j = (i + 1) % n;
        s.triangles.push_back({2 * n, i, j}), s.triangles.push_back({2 * n + 1, n + j, n + i});
        s.triangles.push_back({i, n + i, n + j}), s.triangles.push_back({i, n + j, j});
    }
    return s;
}

/// Closed surfaces that touch, cross, fold, and come as near to each other as places lie to their triangles.
std::vector<Shape> crowded_shapes() {
    std::vector<Shape> all;
    for (const double gap : {0.0, 1e-9, 1e-6, 3e-5, 1e-4, 1e-3}) {
        Shape pair = shape("cubes with a gap", make_cube(1, 1, 1, 2, 2, 2));
        append(pair, make_cube(1, 1, 1, 3, 1, 1), {1 + gap, 0.1, 0});
        all.push_back(pair);
        all.push_back(shape("sheet", make_cube(1, gap + 1e-7, 1, 3, 1, 2)));
        Shape wedge{"wedge", {{0, 0, 0}, {1, 0, 0}, {0.3, gap + 1e-7, 1}, {0.4, 0, 0.9}}, {}};
        wedge.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
        all.push_back(wedge);
    }
    std::mt19937 random(7);
    const auto next = [&] { return random() / 4294967296.0; };
    for (int k = 0; k < 12; ++k) {
        Shape heap{"heap", {}, {}};
        for (int i = 0; i < 2 + 2 * k; ++i) {
            SurfaceMesh one = i % 3 == 0 ? make_sphere(0.3 + next(), 9, 7)
                                         : make_cube(0.05 + next(), 0.05 + next(), 0.05 + 2 * next(), 1, 1 + i % 4, 1);
            const Mat3 turn = Eigen::AngleAxisd(3 * next(), Vec3(next(), next(), 0.1).normalized()).toRotationMatrix();
            if (k % 2 == 0)
                for (Vec3& p : one.points) p = turn * p;
            append(heap, one.points, i % 5 == 4 ? reversed(one.triangles) : one.triangles,
                   (k % 2 == 0 ? 3 : 1) * Vec3(next(), next(), next()));
        }
        all.push_back(heap);
    }
    // A ball whose vertices are shaken until it crosses itself in many places.
    for (const double shake : {0.02, 0.1, 0.5}) {
        Shape ball = shape("shaken ball", make_sphere(1, 40, 24));
        for (Vec3& p : ball.points) p += shake * Vec3(next() - 0.5, next() - 0.5, next() - 0.5);
        all.push_back(ball);
        for (Vec3& p : ball.points) p += Vec3(1e9, 0, 0); // few digits left
        all.push_back(ball);
    }
    return all;
}

} // namespace

TEST_CASE("parts with nothing near have the sides that each of their triangles would find", "[sides]") {
    std::vector<Shape> all = ten_shapes();
    for (const Shape& s : crowded_shapes()) all.push_back(s);
    for (const double height : {2e-5, 0.1, 30.0}) all.push_back(prism(60, height));
    for (const int n : {100, 200, 220, 260}) all.push_back(star(n, 0.5, 1000));
    std::size_t alone = 0, together = 0;
    std::erase_if(all, [](const Shape& s) { return s.name == "plane"; });
    for (const Shape& s : all)
        for (const Fill fill : {Fill::filled_cavities, Fill::surface_only}) {
            INFO(s.name);
            const Solid solid = make_solid(s.points, s.triangles, fill);
            if (!solid.is_closed) continue;
            const FoundSides found = sides_of(solid), asked = sides_of(solid, true);
            REQUIRE(found.sides == asked.sides);
            REQUIRE(found.sides == solid.sides);
            REQUIRE(found.asked <= asked.asked);
            alone += asked.asked, together += found.asked;
        }
    CHECK(2 * together < alone); // also of these, few of which have nothing near
}

TEST_CASE("the sides of a prism are asked once, however many triangles it has", "[sides]") {
    for (const int n : {50, 400}) {
        const Shape s = prism(n, 10);
        const Solid solid = make_solid(s.points, s.triangles);
        const FoundSides found = sides_of(solid);
        for (const Solid::Sides& side : found.sides) REQUIRE((side.below == 1 && side.above == 0));
        CHECK(found.asked == 2);
    }
}

TEST_CASE("folds so sharp that places beside a side lie beyond the next one cost no questions", "[sides]") {
    // Places lie off their triangles by a thousandth of their size: with 200 sides between the folds, with 240 and
    // more some beyond them. The winding number of each would be a sum over all the sides, as they are long.
    for (const int n : {100, 200, 240, 260, 400, 1000}) {
        INFO(n);
        const Shape s = star(n, 0.5, 1000);
        const Solid solid = make_solid(s.points, s.triangles);
        const FoundSides found = sides_of(solid);
        for (const Solid::Sides& side : found.sides) REQUIRE((side.below == 1 && side.above == 0));
        CHECK(found.asked <= 2);
    }
}

TEST_CASE("triangles that others go through stay without sides, however near it is looked", "[sides]") {
    Shape s = shape("crossing cubes", make_cube(1, 1, 1, 1, 1, 1));
    append(s, make_cube(1, 1, 1, 1, 1, 1), {0.5, 0.3, 0.2});
    const Solid solid = make_solid(s.points, s.triangles);
    const FoundSides found = sides_of(solid), asked = sides_of(solid, true);
    REQUIRE(found.sides == asked.sides);
    const auto known = std::ranges::count_if(found.sides, &Solid::Sides::are_known);
    CHECK(known > 0);
    CHECK(known < std::ssize(found.sides));
}
