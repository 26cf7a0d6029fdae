// Harmonic extension: exact for linear data, bounded, least squares where over-determined.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/fibre_field.h"
#include "solver/mesh/harmonic.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

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
    PaintedSurface on_surface() const { return {surface.points, surface.triangles, embedding}; }
    double value_at(std::size_t point, const std::vector<double>& field) const {
        const Tet& t = tets.tets[at(embedding.tet[point])];
        double sum = 0;
        for (std::size_t k = 0; k < 4; ++k) sum += embedding.barycentric[point][k] * field[at(t[k])];
        return sum;
    }
};

/// Of the simulation's own tets.
Points directions(const TetMesh& tets, const PaintedSurface& surface, const std::vector<double>& ends,
                  const std::vector<char>& painted) {
    return fibre_directions(tets, fibre_gradients(tets, surface, ends, painted));
}

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
        for (const Vec3& d : directions(box.tets, box.on_surface(), box.values, box.painted))
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

TEST_CASE("vertices that only one point in a tet of no coverage holds leave the rest of the map as it is",
          "[mesh][harmonic]") {
    // Two tets that share an edge. The second has no stiffness, and one painted point cannot hold its two far vertices:
    // but for rounding their part of the matrix is singular.
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 1, -1}};
    mesh.tets = {{0, 1, 2, 3}, {1, 2, 4, 5}};
    mesh.coverage = {1, 0};
    for (int k = 1; k < 100; ++k) {
        const double a = 0.001 * k, b = 0.37 - 0.002 * k;
        const Embedding e{{0, 0, 0, 1}, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0.2, a, b, 0.8 - a - b}}};
        const std::vector<double> field = harmonic_extension(mesh, e, {1, 1, 1, 1}, {0, 1, 1, 0.5}, {1, 1, 1, 1});
        CAPTURE(k);
        REQUIRE(field[0] == Approx(0).margin(1e-6));
        REQUIRE(field[1] == Approx(1).margin(1e-6));
        for (const double f : field) REQUIRE((f >= 0 && f <= 1));
    }
}

TEST_CASE("a part without paint takes the nearest painted value", "[mesh][harmonic]") {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {3, 0, 0}, {4, 0, 0}, {3, 1, 0}, {3, 0, 1}, {9, 9, 9}};
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
    const auto both =
        harmonic_extensions(sphere.tets, sphere.embedding, sphere.areas, {sphere.values, other}, sphere.painted);
    REQUIRE(both[0] == sphere.extend());
    REQUIRE(both[1] == harmonic_extension(sphere.tets, sphere.embedding, sphere.areas, other, sphere.painted));
}

TEST_CASE("tets without a gradient take their neighbours' fibre direction", "[mesh][harmonic]") {
    const Painted box(make_cube(4, 1, 1, 24, 6, 6), 0.4);
    const auto middle = [&](std::size_t t) {
        Vec3 sum = Vec3::Zero();
        for (const int v : box.tets.tets[t]) sum += box.tets.vertices[at(v)] / 4;
        return sum;
    };
    Points gradients(box.tets.tets.size(), Vec3::Zero());
    for (std::size_t t = 0; t < gradients.size(); ++t)
        if (middle(t).x() > 1.2) gradients[t] = middle(t).y() > 0 ? Vec3(3, 3, 0) : Vec3(0.5, -0.5, 0);
    // Of 5,000 times less than fibres meet in the mean, which half of them do at 3 sqrt(2), hardly one is there.
    gradients[0] = Vec3(0, 0, 8e-4);
    const Points directions = fibre_directions(box.tets, gradients);
    Vec3 sum = Vec3::Zero();
    for (std::size_t t = 0; t < gradients.size(); ++t) {
        REQUIRE(directions[t].norm() == Approx(1));
        if (middle(t).x() > 1.2) REQUIRE(directions[t].dot(gradients[t].normalized()) == Approx(1));
        REQUIRE(directions[t].x() > 0.7);
        if (middle(t).x() < -1) sum += directions[t];
    }
    REQUIRE(sum.normalized().x() == Approx(1).epsilon(1e-3)); // both sides count alike
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

TEST_CASE("means over cut tets are those of their solid parts", "[mesh][harmonic]") {
    // Of volume 1, and wider towards +z: where both ends are alike, errors of tets are, too, and cancel.
    SurfaceMesh wedge = make_cube(1, 1, 1, 1, 1, 1);
    for (Vec3& p : wedge.points) p.x() *= 1 + 0.5 * p.z();
    const Vec3 middle(0, 0, 1.0 / 24), slope(1, -2, 0.5);
    for (const int moments : {1, 4}) {
        LatticeOptions options;
        options.tet_size = 0.43;
        options.moments = moments;
        options.least_coverage = 1e-12; // what tets are given beyond their share is no part of the volume
        const TetMesh lattice = make_lattice(wedge.points, wedge.triangles, options);
        REQUIRE(lattice.cut.degree == moments);
        REQUIRE(lattice.cut.tets.size() > 20);
        std::vector<double> field;
        for (const Vec3& p : lattice.vertices) field.push_back(slope.dot(p) + 3);
        const std::vector<double> means = tet_means(lattice, field);
        double sum = 0;
        for (std::size_t t = 0; t < lattice.tets.size(); ++t) {
            const Tet& v = lattice.tets[t];
            sum += means[t] * lattice.coverage[t] *
                   tet_volume(lattice.vertices[at(v[0])], lattice.vertices[at(v[1])], lattice.vertices[at(v[2])],
                              lattice.vertices[at(v[3])]);
        }
        CHECK(sum == Approx(slope.dot(middle) + 3).epsilon(1e-9)); // the integral is the value in the middle
    }
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
    REQUIRE(code(sphere) == "FE212");
    Painted wrong = sphere;
    wrong.painted[0] = 1;
    REQUIRE(code(wrong) == "none");
    wrong.values[0] = std::nan("");
    REQUIRE(code(wrong) == "FE202");
    wrong = sphere;
    wrong.values.pop_back();
    REQUIRE(code(wrong) == "FE204");
    wrong = sphere;
    wrong.areas.pop_back();
    REQUIRE(code(wrong) == "FE204");
    // Values of points that are not painted do not matter.
    wrong = sphere;
    wrong.painted[0] = 1;
    wrong.values[1] = std::nan("");
    REQUIRE(code(wrong) == "none");
    REQUIRE_THROWS_AS(tet_means(sphere.tets, {1, 2}), Error);
}

namespace {

double value_in(const TetMesh& mesh, const std::vector<double>& field, const Vec3& p) {
    const Embedding e = embed(mesh, {p});
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += e.barycentric[0][k] * field[at(mesh.tets[at(e.tet[0])][k])];
    return sum;
}

/// A unit cube of 8 corners and 12 triangles, in tets much smaller than they.
struct Cube {
    SurfaceMesh surface = make_cube(1, 1, 1, 1, 1, 1);
    TetMesh tets;
    Embedding embedding;
    explicit Cube(int parts) {
        const Vec3 low = bounding_box(surface.points).min;
        for (Vec3& p : surface.points) p -= low;
        LatticeOptions options;
        options.tet_size = 1.0 / parts;
        tets = make_lattice(surface.points, surface.triangles, options);
        embedding = embed(tets, surface.points);
    }
    PaintedSurface painted() const { return {surface.points, surface.triangles, embedding}; }
    template <class Map>
    std::vector<double> extend(const Map& map, HarmonicRange range = HarmonicRange::painted) const {
        std::vector<double> values;
        for (const Vec3& p : surface.points) values.push_back(map(p));
        return harmonic_extensions(tets, painted(), {values}, std::vector<char>(values.size(), 1), range)[0];
    }
};

} // namespace

TEST_CASE("paint on large triangles holds however small the tets are", "[mesh][harmonic]") {
    // A point alone loses its hold as tets shrink: with corners only, the value at the side sinks to one half.
    std::vector<double> errors;
    for (const int parts : {3, 5, 9}) { // odd: the sides of the cube pass through the middle of tets
        const Cube cube(parts);
        REQUIRE(cube.surface.points.size() == 8);
        const auto x = [](const Vec3& p) { return p.x(); };
        const std::vector<double> free = cube.extend(x, HarmonicRange::free), field = cube.extend(x);
        for (std::size_t v = 0; v < free.size(); ++v) {
            REQUIRE(free[v] == Approx(cube.tets.vertices[v].x()).margin(1e-4));
            REQUIRE(field[v] >= 0);
            REQUIRE(field[v] <= 1);
        }
        REQUIRE(value_in(cube.tets, free, {0.999, 0.5, 0.5}) == Approx(0.999).margin(1e-5));
        REQUIRE(value_in(cube.tets, field, {0.999, 0.5, 0.5}) == Approx(0.999).margin(1.1e-3));
        errors.push_back(value_in(cube.tets, field, {0.75, 0.5, 0.5}) - 0.75);
    }
    CAPTURE(errors[0], errors[1], errors[2]);
    REQUIRE(errors[0] < 0.15);
    // The bounds flatten the map by half a tet at the sides; that falls with the first power of the tet size.
    REQUIRE(std::log(errors[0] / errors[2]) / std::log(3.0) > 0.9);
}

TEST_CASE("a map that is not linear converges with the tets", "[mesh][harmonic]") {
    // Opposite corners at 1: saddles on the sides. No closed form; the differences between halvings tell.
    const auto map = [](const Vec3& p) { return (p.x() > 0.5) == (p.y() > 0.5) ? p.z() : 0.3; };
    const Points places{{0.3, 0.4, 0.6}, {0.9, 0.1, 0.5}, {0.5, 0.3, 0.8}, {0.15, 0.8, 0.2}};
    std::vector<std::vector<double>> values;
    for (const int parts : {4, 8, 16}) {
        const Cube cube(parts);
        const std::vector<double> field = cube.extend(map);
        values.emplace_back();
        for (const Vec3& p : places) values.back().push_back(value_in(cube.tets, field, p));
    }
    double coarse = 0, fine = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        coarse = std::max(coarse, std::abs(values[0][i] - values[1][i]));
        fine = std::max(fine, std::abs(values[1][i] - values[2][i]));
    }
    CAPTURE(coarse, fine);
    REQUIRE(coarse < 0.07);
    REQUIRE(fine < 0.5 * coarse);
}

TEST_CASE("fibres between two large painted sides run straight", "[mesh][harmonic]") {
    // The ends are two triangles each. Held at their corners alone, fibres lean by 29 degrees on average.
    const Cube cube(9);
    std::vector<double> ends;
    for (const Vec3& p : cube.surface.points) ends.push_back(p.x() > 0.5 ? 1 : 0);
    double worst = 0;
    for (const Vec3& d : directions(cube.tets, cube.painted(), ends, std::vector<char>(8, 1)))
        worst = std::max(worst, (d - Vec3(1, 0, 0)).norm());
    CAPTURE(worst);
    REQUIRE(worst < 1e-3);
}

TEST_CASE("fibres run in each connected part with both ends, and in no other", "[mesh][harmonic]") {
    // Three boxes, of 8, 8 and 1 times the section; the last has a source alone.
    SurfaceMesh all;
    const auto add = [&](double width, double y) {
        const int first = static_cast<int>(all.points.size());
        const SurfaceMesh box = make_cube(4, width, width, 8, 4, 4);
        for (const Vec3& p : box.points) all.points.push_back(p + Vec3(0, y, 0));
        for (const Triangle& t : box.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    };
    add(2.4, -6), add(0.85, 0), add(2.4, 6);
    Painted boxes(std::move(all), 0.5);
    boxes.paint_ends(1e-9);
    for (std::size_t i = 0; i < boxes.values.size(); ++i)
        if (boxes.surface.points[i].y() > 3) boxes.painted[i] = boxes.painted[i] && boxes.values[i] == 0;
    const Points gradients = fibre_gradients(boxes.tets, boxes.on_surface(), boxes.values, boxes.painted);
    double worst = 0;
    for (std::size_t t = 0; t < gradients.size(); ++t) {
        const double y = boxes.tets.vertices[at(boxes.tets.tets[t][0])].y();
        // One fibre in all through each: as steep as the section is narrow.
        const Vec3 expected(y > 3 ? 0 : y < -3 ? 1 / (2.4 * 2.4) : 1 / (0.85 * 0.85), 0, 0);
        worst = std::max(worst, (gradients[t] - expected).norm());
    }
    CHECK(worst < 1e-9);
    // The wide one is not faint beside the narrow one, and what no fibre reaches has no direction.
    const Points fibres = fibre_directions(boxes.tets, gradients);
    for (std::size_t t = 0; t < fibres.size(); ++t)
        REQUIRE((fibres[t] - (gradients[t].isZero() ? Vec3(0, 0, 0) : Vec3(1, 0, 0))).norm() < 1e-9);
}

TEST_CASE("fibres that cannot be laid are refused", "[mesh][harmonic]") {
    Painted box(make_cube(3, 1, 1, 8, 4, 4), 0.5);
    const auto code = [&] {
        try {
            fibre_gradients(box.tets, box.on_surface(), box.values, box.painted);
        } catch (const Error& e) {
            return e.code;
        }
        return std::string("none");
    };
    CHECK(code() == "FE212"); // nothing is painted
    box.paint_ends(1e-9);
    CHECK(code() == "none");
    for (double& v : box.values) v += v > 0.5 ? std::numeric_limits<double>::infinity() : 0;
    CHECK(code() == "FE202");
    box.values.pop_back();
    CHECK(code() == "FE204");
}

TEST_CASE("samples share out the area of a triangle and stay on it", "[mesh][harmonic]") {
    const Cube cube(7);
    const std::vector<char> all(8, 1);
    const PaintSamples samples = sample_paint(cube.tets, cube.painted(), all);
    REQUIRE(samples.vertices() == 8);
    REQUIRE(samples.areas.size() > 6 * 14 * 14); // half an edge apart, on six sides
    double area = 0;
    for (const double a : samples.areas) {
        REQUIRE(a > 0);
        area += a;
    }
    REQUIRE(area == Approx(6));
    const std::vector<double> ones = samples.values(std::vector<double>(8, 1.0 / 3));
    for (const double v : ones) REQUIRE(v == 1.0 / 3);
    std::vector<double> x;
    for (const Vec3& p : cube.tets.vertices) x.insert(x.end(), p.data(), p.data() + 3);
    Points places;
    apply(samples.embedding, cube.tets.tets, x.data(), places);
    std::vector<double> corner_x;
    for (const Vec3& p : cube.surface.points) corner_x.push_back(p.x());
    const std::vector<double> sample_x = samples.values(corner_x);
    for (std::size_t i = 0; i < places.size(); ++i) REQUIRE(places[i].x() == Approx(sample_x[i]).margin(1e-12));
    // A side with a corner that is not painted gets none, and triangles smaller than the tets none either.
    std::vector<char> none(8, 0);
    none[0] = 1;
    REQUIRE(sample_paint(cube.tets, cube.painted(), none).corners.empty());
    const Painted sphere(make_sphere(1, 40, 40), 0.5);
    REQUIRE(sample_paint(sphere.tets, {sphere.surface.points, sphere.surface.triangles, sphere.embedding},
                         std::vector<char>(sphere.areas.size(), 1))
                .areas == sphere.areas);
}

TEST_CASE("a linear map of a muscle is its extension at every tet size", "[mesh][harmonic]") {
    const SurfaceMesh muscle = read_surface(SINEW_SOURCE_DIR "/graphs/scenes/arm_ziva/muscles/brachialis.obj");
    const Box box = bounding_box(muscle.points);
    const Vec3 slope = Vec3(1, -0.7, 0.4) / box.size().maxCoeff();
    std::vector<double> values;
    for (const Vec3& p : muscle.points) values.push_back(slope.dot(p - box.min));
    double last = 1e300;
    for (const double parts : {15.0, 30.0}) {
        LatticeOptions options;
        options.tet_size = box.size().maxCoeff() / parts;
        const TetMesh mesh = make_lattice(muscle.points, muscle.triangles, options);
        const Embedding embedding = embed(mesh, muscle.points);
        const std::vector<double> field = harmonic_extensions(mesh, {muscle.points, muscle.triangles, embedding},
                                                              {values}, std::vector<char>(values.size(), 1))[0];
        std::vector<char> inside(field.size(), 1);
        for (std::size_t t = 0; t < mesh.tets.size(); ++t)
            if (mesh.coverage[t] < 1)
                for (const int v : mesh.tets[t]) inside[at(v)] = 0;
        double within = 0, all = 0;
        for (std::size_t v = 0; v < field.size(); ++v) {
            const double error = std::abs(field[v] - slope.dot(mesh.vertices[v] - box.min));
            all = std::max(all, error);
            if (inside[v]) within = std::max(within, error);
        }
        CAPTURE(parts, within, all);
        REQUIRE(within < 1e-4);
        REQUIRE(all < last);
        last = all;
    }
}

TEST_CASE("a flat tet is refused by name", "[mesh][harmonic]") {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}};
    mesh.tets = {{0, 1, 2, 3}, {0, 1, 4, 2}};
    mesh.coverage = {1, 1};
    const Embedding e{{0, 0}, {{1, 0, 0, 0}, {0, 0, 0, 1}}};
    std::string said;
    try {
        harmonic_extension(mesh, e, {1, 1}, {0, 1}, {1, 1});
    } catch (const Error& error) {
        said = error.code + " " + error.what();
    }
    REQUIRE(said.find("FE215 tet 1 ") == 0);
    REQUIRE_THROWS_AS(unit_gradients(mesh, {0, 0, 0, 0, 0}), Error);
}
