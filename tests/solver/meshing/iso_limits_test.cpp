// Iso meshes far from the origin, very large and very small, and of surfaces that have no level set to mesh.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "soups.h"

#include "solver/error.h"
#include "solver/mesh/mesh_check.h"
#include "solver/meshing/iso_mesh.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <cmath>

using namespace soups;

namespace {

IsoMesh mesh_of(const Shape& s, double iso, double size, double seconds = 60) {
    IsoMeshOptions o;
    o.iso_value = iso;
    o.triangle_size = size;
    o.resolution = 64;
    o.most_seconds = seconds;
    return make_iso_mesh(s.points, s.triangles, o);
}

Error refusal(const Shape& s, double iso, double size) {
    try {
        mesh_of(s, iso, size);
    } catch (const Error& e) {
        return e;
    }
    return {"none", ""};
}

Shape cube(double size = 1, const Vec3& by = Vec3::Zero()) {
    Shape s = shape("cube", make_cube(size, size, size, 1, 1, 1));
    for (Vec3& p : s.points) p += by;
    return s;
}

} // namespace

TEST_CASE("an iso mesh does not depend on where the surface is", "[iso][limits]") {
    const IsoMesh here = mesh_of(cube(), 0, 0.1);
    for (const double away : {std::ldexp(1.0, 12), std::ldexp(1.0, 19), -std::ldexp(1.0, 27), std::ldexp(1.0, 30)}) {
        INFO(away);
        const Vec3 by(away, 0, -2 * away);
        const IsoMesh there = mesh_of(cube(1, by), 0, 0.1);
        CHECK(there.triangles == here.triangles);
        double worst = 0;
        for (std::size_t v = 0; v < here.points.size(); ++v)
            worst = std::max(worst, (there.points[v] - by - here.points[v]).cwiseAbs().maxCoeff());
        CHECK(worst <= std::abs(away) * 2.3e-16);
        CHECK(least_angle(there.points, there.triangles) > 29.99);
    }
    // No shift is a multiple of that: other numbers, as good a mesh.
    for (const double away : {4e5, 1e8}) {
        const IsoMesh there = mesh_of(cube(1, {away / 3, away, 0.1}), 0, 0.1);
        CHECK(check_mesh(there.points, there.triangles).is_manifold());
        CHECK(least_angle(there.points, there.triangles) > 29.99);
        Points back = there.points;
        for (Vec3& p : back) p -= Vec3(away / 3, away, 0.1);
        CHECK(enclosed_volume(back, there.triangles) == Approx(1).epsilon(0.01));
    }
}

TEST_CASE("an iso mesh does not depend on the unit of length", "[iso][limits]") {
    for (const double size : {1e-59, 1e-12, 1e12, 1e50, 1e59}) {
        INFO(size);
        const IsoMesh mesh = mesh_of(cube(size), 0, 0.1 * size);
        CHECK(check_mesh(mesh.points, mesh.triangles).is_manifold());
        Points unit = mesh.points;
        for (Vec3& p : unit) p /= size;
        CHECK(enclosed_volume(unit, mesh.triangles) == Approx(1).epsilon(0.01));
        CHECK(least_angle(unit, mesh.triangles) > 29.99);
    }
}

TEST_CASE("an iso mesh has the same triangles wherever the surface stands, and in every unit", "[iso][limits]") {
    const Shape ball = shape("ball", make_sphere(1, 24, 16));
    const IsoMesh here = mesh_of(ball, 0.05, 0.2);
    REQUIRE(here.triangles.size() > 500);
    for (const double unit : {1.0, 100.0, 0.01, 39.37})
        for (const Vec3& by : {Vec3(0, 0, 0), Vec3(0.37, 11.1, -7.7), Vec3(1.0 / 3, 100, 20)}) {
            CAPTURE(unit, by.x());
            Shape other = ball;
            for (Vec3& p : other.points) p = unit * (p + by);
            const IsoMesh there = mesh_of(other, 0.05 * unit, 0.2 * unit);
            REQUIRE(there.triangles == here.triangles);
            double worst = 0;
            for (std::size_t v = 0; v < here.points.size(); ++v)
                worst = std::max(worst, (there.points[v] / unit - by - here.points[v]).norm());
            CHECK(worst < 1e-9);
        }
}

TEST_CASE("sizes and places that numbers cannot hold are refused at once", "[iso][limits]") {
    const auto begin = std::chrono::steady_clock::now();
    CHECK(refusal(cube(1e70), 0, 1e69).code == "FE224");
    CHECK(refusal(cube(1e200), 0, 1e199).code == "FE224");
    CHECK(refusal(cube(1e-70), 0, 1e-71).code == "FE224");
    CHECK(refusal(cube(1e-310), 0, 0).code == "FE224");
    CHECK(refusal(cube(), 1e80, 1).code == "FE224");
    CHECK_THROWS_AS(default_triangle_size(cube(1e200).points, cube(1e200).triangles), Error);
    const Error far = refusal(cube(1, {1e14, 0, 0}), 0, 0.1);
    CHECK(far.code == "FE224");
    CHECK(std::string(far.what()).find("0.0222045 apart") != std::string::npos);
    CHECK(refusal(cube(1, {1e17, 0, 0}), 0.1, 0.1).code == "FE224");
    // Less than a grid and a mesh take.
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(500));
}

TEST_CASE("triangles as large as you please are those of the level set's size", "[iso][limits]") {
    for (const double size : {10.0, 1e20, 1e300}) {
        INFO(size);
        const IsoMesh mesh = mesh_of(shape("ball", make_sphere(1, 24, 16)), 0, size);
        CHECK(check_mesh(mesh.points, mesh.triangles).is_manifold());
        CHECK(mesh.triangles.size() < 200);
        CHECK(least_angle(mesh.points, mesh.triangles) > 29.99);
    }
}

TEST_CASE("parts that meet in an edge are refused by place, not at the end of the time", "[iso][limits]") {
    Shape two = cube();
    append(two, cube().points, cube().triangles, {1, 1, 0});
    const Error e = refusal(two, 0, 0.09);
    CHECK(e.code == "FE234");
    // The edge is x = y = 0.5.
    double x = 0, y = 0, z = 0;
    const std::string message = e.what();
    const std::size_t at = message.find("near (");
    REQUIRE(at != std::string::npos);
    REQUIRE(std::sscanf(message.c_str() + at, "near (%lf, %lf, %lf)", &x, &y, &z) == 3);
    CHECK(x == Approx(0.5).margin(0.05));
    CHECK(y == Approx(0.5).margin(0.05));
    CHECK(std::abs(z) < 0.55);
    const IsoMesh grown = mesh_of(two, 0.05, 0.09);
    CHECK(check_mesh(grown.points, grown.triangles).components == 1);
    CHECK(check_mesh(grown.points, grown.triangles).is_manifold());
}

TEST_CASE("doubled faces have no inside: refused alone, without effect within others", "[iso][limits]") {
    Shape doubled = cube();
    for (const Triangle& t : reversed(cube().triangles)) doubled.triangles.push_back(t);
    CHECK(refusal(doubled, 0, 0.1).code == "FE223");
    CHECK(refusal(doubled, -0.1, 0.1).code == "FE223");
    CHECK(enclosed_volume(mesh_of(doubled, 0.1, 0.1).points, mesh_of(doubled, 0.1, 0.1).triangles) > 0.5);

    // A cube with a doubled sheet through its middle and beyond.
    Shape sheet = cube();
    append(sheet, Points{{-1, 0, -1}, {1, 0, -1}, {0, 0, 2}}, {{0, 1, 2}, {0, 2, 1}});
    const IsoMesh mesh = mesh_of(sheet, 0, 0.1);
    CHECK(check_mesh(mesh.points, mesh.triangles).components == 1);
    CHECK(enclosed_volume(mesh.points, mesh.triangles) == Approx(1).epsilon(0.01));
}

TEST_CASE("a plate thinner than its triangles is meshed whole or refused, never left as crumbs", "[iso][limits]") {
    const auto plate = [](double thickness) { return shape("plate", make_cube(1, thickness, 1, 1, 1, 1)); };
    IsoMeshOptions o;
    const IsoMesh thin = make_iso_mesh(plate(0.01).points, plate(0.01).triangles, o); // the triangles are 0.035 wide
    double area = 0;
    for (const Triangle& t : thin.triangles) {
        const Vec3& a = thin.points[static_cast<std::size_t>(t[0])];
        area += 0.5 * (thin.points[static_cast<std::size_t>(t[1])] - a)
                          .cross(thin.points[static_cast<std::size_t>(t[2])] - a)
                          .norm();
    }
    CHECK(area == Approx(2.04).epsilon(0.05));
    CHECK(check_mesh(thin.points, thin.triangles).is_closed());
    CHECK(refusal(plate(1e-6), 0, 0).code == "FE231");
    CHECK(mesh_of(plate(1e-6), 0.02, 0).components == 1); // the way out that the message names
}

TEST_CASE("triangles finer than the grid are refused with the place, the cell and a way out", "[iso][limits]") {
    const Shape ball = shape("ball", make_sphere(1, 24, 16));
    IsoMeshOptions o;
    o.resolution = 16;
    o.triangle_size = 0.02; // an eighth of a cell
    try {
        make_iso_mesh(ball.points, ball.triangles, o);
        FAIL("made");
    } catch (const Error& e) {
        CHECK(e.code == "FE234");
        const std::string message = e.what();
        INFO(message << " " << e.hint);
        CHECK(message.find("triangles of 0.02 are finer than the grid's cells of 0.166667") != std::string::npos);
        double x = 0, y = 0, z = 0;
        const std::size_t at = message.find("near (");
        REQUIRE(at != std::string::npos);
        REQUIRE(std::sscanf(message.c_str() + at, "near (%lf, %lf, %lf)", &x, &y, &z) == 3);
        CHECK(Vec3(x, y, z).norm() == Approx(1).margin(0.05));
        CHECK(e.hint == "Raise resolution to 67 or more, or triangleSize to 4.2 times its value.");
    }
    IsoMeshOptions finer = o, larger = o;
    finer.resolution = 67;
    CHECK(make_iso_mesh(ball.points, ball.triangles, finer).components == 1);
    larger.triangle_size = 4.2 * o.triangle_size;
    CHECK(make_iso_mesh(ball.points, ball.triangles, larger).components == 1);
}

TEST_CASE("a sheet wrapped too thinly is refused with its thickness and an isoValue that would do", "[iso][limits]") {
    const Shape sheet = shape("sheet", make_plane(1, 1, 7, 7));
    const Error e = refusal(sheet, 0.001, 0.03);
    CHECK(e.code == "FE231");
    const std::string message = e.what();
    INFO(message << " " << e.hint);
    CHECK(message.find("a sheet of thickness 0.002 (twice the isoValue)") != std::string::npos);
    CHECK(message.find("and triangles of 0.03") != std::string::npos);
    double enough = 0;
    REQUIRE(std::sscanf(e.hint.c_str(), "Give an isoValue of %lf (half a grid cell) or more", &enough) == 1);
    CHECK(enough == Approx(0.5 / 64).epsilon(0.1));
    CHECK(e.hint.find("or a resolution of ") != std::string::npos);
    CHECK(mesh_of(sheet, enough, 0.03).components == 1);
}
