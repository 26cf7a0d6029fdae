// Tets fitted to the borders of layers: conforming, of the same volume, each on one side, well shaped.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/mesh/tet_quality.h"
#include "solver/meshing/border_patches.h"
#include "solver/meshing/edge_splits.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/layer_border.h"
#include "solver/meshing/layer_place.h"
#include "tests/solver/meshing/lattice_checks.h"
#include "tests/support/rotated_box.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <random>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

const Vec3 middle(0.5, 0.5, 0.5);

SurfaceMesh moved(SurfaceMesh mesh, const Vec3& by, const Mat3& turn = Mat3::Identity()) {
    for (Vec3& p : mesh.points) p = turn * p + by;
    return mesh;
}
SurfaceMesh joined(SurfaceMesh one, const SurfaceMesh& other) {
    const int count = static_cast<int>(one.points.size());
    one.points.insert(one.points.end(), other.points.begin(), other.points.end());
    for (const Triangle& t : other.triangles) one.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
    return one;
}
SurfaceMesh unit_cube() { return RotatedBox({1, 1, 1}, 0, 0).surface(1); }
/// A box of this size in the middle of the unit cube, turned by 30 degrees about x and y.
SurfaceMesh turned_box(const Vec3& size) {
    const RotatedBox box(size, 30, 30);
    return moved(box.surface(1), middle - box.at(0.5 * size));
}
SurfaceMesh ball_in_cube(double radius) { return moved(make_sphere(radius, 46, 34), {0.52, 0.47, 0.51}); }

const RotatedBox bar({0.4, 0.1, 0.1}, 30, 30);
/// From 0.13 to 0.24 m of the bar, beyond its sides by `more`.
SurfaceMesh part_of_bar(double more) {
    return moved(RotatedBox({0.11, 0.1 + 2 * more, 0.1 + 2 * more}, 30, 30).surface(1), bar.at({0.13, -more, -more}));
}
TetMesh lattice_of(const SurfaceMesh& skin, double size, int moments = 1, Fill fill = Fill::filled_cavities) {
    LatticeOptions options;
    options.tet_size = size;
    options.moments = moments;
    options.fill = fill;
    return make_lattice(skin.points, skin.triangles, options);
}

double volume_of(const TetMesh& mesh) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const double volume = lattice_checks::volume_of(mesh, t);
        CHECK(volume > 0);
        sum += volume;
    }
    return sum;
}

/// No face hangs: each is that of two tets or in a closed boundary, which has the area that is known.
void check_conforming(const TetMesh& mesh, double boundary_area = -1) {
    std::map<std::array<int, 3>, int> faces;
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const Tet& t : mesh.tets)
        for (std::size_t k = 0; k < 4; ++k) {
            std::array<int, 3> face{t[(k + 1) % 4], t[(k + 2) % 4], t[(k + 3) % 4]};
            std::sort(face.begin(), face.end());
            ++faces[face];
            used[lattice_checks::at(t[k])] = 1;
        }
    CHECK(std::all_of(faces.begin(), faces.end(), [](const auto& f) { return f.second <= 2; }));
    CHECK(std::all_of(used.begin(), used.end(), [](char u) { return u == 1; }));
    const std::vector<Triangle> boundary = boundary_triangles(mesh.tets);
    double area = 0;
    for (const Triangle& t : boundary) {
        const auto p = [&](std::size_t k) { return mesh.vertices[lattice_checks::at(t[k])]; };
        area += 0.5 * (p(1) - p(0)).cross(p(2) - p(0)).norm();
    }
    CHECK(border_edges_of(boundary).empty());
    CHECK(enclosed_volume(mesh.vertices, boundary) == Approx(volume_of(mesh)).epsilon(1e-12));
    if (boundary_area >= 0) CHECK(area == Approx(boundary_area).epsilon(1e-9));
}

/// A fitted mesh and what is known of it.
struct Fit {
    FittedTets tets;
    std::vector<double> shares;
    double layer = 0; ///< volume, by the shares that count
    double mixed = 0; ///< of tets in part inside by the shares that count
    Fit(const TetMesh& mesh, const SurfaceMesh& place, const SurfaceMesh& skin) {
        const Solid solid = make_layer_place(place.points, place.triangles);
        tets = fit_to_borders(mesh, {&solid}, skin.points, skin.triangles);
        shares = fitted_shares(tets, 0, solid, skin.points, skin.triangles);
        REQUIRE(tets.parent.size() == tets.mesh.tets.size());
        for (std::size_t t = 0; t < shares.size(); ++t) {
            const double volume =
                lattice_checks::volume_of(tets.mesh, t) * (tets.mesh.coverage.empty() ? 1 : tets.mesh.coverage[t]);
            layer += volume * shares[t];
            if (shares[t] > 1e-9 && shares[t] < 1 - 1e-9) mixed += volume;
            // A part lies where its tet does.
            const auto part = lattice_checks::corners_of(tets.mesh, t),
                       whole = lattice_checks::corners_of(mesh, lattice_checks::at(tets.parent[t]));
            const Vec3 between = part[0] + part[1] + part[2] + part[3] - whole[0] - whole[1] - whole[2] - whole[3];
            CHECK(between.norm() / 4 < 0.75 * lattice_checks::longest_edge(whole));
        }
    }
    double least_angle() const { return dihedral_range(tets.mesh)[0]; }
};

} // namespace

TEST_CASE("edges split at random leave no hanging vertices", "[layers]") {
    TetMesh mesh = box_mesh({1, 1, 1}, 3, 3, 3);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(0, 1);
    std::vector<EdgeSplit> splits;
    for (const auto& edge : edges_of(mesh.tets)) {
        if (number(random) > 0.4) continue;
        const Vec3 a = mesh.vertices[lattice_checks::at(edge[0])], b = mesh.vertices[lattice_checks::at(edge[1])];
        splits.push_back({edge, static_cast<int>(mesh.vertices.size()), (b - a).norm()});
        mesh.vertices.push_back(a + (0.1 + 0.8 * number(random)) * (b - a));
    }
    const EdgeSplits all(splits);
    std::vector<Tet> parts;
    for (const Tet& t : mesh.tets) all.parts_of(t, parts);
    CHECK(parts.size() > 2 * mesh.tets.size());
    mesh.tets = parts;
    mesh.coverage.clear();
    check_conforming(mesh, 6);
    CHECK(volume_of(mesh) == Approx(1).epsilon(1e-12));
}

TEST_CASE("a border comes apart at its creases", "[layers]") {
    const auto count = [](const SurfaceMesh& m) {
        return border_patches(make_layer_place(m.points, m.triangles)).size();
    };
    CHECK(count(unit_cube()) == 6);
    CHECK(count(make_sphere(1, 20, 20)) == 1);
    CHECK(count(make_cylinder(1, 3, 20, 2, 1)) == 3);
    // 8 x 8 facets bend by 45 degrees: a patch for each quad would be no smooth part of anything.
    CHECK(count(make_sphere(1, 8, 12)) == 1);
    const SurfaceMesh cube = unit_cube();
    const Solid solid = make_layer_place(cube.points, cube.triangles);
    const std::vector<BorderPatch> sides = border_patches(solid);
    for (const BorderPatch& side : sides) { // goes on beyond its edges
        CHECK(std::abs(side.height(middle)) == Approx(0.5));
        CHECK(std::abs(side.height({3, 3, 3})) ==
              Approx(side.height(middle) < 0 && side.height({3, 3, 3}) > 0 ? 2 : 3));
    }
}

TEST_CASE("tets that fill a block: flat borders, creases and corners part them exactly", "[layers]") {
    const TetMesh block = box_mesh({1, 1, 1}, 5, 4, 6);
    const auto check = [&](const SurfaceMesh& place, double volume, double angle) {
        const Fit fit(block, place, unit_cube());
        CHECK(fit.mixed == 0);
        CHECK(fit.layer == Approx(volume).epsilon(1e-12));
        CHECK(fit.least_angle() > angle);
        CHECK(fit.tets.mesh.tets.size() < 2 * block.tets.size());
        CHECK(fit.tets.mesh.cut.tets.empty());
        check_conforming(fit.tets.mesh, 6);
        CHECK(volume_of(fit.tets.mesh) == Approx(1).epsilon(1e-12));
    };
    SECTION("a turned cube inside") { check(turned_box({0.5, 0.5, 0.5}), 0.125, 4); }
    SECTION("the middle third, beyond the sides") {
        check(moved(RotatedBox({0.31, 3, 3}, 0, 0).surface(1), {0.33, -1, -1}), 0.31, 4);
    }
    SECTION("a layer that shares the skin") {
        check(moved(RotatedBox({1, 1, 0.47}, 0, 0).surface(1), {0, 0, 0}), 0.47, 4);
    }
    SECTION("a sheet thinner than the tets") { // a fifteenth of them
        const SurfaceMesh sheet = turned_box({3, 3, 0.014});
        const std::vector<double> whole = layer_shares(block, make_layer_place(sheet.points, sheet.triangles),
                                                       unit_cube().points, unit_cube().triangles);
        double volume = 0;
        for (std::size_t t = 0; t < whole.size(); ++t) volume += whole[t] * lattice_checks::volume_of(block, t);
        check(sheet, volume, 1);
    }
}

TEST_CASE("tets that fill a block: volumes of curved borders are right", "[layers]") {
    double before = 1;
    for (const int n : {6, 12, 24}) {
        const SurfaceMesh ball = ball_in_cube(0.33);
        const Fit fit(box_mesh({1, 1, 1}, n, n, n), ball, unit_cube());
        const double volume = enclosed_volume(ball.points, ball.triangles), error = std::abs(fit.layer / volume - 1);
        CAPTURE(n, error, fit.mixed / volume);
        CHECK(error < 0.005 * std::pow(6.0 / n, 2));
        CHECK(error < before / 4);
        before = error;
        CHECK(fit.mixed < 0.25 * volume);
        CHECK(fit.least_angle() > 4);
        check_conforming(fit.tets.mesh, 6);
    }
}

TEST_CASE("a border that the tets are too large for stays a mean by volume", "[layers]") {
    const TetMesh block = box_mesh({1, 1, 1}, 5, 4, 6);
    for (const double radius : {0.02, 0.05}) {
        const SurfaceMesh rod = moved(make_cylinder(radius, 3, 20, 1, 1), middle, bar.turn);
        const Fit fit(block, rod, unit_cube());
        const Solid solid = make_layer_place(rod.points, rod.triangles);
        const std::vector<double> whole = layer_shares(block, solid, unit_cube().points, unit_cube().triangles);
        double volume = 0;
        for (std::size_t t = 0; t < whole.size(); ++t) volume += whole[t] * lattice_checks::volume_of(block, t);
        CHECK(fit.layer == Approx(volume).epsilon(1e-9));
    }
}

TEST_CASE("lattices: what is solid stays, each part of it on one side", "[layers]") {
    const SurfaceMesh skin = bar.surface(1);
    for (const int moments : {1, 4})
        for (const double size : {0.1, 0.05})
            for (const double more : {0.0, 0.001, 0.3}) { // ends at the skin, just beyond it, far beyond
                CAPTURE(moments, size, more);
                const TetMesh lattice = lattice_of(skin, size, moments);
                const Fit fit(lattice, part_of_bar(more), skin);
                check_conforming(fit.tets.mesh);
                CHECK(fit.tets.mesh.tets.size() < 1.35 * lattice.tets.size());
                CHECK(fit.least_angle() > 15);
                CHECK(fit.mixed < 1e-3 * 0.004);
                CHECK(fit.layer == Approx(0.0011).epsilon(1e-4)); // tets hardly touched count for a thousandth
                // The moments, which know no least coverage: volume and centre of the bar.
                const CutTets& cut = fit.tets.mesh.cut;
                REQUIRE(cut.degree == moments);
                REQUIRE(cut.moments.size() == moment_count(moments) * cut.tets.size());
                double volume = 0;
                Vec3 first = Vec3::Zero();
                std::size_t next = 0;
                for (std::size_t t = 0; t < fit.tets.mesh.tets.size(); ++t) {
                    TetMoments inside = whole_moments(moments);
                    if (next < cut.tets.size() && cut.tets[next] == static_cast<int>(t))
                        std::copy_n(cut.of(next++), moment_count(moments), inside.value.begin());
                    const double whole = lattice_checks::volume_of(fit.tets.mesh, t);
                    const auto corners = lattice_checks::corners_of(fit.tets.mesh, t);
                    volume += whole * inside.volume();
                    for (std::size_t c = 0; c < 4; ++c)
                        first += whole * corners[c] *
                                 (moments == 1 ? inside.value[c] : MomentTensors(inside.value.data()).first[c]);
                }
                CHECK(volume == Approx(0.004).epsilon(1e-9));
                CHECK((first / volume - bar.at({0.2, 0.05, 0.05})).norm() < 1e-9);
            }
}

TEST_CASE("layers part a body into the same tets wherever it stands", "[layers]") {
    // Symmetric, so that lattice, edges and heights tie everywhere.
    const SurfaceMesh skin = make_cube(2.4, 0.6, 0.6, 24, 6, 6);
    SurfaceMesh muscle = make_sphere(0.24, 24, 16);
    for (Vec3& p : muscle.points) p.x() *= 4;
    const Fit here(lattice_of(skin, 0.2), muscle, skin);
    REQUIRE(here.tets.mesh.tets.size() > 2000);
    for (const Vec3& by : {Vec3(0.1, 0, 0), Vec3(1, 2, 3), Vec3(0.37, 11.1, -7.7)}) {
        CAPTURE(by.x());
        SurfaceMesh there_skin = skin, there_muscle = muscle;
        for (Vec3& p : there_skin.points) p += by;
        for (Vec3& p : there_muscle.points) p += by;
        const Fit there(lattice_of(there_skin, 0.2), there_muscle, there_skin);
        REQUIRE(there.tets.mesh.tets == here.tets.mesh.tets);
        double farthest = 0, most = 0;
        for (std::size_t v = 0; v < here.tets.mesh.vertices.size(); ++v)
            farthest = std::max(farthest, (there.tets.mesh.vertices[v] - by - here.tets.mesh.vertices[v]).norm());
        for (std::size_t t = 0; t < here.shares.size(); ++t)
            most = std::max(most, std::abs(there.shares[t] - here.shares[t]));
        CHECK(farthest < 1e-9);
        CHECK(most < 1e-8);
    }
}

TEST_CASE("two layers in one mesh", "[layers]") {
    const TetMesh block = box_mesh({1, 1, 1}, 5, 4, 6);
    const SurfaceMesh one = turned_box({0.5, 0.5, 0.5}),
                      other = moved(RotatedBox({3, 3, 1}, 0, 0).surface(1), {-1, -1, 0.47});
    const Solid a = make_layer_place(one.points, one.triangles), b = make_layer_place(other.points, other.triangles);
    const SurfaceMesh skin = unit_cube();
    const FittedTets fit = fit_to_borders(block, {&a, &b}, skin.points, skin.triangles);
    check_conforming(fit.mesh, 6);
    double of[2] = {};
    for (std::size_t k = 0; k < 2; ++k) {
        const std::vector<double> shares = fitted_shares(fit, k, k == 0 ? a : b, skin.points, skin.triangles);
        for (std::size_t t = 0; t < shares.size(); ++t) {
            CHECK((shares[t] < 1e-9 || shares[t] > 1 - 1e-9));
            of[k] += shares[t] * lattice_checks::volume_of(fit.mesh, t);
        }
    }
    CHECK(of[0] == Approx(0.125).epsilon(1e-12));
    CHECK(of[1] == Approx(0.53).epsilon(1e-12));
}

TEST_CASE("parts that overlap part tets at their outside alone", "[layers]") {
    const TetMesh block = box_mesh({1, 1, 1}, 6, 6, 6);
    // Two bricks end in each other; together they are one of 0.6 x 0.4 x 0.4.
    const SurfaceMesh both = joined(moved(RotatedBox({0.4, 0.4, 0.4}, 0, 0).surface(1), {0.21, 0.3, 0.3}),
                                    moved(RotatedBox({0.4, 0.4, 0.4}, 0, 0).surface(1), {0.41, 0.3, 0.3}));
    const Fit fit(block, both, unit_cube());
    CHECK(fit.mixed < 0.003 * 0.096); // where faces cross
    CHECK(fit.layer == Approx(0.096).epsilon(1e-12));
}

TEST_CASE("tets that no border crosses, or that are not understood, stay", "[layers]") {
    const auto unchanged = [](const TetMesh& mesh, const SurfaceMesh& place, const SurfaceMesh& skin) {
        const Fit fit(mesh, place, skin);
        CHECK(fit.tets.mesh.vertices == mesh.vertices);
        CHECK(fit.tets.mesh.tets == mesh.tets);
        CHECK(fit.tets.mesh.coverage == mesh.coverage);
        CHECK(fit.tets.mesh.cut == mesh.cut);
        for (const double s : fit.tets.slack[0]) CHECK(s == 0);
    };
    const SurfaceMesh skin = bar.surface(1), place = part_of_bar(0.3);
    unchanged(lattice_of(skin, 0.07), moved(place, {5, 0, 0}), skin); // away
    RotatedBox wider = bar;
    wider.size *= 1.1;
    unchanged(lattice_of(wider.surface(1), 0.07), place, skin); // made for another mesh
    const SurfaceMesh hollow = joined(make_sphere(1, 20, 20), make_sphere(0.7, 20, 20));
    unchanged(lattice_of(hollow, 0.5, 1, Fill::empty_cavities), moved(make_sphere(0.6, 20, 20), {0.7, 0, 0}), hollow);
}

TEST_CASE("fitted tets are the same for any number of threads", "[layers]") {
    const SurfaceMesh skin = bar.surface(1);
    const SurfaceMesh place = moved(make_sphere(0.06, 46, 34), bar.at({0.2, 0.05, 0.05}));
    std::vector<FittedTets> made;
    for (const std::size_t threads : {1, 2}) {
        tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const Solid solid = make_layer_place(place.points, place.triangles);
        made.push_back(fit_to_borders(lattice_of(skin, 0.03, 4), {&solid}, skin.points, skin.triangles));
    }
    CHECK(made[0].mesh.vertices == made[1].mesh.vertices);
    CHECK(made[0].mesh.tets == made[1].mesh.tets);
    CHECK(made[0].mesh.coverage == made[1].mesh.coverage);
    CHECK(made[0].mesh.cut == made[1].mesh.cut);
    CHECK(made[0].parent == made[1].parent);
    CHECK(made[0].slack == made[1].slack);
}

TEST_CASE("fitting can be stopped", "[layers]") {
    const SurfaceMesh cube = unit_cube(), place = turned_box({0.5, 0.5, 0.5});
    const Solid solid = make_layer_place(place.points, place.triangles);
    const TetMesh block = box_mesh({1, 1, 1}, 5, 4, 6);
    int asked = 0;
    const MeshingControl control{[&] { return ++asked == 3; }, {}};
    CHECK_THROWS_AS(fit_to_borders(block, {&solid}, cube.points, cube.triangles, control), Stopped);
}
TEST_CASE("random layers in random bodies: tets conform, and nothing is lost", "[layers]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(0, 1);
    const auto turn = [&] {
        const Vec3 axis(number(random) - 0.5, number(random) - 0.5, number(random) - 0.5);
        return Mat3(Eigen::AngleAxisd(6 * number(random), axis.normalized()).toRotationMatrix());
    };
    for (int round = 0; round < 12; ++round) {
        SurfaceMesh skin = round % 3 == 0   ? make_sphere(0.6, 24, 18)
                           : round % 3 == 1 ? moved(make_cylinder(0.3, 1.5, 24, 6, 2), Vec3::Zero(), turn())
                                            : make_helix(0.5, 0.2, 1, 1.5, 10, 30);
        const Vec3 by(0.5 * (number(random) - 0.5), 0.5 * (number(random) - 0.5), 0.5 * (number(random) - 0.5));
        const double size = 0.3 + 0.2 * number(random), radius = 0.02 + 0.4 * number(random);
        SurfaceMesh place;
        switch (round % 5) {
        case 0:
            place = moved(make_sphere(radius, 20, 14), by);
            break;
        case 1:
            place = moved(make_cylinder(radius, 2, 6, 3, 1), by, turn());
            break;
        case 2:
            place = moved(RotatedBox({1.5 * radius, 1, 0.1 + radius}, 0, 0).surface(2), by, turn());
            break;
        case 3:
            place = moved(make_helix(0.3, radius / 3, 0.8, 1.5, 9, 20), by, turn());
            break;
        default: // what of the body lies on one side, its skin and all
            place = skin;
            for (Vec3& p : place.points) p.x() = std::min(p.x(), by.x());
        }
        CAPTURE(round, size, radius);
        LatticeOptions options;
        options.tet_size = size;
        options.moments = round % 2 ? 4 : 1;
        if (round % 4 == 0)
            for (std::size_t v = 0; v < skin.points.size(); ++v) options.refinement.push_back(number(random) < 0.1);
        const TetMesh lattice = make_lattice(skin.points, skin.triangles, options);
        const Solid solid = make_layer_place(place.points, place.triangles);
        const FittedTets fit = fit_to_borders(lattice, {&solid}, skin.points, skin.triangles);
        check_conforming(fit.mesh);
        const auto volumes = [&](const TetMesh& mesh) {
            const std::vector<double> shares = layer_shares(mesh, solid, skin.points, skin.triangles);
            std::array<double, 2> out{};
            for (std::size_t t = 0; t < shares.size(); ++t) {
                const double volume = lattice_checks::volume_of(mesh, t) * mesh.coverage[t];
                out[0] += volume, out[1] += volume * shares[t];
            }
            return out;
        };
        const auto before = volumes(lattice), after = volumes(fit.mesh);
        CHECK(after[0] == Approx(before[0]).epsilon(5e-4)); // tets hardly touched count for a thousandth
        CHECK(after[1] == Approx(before[1]).margin(5e-4 * before[0]));
        CHECK(fit.mesh.tets.size() < 4 * lattice.tets.size());
    }
}
