// Harmonic extension: exact for linear data, bounded, least squares where over-determined.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/harmonic.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace sinew::solver;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// A surface in its lattice, ready to paint.
struct Painted {
    SurfaceMesh surface;
    TetMesh tets;
    Embedding embedding;
    std::vector<double> areas, values;
    std::vector<char> painted;

    Painted(SurfaceMesh mesh, double tet_size)
        : surface(std::move(mesh)) {
        LatticeOptions options;
        options.tet_size = tet_size;
        options.least_coverage = 0;
        init(make_lattice(surface.points, surface.triangles, options));
    }
    Painted(SurfaceMesh mesh, TetMesh volume)
        : surface(std::move(mesh)) {
        init(std::move(volume));
    }
    void init(TetMesh volume) {
        tets = std::move(volume);
        embedding = embed(tets, surface.points);
        areas = vertex_areas(surface.points, surface.triangles);
        values.assign(surface.points.size(), 0);
        painted.assign(surface.points.size(), 0);
    }
    /// 0 where x is lowest, 1 where it is highest.
    void paint_ends(double width) {
        const Box box = bounding_box(surface.points);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double x = (surface.points[i].x() - box.min.x()) / box.size().x();
            painted[i] = x <= width || x >= 1 - width;
            values[i] = x > 0.5 ? 1 : 0;
        }
    }
    std::vector<double> extend(HarmonicRange range = HarmonicRange::painted) const {
        return harmonic_extension(tets, embedding, areas, values, painted, range);
    }
    double value_at(std::size_t point, const std::vector<double>& field) const {
        const Tet& t = tets.tets[at(embedding.tet[point])];
        double sum = 0;
        for (std::size_t k = 0; k < 4; ++k) sum += embedding.barycentric[point][k] * field[at(t[k])];
        return sum;
    }
};

/// n x m x m cubes of five or six tets each: a mesh whose border is the box.
TetMesh box_mesh(int n, int m) {
    TetMesh mesh;
    const auto vertex = [&](int i, int j, int k) { return (k * (m + 1) + j) * (n + 1) + i; };
    for (int k = 0; k <= m; ++k)
        for (int j = 0; j <= m; ++j)
            for (int i = 0; i <= n; ++i)
                mesh.vertices.emplace_back(i + 0.2 * ((i % n) && (j % m)) * ((k + j) % 2), j, k);
    constexpr int walks[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int k = 0; k < m; ++k)
        for (int j = 0; j < m; ++j)
            for (int i = 0; i < n; ++i)
                for (const auto& walk : walks) {
                    int p[3] = {i, j, k};
                    Tet t;
                    t[0] = vertex(p[0], p[1], p[2]);
                    for (std::size_t s = 0; s < 3; ++s) ++p[walk[s]], t[s + 1] = vertex(p[0], p[1], p[2]);
                    mesh.tets.push_back(t);
                }
    check_and_orient(mesh);
    return mesh;
}

} // namespace

TEST_CASE("a conforming box painted at its ends gets the linear function", "[mesh][harmonic]") {
    TetMesh mesh = box_mesh(8, 3);
    SurfaceMesh surface = SurfaceMesh::from_triangles(mesh.vertices, boundary_triangles(mesh.tets));
    Painted box(std::move(surface), std::move(mesh));
    box.paint_ends(1e-9);
    const std::vector<double> field = box.extend();
    double worst = 0;
    for (std::size_t v = 0; v < field.size(); ++v)
        worst = std::max(worst, std::abs(field[v] - box.tets.vertices[v].x() / 8));
    CAPTURE(worst);
    REQUIRE(worst < 1e-10);
    for (const Vec3& d : unit_gradients(box.tets, field)) REQUIRE((d - Vec3(1, 0, 0)).norm() < 1e-9);
}

TEST_CASE("fibres of a box in a lattice run straight", "[mesh][harmonic]") {
    // The ends of the box lie inside tets, whose far corners reach beyond 0 and 1. Each cut through such a
    // tet must hold painted points enough to tell the slope.
    const std::pair<double, int> cases[] = {{0, 12}, {0.5, 12}, {0.2, 12}, {0.37, 40}};
    for (const auto& [size, points] : cases) {
        Painted box(make_cube(3, 1, 1.2, 8, points, points), size);
        box.paint_ends(1e-9);
        double worst = 0;
        for (const Vec3& d : fibre_directions(box.tets, box.embedding, box.areas, box.values, box.painted))
            worst = std::max(worst, (d - Vec3(1, 0, 0)).norm());
        CAPTURE(size, worst);
        REQUIRE(worst < 1e-10);
    }
}

TEST_CASE("painted values are met exactly where the mesh allows", "[mesh][harmonic]") {
    // One painted point in a tet of its own, here and there.
    Painted sphere(make_sphere(1, 20, 20), 0.3);
    std::vector<int> taken(sphere.tets.vertices.size(), 0);
    double sign = 0;
    for (std::size_t p = 0; p < sphere.values.size(); ++p) {
        const Tet& t = sphere.tets.tets[at(sphere.embedding.tet[p])];
        if (std::any_of(t.begin(), t.end(), [&](int v) { return taken[at(v)] != 0; })) continue;
        for (int v : t) taken[at(v)] = 1;
        sphere.painted[p] = 1;
        sphere.values[p] = 0.3 + 0.2 * std::sin(sign += 1);
    }
    REQUIRE(std::count(sphere.painted.begin(), sphere.painted.end(), 1) > 10);
    const std::vector<double> field = sphere.extend(HarmonicRange::free);
    for (std::size_t p = 0; p < sphere.values.size(); ++p)
        if (sphere.painted[p]) REQUIRE(sphere.value_at(p, field) == Approx(sphere.values[p]).margin(1e-9));
}

TEST_CASE("an extension stays within the painted values", "[mesh][harmonic]") {
    Painted biceps(read_surface(SINEW_SOURCE_DIR "/graphs/scenes/arm_ziva/muscles/biceps.obj"), 3);
    std::fill(biceps.painted.begin(), biceps.painted.end(), 1);
    const Box box = bounding_box(biceps.surface.points);
    for (std::size_t p = 0; p < biceps.values.size(); ++p) // a sharp stripe from 0.25 to 1
        biceps.values[p] = std::abs(biceps.surface.points[p].x() - box.centre().x()) < 4 ? 1 : 0.25;
    const std::vector<double> field = biceps.extend();
    REQUIRE(*std::min_element(field.begin(), field.end()) >= 0.25);
    REQUIRE(*std::max_element(field.begin(), field.end()) <= 1);
    const std::vector<double> free = biceps.extend(HarmonicRange::free);
    REQUIRE(*std::max_element(free.begin(), free.end()) > 1.001); // the bounds were needed
    // The bounded field still follows the paint.
    double sum = 0, area = 0;
    for (std::size_t p = 0; p < biceps.values.size(); ++p) {
        const double error = biceps.value_at(p, field) - biceps.values[p];
        sum += biceps.areas[p] * error * error, area += biceps.areas[p];
    }
    CAPTURE(std::sqrt(sum / area));
    REQUIRE(std::sqrt(sum / area) < 0.15);
    // Least squares within the bounds is no worse than cutting off the free solution.
    double cut = 0;
    std::vector<double> clamped = free;
    for (double& f : clamped) f = std::clamp(f, 0.25, 1.0);
    for (std::size_t p = 0; p < biceps.values.size(); ++p)
        cut += biceps.areas[p] * std::pow(biceps.value_at(p, clamped) - biceps.values[p], 2);
    REQUIRE(sum <= cut * (1 + 1e-6));
}

TEST_CASE("points that contradict each other in one tet meet in their weighted mean", "[mesh][harmonic]") {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tets = {{0, 1, 2, 3}};
    mesh.coverage = {1};
    const Embedding e = embed(mesh, {{0.25, 0.25, 0.25}, {0.25, 0.25, 0.25}});
    const std::vector<double> field = harmonic_extension(mesh, e, {3, 1}, {1, 2}, {1, 1});
    for (double f : field) REQUIRE(f == Approx(1.25).epsilon(1e-9));
}

TEST_CASE("one painted point or one value makes a constant, exactly", "[mesh][harmonic]") {
    Painted sphere(make_sphere(1, 12, 12), 0.5);
    sphere.painted[7] = 1;
    sphere.values[7] = 0.6;
    for (double f : sphere.extend()) REQUIRE(f == 0.6);
    sphere.painted.assign(sphere.painted.size(), 1);
    sphere.values.assign(sphere.values.size(), 1.0 / 3);
    for (double f : sphere.extend()) REQUIRE(f == 1.0 / 3);
}

TEST_CASE("a part without paint takes the nearest painted value", "[mesh][harmonic]") {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {3, 0, 0},
                     {4, 0, 0}, {3, 1, 0}, {3, 0, 1}, {9, 9, 9}};
    mesh.tets = {{0, 1, 2, 3}, {4, 5, 6, 7}};
    mesh.coverage = {1, 1};
    const Embedding e = embed(mesh, {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}});
    const std::vector<double> field = harmonic_extension(mesh, e, {1, 1, 1}, {0.2, 0.9, 7}, {1, 1, 0});
    for (std::size_t v = 4; v < 9; ++v) REQUIRE(field[v] == 0.9);
    REQUIRE(field[0] == Approx(0.2));
}

TEST_CASE("several maps together equal each alone, to the last bit", "[mesh][harmonic]") {
    Painted sphere(make_sphere(1, 12, 12), 0.4);
    sphere.paint_ends(0.2);
    std::vector<double> other(sphere.values.size());
    for (std::size_t i = 0; i < other.size(); ++i) other[i] = sphere.surface.points[i].y();
    const auto both = harmonic_extensions(sphere.tets, sphere.embedding, sphere.areas, {sphere.values, other},
                                          sphere.painted);
    REQUIRE(both[0] == sphere.extend());
    REQUIRE(both[1] ==
            harmonic_extension(sphere.tets, sphere.embedding, sphere.areas, other, sphere.painted));
}

TEST_CASE("tets whose points are all painted alike take their neighbours' fibre direction",
          "[mesh][harmonic]") {
    Painted box(make_cube(4, 1, 1, 24, 6, 6), 0.4);
    box.paint_ends(0.3); // whole blocks at both ends are constant
    const std::vector<double> field = box.extend(HarmonicRange::free);
    const Points gradients = unit_gradients(box.tets, field);
    REQUIRE(std::any_of(gradients.begin(), gradients.end(), [](const Vec3& g) { return g.isZero(); }));
    for (const Vec3& d : fibre_directions(box.tets, box.embedding, box.areas, box.values, box.painted)) {
        REQUIRE(d.norm() == Approx(1));
        REQUIRE(d.x() > 0.2);
    }
}

TEST_CASE("means and gradients of tets are those of the linear function", "[mesh][harmonic]") {
    const TetMesh beam = read_tets(SINEW_SOURCE_DIR "/tests/solver/mesh/data/square_beam.mesh");
    const Vec3 slope(1, -2, 0.5);
    std::vector<double> field;
    for (const Vec3& p : beam.vertices) field.push_back(slope.dot(p) + 3);
    const std::vector<double> means = tet_means(beam, field);
    const Points gradients = unit_gradients(beam, field);
    for (std::size_t t = 0; t < beam.tets.size(); ++t) {
        Vec3 centre = Vec3::Zero();
        for (int v : beam.tets[t]) centre += 0.25 * beam.vertices[at(v)];
        REQUIRE(means[t] == Approx(slope.dot(centre) + 3));
        REQUIRE((gradients[t] - slope.normalized()).norm() < 1e-12);
    }
    for (const Vec3& g : unit_gradients(beam, std::vector<double>(beam.vertices.size(), 0.1)))
        REQUIRE(g == Vec3(0, 0, 0));
}

TEST_CASE("harmonic extension refuses what it cannot use", "[mesh][harmonic]") {
    Painted sphere(make_sphere(1, 8, 8), 1);
    const auto code = [&](const Painted& p) {
        try {
            p.extend();
        } catch (const Error& e) {
            return e.code;
        }
        return std::string("none");
    };
    REQUIRE(code(sphere) == "FE205");
    Painted wrong = sphere;
    wrong.painted[0] = 1;
    REQUIRE(code(wrong) == "none");
    wrong.values[0] = std::nan("");
    REQUIRE(code(wrong) == "FE202");
    wrong = sphere;
    wrong.values.pop_back();
    REQUIRE(code(wrong) == "FE203");
    wrong = sphere;
    wrong.areas.pop_back();
    REQUIRE(code(wrong) == "FE203");
    // Values of points that are not painted do not matter.
    wrong = sphere;
    wrong.painted[0] = 1;
    wrong.values[1] = std::nan("");
    REQUIRE(code(wrong) == "none");
    REQUIRE_THROWS_AS(tet_means(sphere.tets, {1, 2}), Error);
}
