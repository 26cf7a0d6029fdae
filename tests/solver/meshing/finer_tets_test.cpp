// Tets cut into eight: their volumes, what of them is solid, and fibre directions on them against a known field.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/fibre_field.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/finer_tets.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/solid.h"
#include "solver/meshing/tet_share.h"
#include "tests/solver/meshing/lattice_checks.h"
#include "tests/support/side_fibres.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tbb/global_control.h>

using namespace sinew::solver;
using sinew::test::side_fibre_error;

namespace {

using lattice_checks::at;

TetMesh lattice_of(const SurfaceMesh& skin, double size) {
    LatticeOptions options;
    options.tet_size = size;
    options.least_coverage = 0; // else tets with next to nothing inside count for more than they hold
    return make_lattice(skin.points, skin.triangles, options);
}

double solid(const TetMesh& tets, std::size_t t) { return tets.coverage[t] * lattice_checks::volume_of(tets, t); }

/// Solid volume of the parts of each tet.
std::vector<double> of_parents(const FinerTets& finer, std::size_t count) {
    std::vector<double> out(count, 0.0);
    for (std::size_t k = 0; k < finer.parent.size(); ++k) out[at(finer.parent[k])] += solid(finer.mesh, k);
    return out;
}

/// A surface with painted ends of fibres.
struct Muscle {
    SurfaceMesh skin;
    std::vector<double> ends;
    std::vector<char> painted;

    Points gradients(const TetMesh& tets) const {
        return fibre_gradients(tets, {skin.points, skin.triangles, embed(tets, skin.points)}, ends, painted);
    }
    /// By smaller tets.
    Points fibres(const TetMesh& tets) const {
        const FinerTets finer = finer_tets(tets, skin.points, skin.triangles);
        return fibre_directions(tets, means_over_parts(finer, gradients(finer.mesh), tets.tets.size()));
    }
};

/// What side_fibres.h has the fibres of.
Muscle side_strip() {
    Muscle out{make_cube(4, 1, 1, 32, 32, 8), {}, {}};
    for (const Vec3& p : out.skin.points) {
        const bool source = p.y() < -0.5 + 1e-9, sink = !source && p.x() > 2 - 1e-9;
        out.painted.push_back(source || sink);
        out.ends.push_back(sink ? 1 : 0);
    }
    return out;
}

} // namespace

TEST_CASE("a corner on the surface tells nothing of the share inside, and the others do", "[solver]") {
    const SurfaceMesh box = make_cube(2, 2, 2, 1, 1, 1);
    const Solid cube = make_solid(box.points, box.triangles);
    const std::vector<double> windings =
        corner_windings(cube, {Vec3(0.1, 0.2, 1), Vec3(0.1, 0.2, 0.5), Vec3(0.1, 0.2, 1.5)}, {1, 1, 1});
    CHECK(std::isnan(windings[0]));
    CHECK(windings[1] == 1);
    CHECK(windings[2] == 0);
    // Cut by the plane z = 1 through a corner: the edges of the part below are 1, 1/4 and 1/4 of the tet's.
    const std::array<Vec3, 4> corners{Vec3(0, 0, 1), Vec3(0, 0.5, 1.75), Vec3(0.5, 0, 1.75), Vec3(0.1, 0.1, 0.75)};
    std::vector<int> all(box.triangles.size());
    std::iota(all.begin(), all.end(), 0);
    const std::vector<int> touching = touching_triangles(cube, corners, all);
    const std::vector<double> at_corners =
        corner_windings(cube, Points(corners.begin(), corners.end()), {0.9, 0.9, 0.9, 0.9});
    const double share = closed_share(cube, corners, touching);
    CHECK(closed_share(cube, corners, touching, {at_corners[0], at_corners[1], at_corners[2], at_corners[3]}) == share);
    CHECK(std::abs(share - 1.0 / 16) < 1e-12);
}

TEST_CASE("parts of tets have their volume, and of what is cut the solid's", "[mesh][finer]") {
    const SurfaceMesh ball = make_sphere(1, 20, 20);
    for (const double size : {0.9, 0.35}) {
        const TetMesh tets = lattice_of(ball, size);
        const FinerTets finer = finer_tets(tets, ball.points, ball.triangles);
        CAPTURE(size, tets.tets.size(), finer.parent.size());
        const std::vector<double> sums = of_parents(finer, tets.tets.size());
        double lost = 0; // parts with next to nothing inside are left out
        for (std::size_t t = 0; t < sums.size(); ++t)
            lost = std::max(lost, std::abs(solid(tets, t) - sums[t]) / lattice_checks::volume_of(tets, t));
        CHECK(lost < 1e-3);
        CHECK(lattice_checks::covered_volume(finer.mesh) ==
              Approx(enclosed_volume(ball.points, ball.triangles)).epsilon(1e-4));
        // A lattice's tets again, all of them, and none beyond the ball.
        lattice_checks::Angles angles;
        double farthest = 0;
        for (std::size_t k = 0; k < finer.parent.size(); ++k) {
            lattice_checks::add_dihedral_angles(lattice_checks::corners_of(finer.mesh, k), angles);
            double nearest = 10;
            for (const int v : finer.mesh.tets[k]) nearest = std::min(nearest, finer.mesh.vertices[at(v)].norm());
            farthest = std::max(farthest, nearest);
        }
        CHECK(angles.least == Approx(60));
        CHECK(angles.most == Approx(90));
        CHECK(farthest < 1);
    }
}

TEST_CASE("few tets are cut twice, most once, very many not at all", "[mesh][finer]") {
    const SurfaceMesh cube = make_cube(1, 1, 1, 1, 1, 1);
    // Fitting tets, all of them solid.
    const auto parts = [&](int n) {
        TetMesh tets;
        for (int i = 0; i < n; ++i) {
            const double x = 2.0 * i;
            for (const Vec3& p : {Vec3(x, 0, 0), Vec3(x + 1, 0, 0), Vec3(x, 1, 0), Vec3(x, 0, 1)})
                tets.vertices.push_back(p);
            tets.tets.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
        }
        const FinerTets finer = finer_tets(tets, cube.points, cube.triangles);
        CHECK(finer.parent.size() == finer.mesh.tets.size());
        return finer.parent.size() / static_cast<std::size_t>(n);
    };
    CHECK(parts(1) == 64);
    CHECK(parts(500) == 64);
    CHECK(parts(501) == 8);
    CHECK(parts(12'500) == 8);
    CHECK(parts(12'501) == 1);
}

TEST_CASE("where the surface is not what cut the tets they stay as they are", "[mesh][finer]") {
    const SurfaceMesh ball = make_sphere(1, 20, 20);
    const TetMesh tets = lattice_of(ball, 0.5);
    SurfaceMesh open = ball;
    open.triangles.resize(open.triangles.size() / 2);
    for (const SurfaceMesh& other : {make_sphere(1.1, 20, 20), open}) {
        const FinerTets finer = finer_tets(tets, other.points, other.triangles);
        CHECK(finer.mesh.tets == tets.tets);
        CHECK(finer.mesh.coverage == tets.coverage);
    }
    // A coverage that is raised above what is inside is no disagreement.
    LatticeOptions options;
    options.tet_size = 0.35;
    options.least_coverage = 0.02;
    const TetMesh raised = make_lattice(ball.points, ball.triangles, options);
    REQUIRE(lattice_checks::covered_volume(raised) > enclosed_volume(ball.points, ball.triangles) + 1e-4);
    CHECK(lattice_checks::covered_volume(finer_tets(raised, ball.points, ball.triangles).mesh) ==
          Approx(enclosed_volume(ball.points, ball.triangles)).epsilon(1e-4));
}

TEST_CASE("fibres that begin on a whole side run as the exact field does, in tets as thick as the strip",
          "[mesh][finer]") {
    const Muscle strip = side_strip();
    for (const double size : {1.0, 0.7, 0.6, 0.3}) {
        const TetMesh tets = lattice_of(strip.skin, size);
        const double own = side_fibre_error(tets, fibre_directions(tets, strip.gradients(tets))),
                     better = side_fibre_error(tets, strip.fibres(tets));
        CAPTURE(size, own, better);
        CHECK(better < 2);
        CHECK(better < 0.4 * own);
    }
}

TEST_CASE("fibres through a plate thinner than its tets run straight", "[mesh][finer]") {
    // From the whole of the lower side to the whole of the upper one, which are nearest to the same vertices.
    for (const auto& [side, height, size, most] :
         {std::array{6.0, 0.2, 1.0, 1.0}, std::array{6.0, 0.3, 1.0, 1.0}, std::array{4.0, 0.1, 2.0, 6.0}}) {
        Muscle plate{make_cube(side, height, side, 12, 1, 12), {}, {}};
        for (const Vec3& p : plate.skin.points) plate.ends.push_back(p.y() > 0 ? 1 : 0), plate.painted.push_back(1);
        const TetMesh tets = lattice_of(plate.skin, size);
        const Points fibres = plate.fibres(tets);
        double sum = 0, total = 0;
        for (std::size_t t = 0; t < fibres.size(); ++t) {
            const double angle = std::acos(std::clamp(fibres[t].y(), -1.0, 1.0)) * 180 / std::numbers::pi;
            sum += solid(tets, t) * angle * angle, total += solid(tets, t);
        }
        CAPTURE(height, size, std::sqrt(sum / total));
        CHECK(std::sqrt(sum / total) < most);
    }
}

TEST_CASE("fibres do not hang on where a muscle lies", "[mesh][finer]") {
    const Muscle strip = side_strip();
    const TetMesh tets = lattice_of(strip.skin, 0.3);
    Points first;
    for (const Vec3& by : {Vec3(0, 0, 0), Vec3(1.1, 2.3, -3.7), Vec3(-170.3, 90.1, 12.7)}) {
        Muscle there = strip;
        TetMesh moved = tets;
        for (Vec3& p : there.skin.points) p += by;
        for (Vec3& p : moved.vertices) p += by;
        const Points fibres = there.fibres(moved);
        if (first.empty()) first = fibres;
        double farthest = 0;
        for (std::size_t t = 0; t < fibres.size(); ++t) farthest = std::max(farthest, (fibres[t] - first[t]).norm());
        CAPTURE(by.x(), farthest);
        CHECK(farthest < 1e-6);
    }
}

TEST_CASE("means over parts go by what is solid, and threads change nothing", "[mesh][finer]") {
    const SurfaceMesh ball = make_sphere(1, 20, 20);
    const TetMesh tets = lattice_of(ball, 0.5);
    const FinerTets finer = finer_tets(tets, ball.points, ball.triangles);
    // The mean place of what is inside of the ball is its centre.
    Points places;
    for (std::size_t k = 0; k < finer.parent.size(); ++k) {
        Vec3 sum(0, 0, 2); // and any constant comes out
        for (const Vec3& c : lattice_checks::corners_of(finer.mesh, k)) sum += c / 4;
        places.push_back(sum);
    }
    const Points means = means_over_parts(finer, places, tets.tets.size());
    Vec3 centre = Vec3::Zero();
    double volume = 0;
    for (std::size_t t = 0; t < means.size(); ++t) centre += solid(tets, t) * means[t], volume += solid(tets, t);
    CHECK((centre / volume - Vec3(0, 0, 2)).norm() < 1e-3);
    double farthest = 0; // of a tet all but outside, by the tet's own middle it would be 1.1 and more
    for (std::size_t t = 0; t < means.size(); ++t) farthest = std::max(farthest, (means[t] - Vec3(0, 0, 2)).norm());
    CHECK(farthest < 1.03);
    for (const int threads : {1, 2}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        const FinerTets again = finer_tets(tets, ball.points, ball.triangles);
        CHECK(again.parent == finer.parent);
        CHECK(again.mesh.coverage == finer.mesh.coverage);
        CHECK(again.mesh.vertices == finer.mesh.vertices);
    }
}
