// Sampled surfaces: cut to the size of their tets without cracks, integrated exactly, painted as documented.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"
#include "solver/surface/clipped_surface.h"
#include "solver/surface/quadrature.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double area_of(const Points& points, const std::vector<Triangle>& triangles) {
    double sum = 0;
    for (const Triangle& t : triangles)
        sum += 0.5 * (points[at(t[1])] - points[at(t[0])]).cross(points[at(t[2])] - points[at(t[0])]).norm();
    return sum;
}

/// A tissue of a surface in its own lattice.
TissueRest in_lattice(const SurfaceMesh& mesh, double tet_size, ElementKind kind) {
    TissueRest t;
    t.tets = make_lattice(mesh.points, mesh.triangles, {.tet_size = tet_size});
    t.triangles = mesh.triangles;
    t.surface = mesh.points;
    t.embedding = embed(t.tets, t.surface);
    t.element = kind;
    return t;
}

double longest_edge(const TetMesh& mesh, int tet) {
    double longest = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j)
            longest = std::max(
                longest, (mesh.vertices[at(mesh.tets[at(tet)][i])] - mesh.vertices[at(mesh.tets[at(tet)][j])]).norm());
    return longest;
}

/// Area x weight of a painted map on a surface without tets.
double painted_area(const Points& points, const std::vector<Triangle>& triangles, const std::vector<double>& map,
                    PaintedOn on) {
    std::vector<int> all(triangles.size());
    std::iota(all.begin(), all.end(), 0);
    double sum = 0;
    for (const SurfaceSample& s :
         quadrature_samples(cut_surface(points, triangles, all, {}), corner_weights(points, triangles, map, on), {}))
        sum += s.area * s.weight;
    return sum;
}

SampledSurface cut_whole(const TissueRest& t, const CarrierTets& tets) {
    std::vector<int> all(t.triangles.size());
    std::iota(all.begin(), all.end(), 0);
    return cut_surface(t.surface, t.triangles, all, {{{&tets, t.element}}});
}

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

} // namespace

TEST_CASE("a surface cut to the size of its tets has no cracks and keeps its shape") {
    const std::pair<SurfaceMesh, double> cases[] = {{make_cube(0.4, 0.1, 0.1, 1, 1, 1), 0.05},
                                                    {make_cube(0.4, 0.1, 0.1, 9, 2, 1), 0.03},
                                                    {make_sphere(0.1, 8, 6), 0.02},
                                                    {make_sphere(0.1, 40, 40), 0.05},
                                                    {make_cylinder(0.05, 0.5, 5, 1, 1), 0.04}};
    for (const auto& [mesh, tet_size] : cases) {
        const TissueRest t = in_lattice(mesh, tet_size, ElementKind::linear);
        const CarrierTets tets(t.tets);
        const SampledSurface s = cut_whole(t, tets);
        INFO(mesh.points.size() << " vertices become " << s.points.size());
        CHECK(is_closed(s.triangles));
        CHECK(area_of(s.points, s.triangles) == Approx(area_of(mesh.points, mesh.triangles)).epsilon(1e-12));
        CHECK(enclosed_volume(s.points, s.triangles) ==
              Approx(enclosed_volume(mesh.points, mesh.triangles)).epsilon(1e-12));
        const TetLocator locator(t.tets);
        double off = 0, longest = 0;
        for (std::size_t k = 0; k < s.triangles.size(); ++k)
            for (std::size_t i = 0; i < 3; ++i) {
                const Triangle& of = mesh.triangles[at(s.source[k])];
                const Vec3 &b = s.places[k][i], &p = s.points[at(s.triangles[k][i])];
                off = std::max(off, (b[0] * mesh.points[at(of[0])] + b[1] * mesh.points[at(of[1])] +
                                     b[2] * mesh.points[at(of[2])] - p)
                                        .norm());
                const Vec3& next = s.points[at(s.triangles[k][(i + 1) % 3])];
                std::array<double, 4> where;
                const int tet = locator.locate(0.5 * (p + next), where);
                longest = std::max(longest, (next - p).norm() / longest_edge(t.tets, tet));
            }
        CHECK(off < 1e-13);
        CHECK(longest <= 0.75);
    }
}

TEST_CASE("a surface is cut along its tets into pieces that fill it, each in one tet") {
    const TetMesh box = box_mesh({0.4, 0.1, 0.1}, 4, 1, 1);
    SurfaceMesh inner; // on faces between tets, and across them
    inner.points = {{0.1, 0, 0}, {0.1, 0.1, 0}, {0.1, 0, 0.1}, {0.3, 0.1, 0.1}};
    inner.triangles = {{0, 1, 2}, {2, 1, 3}, {0, 3, 1}, {0, 2, 3}};
    const auto own = [&] { // the border of the tets
        TissueRest t;
        t.tets = box, t.surface = box.vertices, t.triangles = boundary_triangles(box.tets);
        return t;
    }();
    TissueRest crossing = own;
    crossing.surface = inner.points, crossing.triangles = inner.triangles;
    TissueRest reaching = own; // out of the tets, by a tenth of the length
    for (Vec3& p : reaching.surface) p.x() *= 1.1;
    const TissueRest cases[] = {own,
                                crossing,
                                reaching,
                                in_lattice(make_cube(0.4, 0.1, 0.1, 1, 1, 1), 0.05, ElementKind::linear),
                                in_lattice(make_sphere(0.1, 8, 6), 0.02, ElementKind::linear),
                                in_lattice(make_sphere(0.1, 40, 40), 0.05, ElementKind::linear)};
    for (const TissueRest& t : cases) {
        INFO(&t - cases);
        const ClippedSurface clipped = clip_surface(t.surface, t.triangles, CarrierTets(t.tets));
        std::vector<double> filled(t.triangles.size(), 0.0);
        double off = 0, out = 0, moment = 0;
        for (const SurfacePiece& piece : clipped.pieces) {
            Points p(3, Vec3::Zero());
            for (std::size_t c = 0; c < 3; ++c) {
                Vec3 by_tet = Vec3::Zero();
                for (std::size_t k = 0; k < 4; ++k)
                    by_tet += piece.inside[c][k] * t.tets.vertices[at(t.tets.tets[at(piece.tet)][k])];
                for (int i = 0; i < 3; ++i)
                    p[c] += piece.place[c][i] * t.surface[at(t.triangles[at(piece.triangle)][at(i)])];
                off = std::max(off, (by_tet - p[c]).norm());
                out = std::max(out, -*std::min_element(piece.inside[c].begin(), piece.inside[c].end()));
            }
            const Vec3 across = (p[1] - p[0]).cross(p[2] - p[0]);
            filled[at(piece.triangle)] += 0.5 * across.norm();
            moment += p[0].dot(across) / 6;
        }
        for (std::size_t k = 0; k < filled.size(); ++k)
            CHECK(filled[k] == Approx(area_of(t.surface, {t.triangles[k]})).epsilon(1e-11));
        CHECK(moment == Approx(enclosed_volume(t.surface, t.triangles)).epsilon(1e-11));
        CHECK(off < 1e-13);
        const auto outside = std::count(clipped.is_outside.begin(), clipped.is_outside.end(), 1);
        if (&t == &cases[2]) {
            CHECK(outside > 0);
            CHECK(outside < std::ssize(clipped.is_outside)); // what does not reach out is left alone
        } else {
            CHECK(outside == 0);
            CHECK(out < 1e-10);
        }
        if (&t == &cases[0]) CHECK(clipped.pieces.size() == t.triangles.size());
    }
}

TEST_CASE("a surface much finer than its tets is left as it is, and one point stands for each triangle") {
    const SurfaceMesh mesh = make_sphere(0.1, 160, 160);
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        const TissueRest t = in_lattice(mesh, 0.1, kind);
        const CarrierTets tets(t.tets);
        const SampledSurface s = cut_whole(t, tets);
        CHECK(s.triangles == mesh.triangles);
        const CornerWeights paint = corner_weights(t.surface, t.triangles, {}, PaintedOn::vertices);
        CHECK(quadrature_samples(s, paint, {{{&tets, kind}}}).size() == mesh.triangles.size());
    }
}

TEST_CASE("samples integrate the square of what tets carry exactly, and painted weights that are linear") {
    const TetMesh box = box_mesh({1, 1, 1}, 1, 1, 1);
    const CarrierTets tets(box);
    // Smaller than the tets, larger than a third of them.
    const Points points = {{0.1, 0.2, 0.3}, {0.5, 0.25, 0.3}, {0.2, 0.6, 0.4}};
    const double area = area_of(points, {{0, 1, 2}});
    for (const auto& [kind, degree] : {std::pair{ElementKind::linear, 2}, {ElementKind::quadratic, 4}}) {
        const SurfaceDensity density{{{&tets, kind}}};
        const SampledSurface s = cut_surface(points, {{0, 1, 2}}, {0}, density);
        for (int i = 0; i <= degree; ++i)
            for (int j = 0; i + j <= degree; ++j)
                for (int k = 0; i + j + k <= degree; ++k) {
                    double sum = 0;
                    for (const SurfaceSample& q : quadrature_samples(s, {{1, 1, 1}}, density))
                        sum += q.area * std::pow(q.place[0], i) * std::pow(q.place[1], j) * std::pow(q.place[2], k);
                    INFO(i << " " << j << " " << k);
                    CHECK(sum ==
                          Approx(2 * area * factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 2))
                              .epsilon(1e-13));
                }
        double weight = 0;
        for (const SurfaceSample& q : quadrature_samples(s, {{0.1, 0.4, 1}}, density)) weight += q.area * q.weight;
        CHECK(weight == Approx(0.5 * area));
    }
}

TEST_CASE("painted faces are sharp and painted vertices fade over their triangles but not around a box's edge") {
    const SurfaceMesh box = make_cube(2, 1, 3, 2, 3, 4);
    std::vector<double> top(box.points.size(), 0.0);
    for (const int v : vertices_where(box.points, [](const Vec3& p) { return p.y() > 0.5 - 1e-9; })) top[at(v)] = 1;
    CHECK(painted_area(box.points, box.triangles, top, PaintedOn::vertices) == Approx(6));
    std::vector<double> faces(box.triangles.size(), 0.0);
    faces[5] = 0.25;
    CHECK(painted_area(box.points, box.triangles, faces, PaintedOn::faces) ==
          Approx(0.25 * area_of(box.points, {box.triangles[5]})));
    CHECK(painted_area(box.points, box.triangles, {0.5}, PaintedOn::faces) == Approx(0.5 * 22));

    // One vertex alone: a third of each triangle at it, also at a corner.
    for (const int vertex : {0, 7}) {
        std::vector<double> one(box.points.size(), 0.0);
        one[at(vertex)] = 1;
        CHECK(painted_area(box.points, box.triangles, one, PaintedOn::vertices) ==
              Approx(vertex_areas(box.points, box.triangles)[at(vertex)]));
    }
    // On what is smooth: a third of every triangle to each of its painted corners.
    const SurfaceMesh ball = make_sphere(1, 30, 20);
    std::vector<double> cap(ball.points.size(), 0.0);
    double expected = 0;
    for (const int v : vertices_where(ball.points, [](const Vec3& p) { return p.y() > 0.3; })) {
        cap[at(v)] = 1;
        expected += vertex_areas(ball.points, ball.triangles)[at(v)];
    }
    CHECK(painted_area(ball.points, ball.triangles, cap, PaintedOn::vertices) == Approx(expected));
    CHECK_THROWS(corner_weights(ball.points, ball.triangles, {1, 1}, PaintedOn::faces));
}
