// Thickness below a surface and gaps above it, where they are known.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/edge_ways.h"
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/thickness.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

using namespace sinew::solver;

namespace {

std::vector<Thickness> all_of(const SurfaceMesh& mesh) { return thickness(mesh.points, mesh.triangles, 1000000); }

} // namespace

TEST_CASE("a box is as thick as it is from side to side", "[mesh]") {
    const SurfaceMesh box = make_cube(4, 2, 0.5, 7, 5, 3);
    double area[3] = {0, 0, 0};
    for (const Thickness& t : all_of(box)) {
        const int axis = t.distance == Approx(4) ? 0 : t.distance == Approx(2) ? 1 : 2;
        CHECK(t.distance == Approx(axis == 0 ? 4 : axis == 1 ? 2 : 0.5));
        area[axis] += t.area;
    }
    CHECK(area[0] == Approx(2 * 2 * 0.5)); // the ends
    CHECK(area[1] == Approx(2 * 4 * 0.5));
    CHECK(area[2] == Approx(2 * 4 * 2));
}

TEST_CASE("a ball is as thick as its diameter and a shell as its wall", "[mesh]") {
    for (const Thickness& t : all_of(make_sphere(1, 48, 48))) CHECK(t.distance == Approx(2).epsilon(0.01));
    // A ball within a ball, turned inside out: the wall lies between them.
    SurfaceMesh shell = make_sphere(1, 48, 48);
    const SurfaceMesh inner = make_sphere(0.8, 48, 48);
    const int first = static_cast<int>(shell.points.size());
    shell.points.insert(shell.points.end(), inner.points.begin(), inner.points.end());
    for (const Triangle& t : inner.triangles) shell.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
    for (const Thickness& t : all_of(shell)) CHECK(t.distance == Approx(0.2).epsilon(0.02));
}

TEST_CASE("thickness of a mesh that is inside out or open and of a part of its triangles", "[mesh]") {
    SurfaceMesh box = make_cube(1, 2, 3, 1, 1, 1);
    const auto right = all_of(box);
    for (Triangle& t : box.triangles) std::swap(t[1], t[2]);
    const auto turned = all_of(box);
    REQUIRE(turned.size() == 12);
    for (std::size_t i = 0; i < 12; ++i) CHECK(turned[i].distance == right[i].distance);
    const auto three = thickness(box.points, box.triangles, 3);
    REQUIRE(three.size() == 3);
    CHECK(three[1].triangle == 4);
    CHECK(three[2].triangle == 8);
    const SurfaceMesh sheet = make_plane(1, 1, 2, 2);
    for (const Thickness& t : all_of(sheet)) CHECK(std::isinf(t.distance));
    CHECK_THROWS_AS(thickness(sheet.points, {{0, 1, 99}}, 10), Error);
}

TEST_CASE("a gap is as wide as from one part to the next, also where no normal meets it", "[mesh]") {
    // Two cubes, .5 apart along z.
    SurfaceMesh both = make_cube(1, 1, 1, 1, 1, 1);
    const SurfaceMesh one = both;
    for (const Vec3& p : one.points) both.points.push_back(p + Vec3(0, 0, 1.5));
    for (const Triangle& t : one.triangles) both.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    double area = 0;
    for (const Thickness& t : gaps(both.points, both.triangles, 1000)) {
        if (std::isinf(t.distance)) {
            CHECK(t.opposite == -1);
            continue;
        }
        CHECK(t.distance == Approx(0.5));
        CHECK((t.triangle < 12) != (t.opposite < 12));
        area += t.area;
    }
    CHECK(area == Approx(2));
    const auto right = gaps(both.points, both.triangles, 1000);
    for (Triangle& t : both.triangles) std::swap(t[1], t[2]); // inside out
    const auto turned = gaps(both.points, both.triangles, 1000);
    for (std::size_t i = 0; i < right.size(); ++i) CHECK(turned[i].distance == right[i].distance);
    // Eight-sided rods beside each other, edge towards edge: .3 apart, and no normal of theirs leads across.
    SurfaceMesh rods;
    for (const double y : {0.0, 2.3}) {
        const int first = static_cast<int>(rods.points.size());
        for (const double z : {0.0, 4.0})
            for (int k = 0; k < 8; ++k)
                rods.points.emplace_back(std::sin(k * std::acos(-1) / 4), y + std::cos(k * std::acos(-1) / 4), z);
        for (int k = 0; k < 8; ++k) {
            const int a = first + k, b = first + (k + 1) % 8;
            rods.triangles.push_back({a, a + 8, b + 8});
            rods.triangles.push_back({a, b + 8, b});
        }
    }
    double least = 9;
    for (const Thickness& t : gaps(rods.points, rods.triangles, 1000)) least = std::min(least, t.distance);
    CHECK(least > 0.3);
    CHECK(least < 0.7);
}

TEST_CASE("ways along a surface's edges", "[mesh]") {
    // Eight cells of a quarter along each side.
    const SurfaceMesh plane = make_plane(2, 2, 8, 8);
    EdgeWays ways(plane.points, plane.triangles);
    const std::vector<double> from = ways.from(0);
    const Vec3 start = plane.points[0];
    for (std::size_t v = 0; v < plane.points.size(); ++v) {
        const Vec3 apart = (plane.points[v] - start).cwiseAbs();
        CHECK(from[v] >= apart.norm() - 1e-12);
        CHECK(from[v] <= apart.sum() + 1e-12);
        if (apart.sum() == apart.maxCoeff()) CHECK(from[v] == Approx(apart.sum()));
        const std::array one{0}, other{static_cast<int>(v)};
        if (v != 0) CHECK(ways.are_farther(one, other, from[v] - 1e-9));
        CHECK_FALSE(ways.are_farther(one, other, from[v] + 1e-9));
    }
    // Nothing leads to another part.
    EdgeWays parts(plane.points, {{0, 1, 9}});
    CHECK(parts.from(0)[20] == EdgeWays::unreached);
    CHECK(parts.are_farther(std::array{0}, std::array{20}, 1e30));
    CHECK_FALSE(parts.are_farther(std::array{20, 9}, std::array{21, 1}, 1e30)); // of several the nearest
}
