// How far a remeshed surface is off, where that is known.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/iso_deviation.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace sinew::solver;

namespace {

IsoDeviation measured(const SurfaceMesh& from, double iso, const SurfaceMesh& result) {
    return measure_iso_mesh(from.points, from.triangles, iso, result.points, result.triangles);
}

SurfaceMesh moved(SurfaceMesh mesh, double x) {
    for (Vec3& p : mesh.points) p.x() += x;
    return mesh;
}

SurfaceMesh both(const SurfaceMesh& a, const SurfaceMesh& b) {
    SurfaceMesh out = a;
    const int first = static_cast<int>(a.points.size());
    out.points.insert(out.points.end(), b.points.begin(), b.points.end());
    for (const Triangle& t : b.triangles) out.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return out;
}

} // namespace

TEST_CASE("the same surface is off by nothing and a smaller one by what it lacks", "[meshing]") {
    const SurfaceMesh box = make_cube(1, 1, 1, 8, 8, 8);
    const IsoDeviation same = measured(box, 0, box);
    CHECK(same.distance < 1e-15);
    CHECK(same.volume_ratio == Approx(1).epsilon(1e-14));
    // Half as wide: the sides at x = -1/2 and 1/2 are a quarter away.
    const IsoDeviation narrow = measured(box, 0, make_cube(0.5, 1, 1, 4, 8, 8));
    CHECK(narrow.distance == Approx(0.25));
    CHECK(std::abs(narrow.place.x()) >= 0.25); // a point of either side
    CHECK(narrow.volume_ratio == Approx(0.5));
    // Turned inside out as a whole it is the same solid.
    SurfaceMesh turned = box;
    for (Triangle& t : turned.triangles) std::swap(t[1], t[2]);
    CHECK(measured(turned, 0, box).volume_ratio == Approx(1));
}

TEST_CASE("what sticks out and is lost is as far off as it is long", "[meshing]") {
    // A box with a needle of 2 on its top, two parts that touch nowhere inside each other.
    const SurfaceMesh box = make_cube(1, 1, 1, 8, 8, 8);
    SurfaceMesh needle = make_cube(0.02, 2, 0.02, 1, 20, 1);
    for (Vec3& p : needle.points) p.y() += 1.6;
    const IsoDeviation lost = measured(both(box, needle), 0, box);
    CHECK(lost.distance == Approx(2.6 - 0.5));
    CHECK(lost.place.y() == Approx(2.6));
    CHECK(lost.volume_ratio == Approx(1 / 1.0008));
}

TEST_CASE("parts within each other count for nothing and leave the volume untold", "[meshing]") {
    const SurfaceMesh one = make_cube(1, 1, 1, 8, 8, 8);
    const SurfaceMesh pair = both(one, moved(one, 0.5));
    const IsoDeviation d = measured(pair, 0, moved(make_cube(1.5, 1, 1, 12, 8, 8), 0.25));
    CHECK(d.distance < 1e-12);
    CHECK(std::isnan(d.volume_ratio));
}

TEST_CASE("a level set is measured by the distance that it should have", "[meshing]") {
    const SurfaceMesh ball = make_sphere(1, 64, 64);
    // At 0.5 around the ball: a ball of 1.5. One of 1.4 is 0.1 too near.
    CHECK(measured(ball, 0.5, make_sphere(1.5, 64, 64)).distance < 0.005);
    CHECK(measured(ball, 0.5, make_sphere(1.4, 64, 64)).distance == Approx(0.1).margin(0.005));
    CHECK(measured(ball, -0.5, make_sphere(0.5, 64, 64)).distance < 0.005);
    CHECK(std::isnan(measured(ball, 0.5, make_sphere(1.5, 64, 64)).volume_ratio));
    // A sheet is open: nothing of it is within another part. A box that leaves half of it outside.
    const SurfaceMesh sheet = make_plane(2, 2, 20, 20);
    const SurfaceMesh wrap = make_cube(2.2, 0.2, 2.2, 40, 4, 40),
                      half = moved(make_cube(1.2, 0.2, 2.2, 20, 4, 40), -0.5);
    CHECK(measured(sheet, 0.1, wrap).distance == Approx(std::sqrt(0.03) - 0.1)); // at the box's corners
    CHECK(measured(sheet, 0.1, half).distance == Approx(0.9 + 0.1));
}
