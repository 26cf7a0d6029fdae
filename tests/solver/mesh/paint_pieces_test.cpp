// Painted triangles cut by tets: areas, and integrals that are known.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/paint_pieces.h"
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/lattice.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace sinew::solver;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct InTets {
    SurfaceMesh surface;
    TetMesh tets;
    Embedding embedding;
    InTets(SurfaceMesh mesh, double size)
        : surface(std::move(mesh)) {
        LatticeOptions options;
        options.tet_size = size;
        tets = make_lattice(surface.points, surface.triangles, options);
        embedding = embed(tets, surface.points);
    }
    PaintedSurface view() const { return {surface.points, surface.triangles, embedding}; }
    PaintPieces cut(const std::vector<double>& values, const std::vector<char>& painted) const {
        return cut_paint(tets, view(), values, painted);
    }
    Vec3 place(const PaintPieces& pieces, std::size_t i) const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t k = 0; k < 4; ++k)
            sum += pieces.embedding.barycentric[i][k] * tets.vertices[at(tets.tets[at(pieces.embedding.tet[i])][k])];
        return sum;
    }
    double area() const {
        double sum = 0;
        for (const double a : vertex_areas(surface.points, surface.triangles)) sum += a;
        return sum;
    }
};

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

} // namespace

TEST_CASE("pieces of a surface have its area, and their centroids its first moments", "[mesh][pieces]") {
    // 0.5 divides the cube: its sides lie in sides of tets, and each piece counts once.
    for (const double size : {0.5, 0.37, 1.3})
        for (const SurfaceMesh& mesh : {make_cube(2, 2, 2, 1, 1, 1), make_sphere(1, 16, 12)}) {
            const InTets in(mesh, size);
            const std::size_t n = in.surface.points.size();
            const PaintPieces pieces = in.cut(std::vector<double>(n, 1.0), std::vector<char>(n, 1));
            CAPTURE(size, n, pieces.size());
            CHECK(sum_of(pieces.areas) == Approx(in.area()).epsilon(1e-10));
            Vec3 moment = Vec3::Zero(), exact = Vec3::Zero();
            for (std::size_t i = 0; i < pieces.size(); ++i) {
                const Vec3 p = in.place(pieces, i);
                moment += pieces.areas[i] * p.cwiseProduct(Vec3(1, 2, 3)) + pieces.areas[i] * Vec3(4, 5, 6);
                for (const double b : pieces.embedding.barycentric[i]) CHECK(b > -1e-12);
            }
            for (const Triangle& t : in.surface.triangles) {
                const Vec3 &a = in.surface.points[at(t[0])], &b = in.surface.points[at(t[1])],
                           &c = in.surface.points[at(t[2])];
                const double area = 0.5 * (b - a).cross(c - a).norm();
                exact += area * Vec3((a + b + c) / 3).cwiseProduct(Vec3(1, 2, 3)) + area * Vec3(4, 5, 6);
            }
            CHECK((moment - exact).norm() < 1e-9 * exact.norm());
        }
}

TEST_CASE("pieces are cut, not sampled", "[mesh][pieces]") {
    // Of y^2 over the cube's sides centroids see all but what is within a piece, corners more than there is.
    const InTets in(make_cube(2, 2, 2, 1, 1, 1), 0.37);
    const PaintPieces pieces = in.cut(std::vector<double>(8, 1.0), std::vector<char>(8, 1));
    double sum = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        sum += pieces.areas[i] * in.place(pieces, i).y() * in.place(pieces, i).y();
    const double exact = 8 + 16.0 / 3;
    CHECK(sum < exact);
    CHECK(sum > exact - 24 * 0.37 * 0.37 / 12); // a piece is smaller than a cube's side
}

TEST_CASE("a triangle in the side between two tets counts once", "[mesh][pieces]") {
    TetMesh tets;
    tets.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
    tets.tets = {{0, 1, 2, 3}, {0, 2, 1, 4}};
    check_and_orient(tets);
    const Points points{{0.1, 0.1, 0}, {0.6, 0.1, 0}, {0.1, 0.6, 0}};
    const std::vector<Triangle> triangles{{0, 1, 2}};
    const Embedding embedding = embed(tets, points);
    const PaintPieces pieces =
        cut_paint(tets, {points, triangles, embedding}, std::vector<double>(3, 1.0), std::vector<char>(3, 1));
    REQUIRE(pieces.size() == 1);
    CHECK(pieces.areas[0] == Approx(0.125));
}

TEST_CASE("what is painted alike is cut, what lies between is not, and a vertex alone is kept", "[mesh][pieces]") {
    const InTets in(make_cube(2, 2, 2, 4, 4, 4), 0.6);
    std::vector<double> values;
    std::vector<char> painted;
    int alone = -1;
    for (const Vec3& p : in.surface.points) {
        const bool below = p.y() < -1 + 1e-9, right = !below && p.x() > 1 - 1e-9;
        const bool single = (p - Vec3(-1, 0.5, 0.5)).norm() < 1e-9;
        if (single) alone = static_cast<int>(painted.size());
        painted.push_back(below || right || single);
        values.push_back(below ? 3 : right ? 5 : single ? 7 : -1e300);
    }
    REQUIRE(alone >= 0);
    const PaintPieces pieces = in.cut(values, painted);
    double of[8] = {};
    for (std::size_t i = 0; i < pieces.size(); ++i) of[std::lround(pieces.values[i])] += pieces.areas[i];
    CHECK(of[3] == Approx(4));    // the whole of the lower side
    CHECK(of[5] == Approx(3));    // of the right one all but the lowest row, which touches both
    CHECK(of[7] == Approx(0.25)); // what the vertex stands for
    const auto last = pieces.size() - 1;
    CHECK(pieces.values[last] == 7);
    CHECK(pieces.embedding.tet[last] == in.embedding.tet[at(alone)]);
}

TEST_CASE("paint that leaves the tets is taken at samples, and nothing else is", "[mesh][pieces]") {
    // Tets of a cube within a larger one.
    const InTets inner(make_cube(2, 2, 2, 1, 1, 1), 0.5);
    const SurfaceMesh large = make_cube(2.4, 2, 2, 6, 6, 6);
    const Embedding embedding = embed(inner.tets, large.points);
    const std::size_t n = large.points.size();
    const PaintPieces pieces = cut_paint(inner.tets, {large.points, large.triangles, embedding},
                                         std::vector<double>(n, 1.0), std::vector<char>(n, 1));
    CHECK(sum_of(pieces.areas) == Approx(2 * 4 + 4 * 2.4 * 2).epsilon(1e-9));
    CHECK_THROWS_AS(cut_paint(inner.tets, {large.points, large.triangles, embedding}, std::vector<double>(n - 1, 1.0),
                              std::vector<char>(n, 1)),
                    Error);
    CHECK_THROWS_AS(cut_paint(inner.tets, {large.points, large.triangles, embedding}, std::vector<double>(n, 1.0),
                              std::vector<char>(n - 1, 1)),
                    Error);
}
