// SurfaceOnly of sheets: a shell of the thickness that is asked for, in any lattice.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/sheet_shell.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace sinew::solver;

namespace {

/// n x n squares of two triangles over [0, 1]^2, lifted by `up`.
template <class Up>
SurfaceMesh sheet(int n, const Up& up) {
    SurfaceMesh out;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const double x = double(i) / n, y = double(j) / n;
            out.points.emplace_back(x, y, up(x, y));
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            out.triangles.push_back({a, b, d});
            out.triangles.push_back({a, d, c});
        }
    return out;
}

double flat(double, double) { return 0; }

/// What the tets hold, without a least share.
double solid_volume(const SurfaceMesh& mesh, double size, double thickness) {
    LatticeOptions options;
    options.fill = Fill::surface_only;
    options.tet_size = size;
    options.thickness = thickness;
    options.least_coverage = 0;
    const TetMesh tets = make_lattice(mesh.points, mesh.triangles, options);
    double sum = 0;
    for (std::size_t t = 0; t < tets.tets.size(); ++t) {
        const auto v = [&](std::size_t k) { return tets.vertices[static_cast<std::size_t>(tets.tets[t][k])]; };
        sum += tets.coverage[t] * tet_volume(v(0), v(1), v(2), v(3));
    }
    return sum;
}

std::string code(const SurfaceMesh& mesh, double thickness) {
    LatticeOptions options;
    options.fill = Fill::surface_only;
    options.thickness = thickness;
    try {
        make_lattice(mesh.points, mesh.triangles, options);
    } catch (const Error& e) {
        return e.code;
    }
    return "";
}

} // namespace

TEST_CASE("the shell of a flat sheet holds its area times its thickness, in tets of any size", "[meshing]") {
    const SurfaceMesh plane = sheet(5, flat);
    CHECK(is_sheet(plane.points, plane.triangles));
    for (const double size : {0.5, 0.13}) {
        CHECK(solid_volume(plane, size, 0.05) == Approx(0.05).epsilon(1e-9));
        CHECK(solid_volume(plane, size, 0) == Approx(size / 10).epsilon(1e-9)); // a tenth of the tets
    }
    CHECK(solid_volume(plane, 0.08, 0.3) == Approx(0.3).epsilon(1e-9)); // thicker than its tets
}

TEST_CASE("the shell of a bent sheet holds area times thickness but for its curvature", "[meshing]") {
    // A quarter of a cylinder of radius 2/pi.
    const double r = 2 / std::numbers::pi;
    SurfaceMesh bent = sheet(24, flat);
    for (Vec3& p : bent.points) {
        const double angle = p.x() / r;
        p = {r * std::sin(angle), p.y(), r * std::cos(angle)};
    }
    CHECK(is_sheet(bent.points, bent.triangles));
    CHECK(solid_volume(bent, 0.2, 0.04) == Approx(0.04).epsilon(2e-3));
}

TEST_CASE("corners of a sheet are mitred: an open box has walls of one thickness", "[meshing]") {
    // A cube of 1 without its lid; between the inner and the outer box of half the thickness more and less.
    SurfaceMesh box;
    for (int v = 0; v < 8; ++v) box.points.emplace_back(v & 1, v >> 1 & 1, v >> 2);
    const int quads[5][4] = {{0, 2, 3, 1}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}};
    for (const auto& q : quads) {
        box.triangles.push_back({q[0], q[1], q[2]});
        box.triangles.push_back({q[0], q[2], q[3]});
    }
    CHECK(is_sheet(box.points, box.triangles));
    const double t = 0.1, outer = (1 + t) * (1 + t) * (1 + t / 2), inner = (1 - t) * (1 - t) * (1 - t / 2);
    CHECK(solid_volume(box, 0.3, t) == Approx(outer - inner).epsilon(1e-6));
}

TEST_CASE("a closed surface is no sheet, with a thickness it is a shell with a cavity", "[meshing]") {
    SurfaceMesh box = sheet(1, flat);
    box.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    box.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    CHECK_FALSE(is_sheet(box.points, box.triangles));
    // A tet offset by d to all sides is a larger one: inradius r makes the scale 1 + d / r.
    const double area = 1.5 + std::sqrt(3) / 2, volume = 1. / 6, r = 3 * volume / area, d = 0.02;
    const double shell = volume * (std::pow(1 + d / r, 3) - std::pow(1 - d / r, 3));
    CHECK(solid_volume(box, 0.15, 2 * d) == Approx(shell).epsilon(1e-6));
    const double all = solid_volume(box, 0.15, 0);
    CHECK(all > shell); // the tets that it passes through, as solid as the inside
    CHECK(all <= volume * (1 + 1e-9));
}

TEST_CASE("sheets that no shell stands for are refused", "[meshing]") {
    CHECK(code(sheet(4, flat), 0.6) == "FE298");
    SurfaceMesh ring; // of Moebius
    const int n = 24;
    for (int i = 0; i < n; ++i) {
        const double turn = 2 * std::numbers::pi * i / n, tilt = turn / 2;
        for (const double s : {-0.2, 0.2}) {
            const double radius = 1 + s * std::cos(tilt);
            ring.points.emplace_back(radius * std::cos(turn), radius * std::sin(turn), s * std::sin(tilt));
        }
    }
    for (int i = 0; i < n; ++i) {
        const int a = 2 * i, b = a + 1, c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? a + 3 : 0;
        ring.triangles.push_back({a, c, d});
        ring.triangles.push_back({a, d, b});
    }
    CHECK(code(ring, 0.05) == "FE223");
    SurfaceMesh none;
    none.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    none.triangles = {{0, 1, 2}};
    CHECK(code(none, 0.05) == "FE223");
    CHECK(code(sheet(2, flat), 0.2).empty());
}

TEST_CASE("paint refines a sheet's shell on both sides", "[meshing]") {
    const SurfaceMesh plane = sheet(4, flat);
    LatticeOptions options;
    options.fill = Fill::surface_only;
    options.tet_size = 0.3;
    const std::size_t plain = make_lattice(plane.points, plane.triangles, options).tets.size();
    for (const Vec3& p : plane.points) options.refinement.push_back(p.x() > 0.6 ? 1 : 0);
    const std::size_t painted = make_lattice(plane.points, plane.triangles, options).tets.size();
    CHECK(painted > plain);
    options.refinement = {1};
    CHECK(make_lattice(plane.points, plane.triangles, options).tets.size() > painted);
}
