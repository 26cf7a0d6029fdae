// Shares of tets in closed meshes, against volumes known otherwise.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/layer_place.h"
#include "solver/meshing/tet_share.h"
#include "tests/solver/meshing/lattice_checks.h"
#include "tests/support/rotated_box.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <numbers>
#include <random>
#include <string>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

SurfaceMesh moved(SurfaceMesh mesh, const Mat3& turn, const Vec3& by) {
    for (Vec3& p : mesh.points) p = turn * p + by;
    return mesh;
}
Solid place_of(const SurfaceMesh& mesh) { return make_layer_place(mesh.points, mesh.triangles); }

/// Volume of the layer's part of the solid.
double layer_volume(const TetMesh& tets, const SurfaceMesh& place, const SurfaceMesh& skin) {
    const std::vector<double> shares = layer_shares(tets, place_of(place), skin.points, skin.triangles);
    double sum = 0;
    for (std::size_t t = 0; t < tets.tets.size(); ++t) {
        CHECK((shares[t] >= 0 && shares[t] <= 1));
        sum += shares[t] * (tets.coverage.empty() ? 1 : tets.coverage[t]) * lattice_checks::volume_of(tets, t);
    }
    return sum;
}

TetMesh lattice_of(const SurfaceMesh& skin, double size, int moments = 1) {
    LatticeOptions options;
    options.tet_size = size;
    options.moments = moments;
    options.least_coverage = 0; // volumes below are exact
    return make_lattice(skin.points, skin.triangles, options);
}

const RotatedBox bar({0.4, 0.1, 0.1}, 30, 30);

/// A box given in the bar's own coordinates.
SurfaceMesh part_of_bar(const Vec3& low, const Vec3& high) {
    SurfaceMesh mesh = RotatedBox(high - low, 30, 30).surface(1);
    return moved(mesh, Mat3::Identity(), bar.at(low));
}

std::string code_of(const SurfaceMesh& mesh, std::string* text = nullptr) {
    try {
        place_of(mesh);
    } catch (const Error& e) {
        if (text) *text = e.what();
        return e.code;
    }
    return "none";
}

} // namespace

TEST_CASE("the shares of whole tets add up to the volume of what is inside", "[layers]") {
    const TetMesh block = box_mesh({1, 1, 1}, 5, 4, 6);
    const SurfaceMesh skin = RotatedBox({1, 1, 1}, 0, 0).surface(1);
    SECTION("a ball in the middle") {
        const SurfaceMesh ball = moved(make_sphere(0.33, 23, 17), Mat3::Identity(), {0.52, 0.47, 0.51});
        CHECK(layer_volume(block, ball, skin) == Approx(enclosed_volume(ball.points, ball.triangles)).epsilon(1e-12));
    }
    SECTION("a small one in a single tet") {
        const SurfaceMesh ball = moved(make_sphere(0.01, 8, 8), Mat3::Identity(), {0.31, 0.27, 0.29});
        CHECK(layer_volume(block, ball, skin) == Approx(enclosed_volume(ball.points, ball.triangles)).epsilon(1e-9));
    }
    SECTION("a box that ends at faces of tets") {
        const SurfaceMesh box = moved(RotatedBox({0.6, 0.5, 0.5}, 0, 0).surface(3), Mat3::Identity(), {0.2, 0.25, 0});
        const std::vector<double> shares = layer_shares(block, place_of(box), skin.points, skin.triangles);
        for (const double s : shares) CHECK((s == Approx(0).margin(1e-12) || s == Approx(1).epsilon(1e-12)));
        CHECK(layer_volume(block, box, skin) == Approx(0.15).epsilon(1e-12));
    }
    SECTION("two balls that cross, one of them inside out") {
        SurfaceMesh one = moved(make_sphere(0.2, 20, 20), Mat3::Identity(), {0.4, 0.5, 0.5});
        SurfaceMesh other = moved(make_sphere(0.2, 20, 20), Mat3::Identity(), {0.6, 0.5, 0.5});
        const int count = static_cast<int>(one.points.size());
        SurfaceMesh both = one;
        both.points.insert(both.points.end(), other.points.begin(), other.points.end());
        for (Triangle t : other.triangles) both.triangles.push_back({t[0] + count, t[2] + count, t[1] + count});
        // Two caps of height h = 0.1 lie in both balls: pi h^2 (3 r - h) / 3 each. 20 by 20 facets lack 2.4 %.
        const double pi = std::numbers::pi, ball = 4 * pi / 3 * 0.008, caps = 2 * pi * 0.01 * (0.6 - 0.1) / 3;
        CHECK(layer_volume(block, both, skin) == Approx(2 * ball - caps).epsilon(0.03));
    }
    SECTION("a shell inside another bounds a hollow, whatever way it is turned") {
        for (const bool turned : {false, true}) {
            SurfaceMesh shells = moved(make_sphere(0.4, 20, 20), Mat3::Identity(), {0.5, 0.5, 0.5});
            SurfaceMesh inner = moved(make_sphere(0.3, 20, 20), Mat3::Identity(), {0.5, 0.5, 0.5});
            const double volume =
                enclosed_volume(shells.points, shells.triangles) - enclosed_volume(inner.points, inner.triangles);
            const int count = static_cast<int>(shells.points.size());
            shells.points.insert(shells.points.end(), inner.points.begin(), inner.points.end());
            for (Triangle t : inner.triangles) {
                if (turned) std::swap(t[1], t[2]);
                shells.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
            }
            CHECK(layer_volume(block, shells, skin) == Approx(volume).epsilon(1e-9));
        }
    }
}

TEST_CASE("of tets that the skin cuts a layer takes its share of the solid part", "[layers]") {
    const SurfaceMesh skin = bar.surface(1);
    for (const int moments : {1, 4})
        for (const double size : {0.09, 0.045}) {
            CAPTURE(moments, size);
            const TetMesh tets = lattice_of(skin, size, moments);
            // Slabs across the bar and along it that reach far beyond the skin.
            CHECK(layer_volume(tets, part_of_bar({0.13, -1, -1}, {0.24, 1, 1}), skin) ==
                  Approx(0.11 * 0.01).epsilon(1e-9));
            CHECK(layer_volume(tets, part_of_bar({-1, -1, 0.023}, {2, 1, 0.061}), skin) ==
                  Approx(0.4 * 0.1 * 0.038).epsilon(1e-9));
            // Any plane through the middle halves it.
            const Mat3 turn = RotatedBox({1, 1, 1}, 17, -55).turn;
            const SurfaceMesh half =
                moved(make_cube(4, 4, 4, 1, 1, 1), turn, bar.at(0.5 * bar.size) + turn * Vec3(2, 0, 0));
            CHECK(layer_volume(tets, half, skin) == Approx(0.5 * bar.size.prod()).epsilon(1e-9));
            // What has faces in the skin.
            CHECK(layer_volume(tets, part_of_bar({0.13, 0, 0}, {0.4, 0.1, 0.1}), skin) ==
                  Approx(0.27 * 0.01).epsilon(1e-9));
            CHECK(layer_volume(tets, part_of_bar({0.13, 0.1, 0}, {0.4, 0.2, 0.1}), skin) == Approx(0).margin(1e-12));
            // All of it, and more.
            const std::vector<double> all =
                layer_shares(tets, place_of(part_of_bar({-1, -1, -1}, {2, 2, 2})), skin.points, skin.triangles);
            CHECK(all == std::vector<double>(tets.tets.size(), 1.0));
            const std::vector<double> itself = layer_shares(tets, place_of(skin), skin.points, skin.triangles);
            for (const double s : itself) CHECK(s == Approx(1).epsilon(1e-9));
        }
}

TEST_CASE("curved skins and curved layers that cross: what is in both", "[layers]") {
    // Two balls of the same size: each cap as high as the middle plane leaves.
    const SurfaceMesh skin = moved(make_sphere(0.5, 60, 60), Mat3::Identity(), {0, 0, 0});
    const SurfaceMesh other = moved(make_sphere(0.5, 60, 60), RotatedBox({1, 1, 1}, 41, 13).turn, {0.4, 0.1, 0.2});
    const double distance = Vec3(0.4, 0.1, 0.2).norm(), h = 0.5 - distance / 2, pi = std::numbers::pi;
    const double lens = 2 * pi * h * h * (1.5 - h) / 3;
    for (const double size : {0.5, 0.2})
        CHECK(layer_volume(lattice_of(skin, size), other, skin) == Approx(lens).epsilon(0.005));
    // The same sum, however coarse: exact shares do not depend on the tets.
    CHECK(layer_volume(lattice_of(skin, 0.5), other, skin) ==
          Approx(layer_volume(lattice_of(skin, 0.13), other, skin)).epsilon(1e-8));
}

TEST_CASE("what two solids share does not depend on the tets, however they lie", "[layers]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> anywhere(-0.5, 0.5);
    const SurfaceMesh skin = make_sphere(0.5, 16, 12);
    const TetMesh coarse = lattice_of(skin, 0.6), fine = lattice_of(skin, 0.17);
    for (int trial = 0; trial < 12; ++trial) {
        CAPTURE(trial);
        const SurfaceMesh shape = trial % 2 ? make_cube(0.5, 0.3, 0.7, 2, 1, 3) : make_helix(0.3, 0.1, 0.5, 1.5, 8, 20);
        const Mat3 turn = RotatedBox({1, 1, 1}, 360 * anywhere(random), 360 * anywhere(random)).turn;
        const SurfaceMesh place = moved(shape, turn, {anywhere(random), anywhere(random), anywhere(random)});
        const double volume = layer_volume(coarse, place, skin);
        CHECK(volume == Approx(layer_volume(fine, place, skin)).epsilon(1e-7).margin(1e-9));
        CHECK(volume < enclosed_volume(place.points, place.triangles) + 1e-9);
    }
}

TEST_CASE("tets that were cut by another surface take the share of the whole tet", "[layers]") {
    const SurfaceMesh skin = bar.surface(1), wider = part_of_bar({-0.01, -0.01, -0.01}, {0.41, 0.11, 0.11});
    const SurfaceMesh place = part_of_bar({0.13, -1, -1}, {0.24, 1, 1});
    const TetMesh tets = lattice_of(skin, 0.09);
    TetMesh uncut = tets;
    uncut.cut = {};
    const std::vector<double> whole = layer_shares(uncut, place_of(place), skin.points, skin.triangles);
    CHECK(layer_shares(tets, place_of(place), wider.points, wider.triangles) == whole);
    CHECK(layer_shares(tets, place_of(place), skin.points, skin.triangles) != whole);
}

TEST_CASE("shares are the same bits for one thread and two", "[layers]") {
    const SurfaceMesh skin = bar.surface(1), place = part_of_bar({0.13, 0.02, -1}, {0.24, 1, 1});
    const TetMesh tets = lattice_of(skin, 0.03);
    std::vector<double> shares[2];
    for (const std::size_t threads : {1, 2}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        shares[threads - 1] = layer_shares(tets, place_of(place), skin.points, skin.triangles);
    }
    CHECK(shares[0] == shares[1]);
}

TEST_CASE("a layer's mesh must be closed and have an inside", "[layers]") {
    std::string text;
    CHECK(code_of(make_plane(1, 1, 2, 2)) == "FE230");
    SurfaceMesh box = make_cube(1, 1, 1, 2, 2, 2);
    CHECK(code_of(box) == "none");
    box.triangles.pop_back();
    CHECK(code_of(box, &text) == "FE230");
    CHECK(text.find("open at 3 edges") != std::string::npos);
    CHECK(code_of({}) == "FE201");
    SurfaceMesh flat = make_cube(1, 1, 1, 1, 1, 1);
    for (Vec3& p : flat.points) p.y() = 0;
    CHECK(code_of(flat) == "FE223");
}

TEST_CASE("points in a layer: inside or on it", "[layers]") {
    const SurfaceMesh box = make_cube(1, 1, 1, 1, 1, 1);
    const Points points{{0, 0, 0}, {0.5, 0.1, 0.2}, {0.5 + 4e-7, 0, 0}, {0.51, 0, 0}, {0.5, 0.5, 0.5}, {9, 9, 9}};
    CHECK(points_in_layer(points, place_of(box)) == std::vector<double>{1, 1, 1, 0, 1, 0});
}
