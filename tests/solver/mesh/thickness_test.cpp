// Thickness below a surface, where it is known.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/thickness.h"

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
