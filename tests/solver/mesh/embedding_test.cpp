// Points that ride on tets: exactness, hosts, ties, extrapolation.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/embedding.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <random>

using namespace sinew::solver;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::vector<double> flat(const Points& points) {
    std::vector<double> x;
    for (const Vec3& p : points) x.insert(x.end(), p.data(), p.data() + 3);
    return x;
}

double smallest(const std::array<double, 4>& b) { return *std::min_element(b.begin(), b.end()); }

} // namespace

TEST_CASE("a surface inside its lattice is embedded in tets that hold it", "[mesh][embedding]") {
    const SurfaceMesh biceps = read_surface(SINEW_SOURCE_DIR "/graphs/scenes/arm_ziva/muscles/biceps.obj");
    const TetMesh lattice = make_lattice(biceps.points, biceps.triangles, {});
    const Embedding e = embed(lattice, biceps.points);
    REQUIRE(e.size() == biceps.points.size());
    double least = 1;
    for (const auto& b : e.barycentric) {
        least = std::min(least, smallest(b));
        REQUIRE(b[0] + b[1] + b[2] + b[3] == Approx(1).epsilon(1e-14));
    }
    REQUIRE(least >= -1e-10);
    Points out;
    apply(e, lattice.tets, flat(lattice.vertices).data(), out);
    for (std::size_t i = 0; i < out.size(); ++i) REQUIRE((out[i] - biceps.points[i]).norm() < 1e-12 * 150);
}

TEST_CASE("embedded points follow an affine motion exactly, also outside the mesh", "[mesh][embedding]") {
    const TetMesh beam = read_tets(SINEW_SOURCE_DIR "/tests/solver/mesh/data/square_beam.mesh");
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-1, 1);
    Points points;
    for (int i = 0; i < 500; ++i) points.emplace_back(12 * u(random), 12 * u(random), 55 * u(random));
    const Embedding e = embed(beam, points);
    Mat3 F;
    F << 1.2, 0.3, -0.1, -0.4, 0.9, 0.2, 0.1, 0.05, 0.7;
    const Vec3 shift(3, -2, 1);
    Points moved = beam.vertices;
    for (Vec3& p : moved) p = F * p + shift;
    Points out;
    apply(e, beam.tets, flat(moved).data(), out);
    for (std::size_t i = 0; i < out.size(); ++i) REQUIRE((out[i] - (F * points[i] + shift)).norm() < 1e-11);
}

TEST_CASE("a point on a vertex gets exactly that vertex", "[mesh][embedding]") {
    const TetMesh beam = read_tets(SINEW_SOURCE_DIR "/tests/solver/mesh/data/square_beam.mesh");
    const Embedding e = embed(beam, beam.vertices);
    Points out;
    apply(e, beam.tets, flat(beam.vertices).data(), out);
    for (std::size_t i = 0; i < out.size(); ++i) {
        auto sorted = e.barycentric[i];
        std::sort(sorted.begin(), sorted.end());
        REQUIRE(sorted == std::array<double, 4>{0, 0, 0, 1});
        REQUIRE(out[i] == beam.vertices[i]);
        // and the lowest of the tets around it
        const auto around = std::find_if(beam.tets.begin(), beam.tets.end(), [&](const Tet& t) {
            return std::find(t.begin(), t.end(), static_cast<int>(i)) != t.end();
        });
        REQUIRE(e.tet[i] == static_cast<int>(around - beam.tets.begin()));
    }
}

TEST_CASE("points on shared faces and edges go to the lowest tet", "[mesh][embedding]") {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    const TetMesh lattice = make_lattice(sphere.points, sphere.triangles, {});
    Points points;
    std::vector<int> expected;
    for (const Tet& t : lattice.tets)
        for (int k = 0; k < 4; ++k) {
            // Middle of the face opposite corner k.
            Vec3 middle = Vec3::Zero();
            for (int j = 0; j < 4; ++j)
                if (j != k) middle += lattice.vertices[at(t[at(j)])] / 3;
            points.push_back(middle);
            int lowest = -1;
            for (int other = 0; other < static_cast<int>(lattice.tets.size()) && lowest < 0; ++other) {
                int shared = 0;
                for (int j = 0; j < 4; ++j)
                    if (j != k)
                        shared +=
                            std::count(lattice.tets[at(other)].begin(), lattice.tets[at(other)].end(), t[at(j)]) > 0;
                if (shared == 3) lowest = other;
            }
            expected.push_back(lowest);
        }
    REQUIRE(embed(lattice, points).tet == expected);
}

TEST_CASE("a point outside goes to the nearest tet and keeps its place", "[mesh][embedding]") {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}};
    mesh.tets = {{0, 1, 2, 3}, {4, 5, 6, 7}};
    const Embedding e = embed(mesh, {{2, 0.1, 0.1}, {4, 0.1, 0.1}, {-1, -1, -1}, {3.0, 0, 0}});
    REQUIRE(e.tet[0] == 0);
    REQUIRE(e.tet[1] == 1);
    REQUIRE(e.tet[2] == 0);
    REQUIRE(e.tet[3] == 0); // as far from both: the lowest
    REQUIRE(e.barycentric[0][1] == Approx(2));
    REQUIRE(smallest(e.barycentric[2]) == Approx(-1));
}

TEST_CASE("points outside know how many widths of their tet they are away", "[mesh][embedding]") {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
    mesh.tets = {{0, 1, 2, 3}};
    const double width = std::sqrt(8.0);
    const std::vector<double> widths =
        widths_outside(mesh, embed(mesh, {{0.5, 0.5, 0.5}, {0, 0, 0}, {0.5, 0.5, -3}, {-7, 0.1, 0.1}, {5, 5, 5}}));
    REQUIRE(widths[0] == 0);
    REQUIRE(widths[1] == 0);
    REQUIRE(widths[2] == Approx(3 / width));
    REQUIRE(widths[3] == Approx(7 / width));
    REQUIRE(widths[4] == Approx(13 / std::sqrt(3.0) / width)); // to the slanted face, x + y + z = 2
}

TEST_CASE("embedding refuses meshes without tets and points that are not finite", "[mesh][embedding]") {
    TetMesh mesh;
    REQUIRE(embed(mesh, {}).size() == 0);
    REQUIRE_THROWS_AS(embed(mesh, {{0, 0, 0}}), Error);
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tets = {{0, 1, 2, 3}};
    REQUIRE_THROWS_AS(embed(mesh, {{0, 0, std::numeric_limits<double>::infinity()}}), Error);
}

TEST_CASE("an embedding has the same bits on one thread and on many", "[mesh][embedding]") {
    const SurfaceMesh sphere = make_sphere(1, 100, 100);
    const TetMesh lattice = make_lattice(sphere.points, sphere.triangles, {});
    Embedding one, many;
    Points out_one, out_many;
    const std::vector<double> x = flat(lattice.vertices);
    {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
        one = embed(lattice, sphere.points);
        apply(one, lattice.tets, x.data(), out_one);
    }
    many = embed(lattice, sphere.points);
    apply(many, lattice.tets, x.data(), out_many);
    REQUIRE(one.tet == many.tet);
    REQUIRE(one.barycentric == many.barycentric);
    REQUIRE(out_one == out_many);
}
