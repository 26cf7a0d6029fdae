// Delaunay tets: the boundary is the input, shapes are good, what cannot be filled is refused by name.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "soups.h"

#include "solver/error.h"
#include "solver/mesh/embedding.h"
#include "solver/mesh/harmonic.h"
#include "solver/mesh/mesh_check.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/tet_quality.h"
#include "solver/meshing/delaunay_tets.h"
#include "solver/meshing/guarded_delaunay.h"
#include "solver/meshing/iso_mesh.h"
#include "solver/meshing/tet_improve.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace soups;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The iso mesh of a shape: a surface that can be filled.
Shape remeshed(const Shape& s, double size) {
    const double d = bounding_box(s.points).size().norm();
    IsoMeshOptions o;
    o.iso_value = s.is_closed ? 0 : 0.03 * d;
    o.triangle_size = size * d;
    o.resolution = 64;
    IsoMesh m = make_iso_mesh(s.points, s.triangles, o);
    return {s.name, std::move(m.points), std::move(m.triangles), true};
}

TetMesh fill(const Shape& s, double quality = 0.8) { return make_delaunay_tets(s.points, s.triangles, {quality}); }

std::vector<Triangle> canonical(std::vector<Triangle> triangles) {
    for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

double volume(const TetMesh& m, const Tet& t) {
    return tet_volume(m.vertices[at(t[0])], m.vertices[at(t[1])], m.vertices[at(t[2])], m.vertices[at(t[3])]);
}
double quality(const TetMesh& m, const Tet& t) {
    return tet_quality(m.vertices[at(t[0])], m.vertices[at(t[1])], m.vertices[at(t[2])], m.vertices[at(t[3])]);
}
double worst(const TetMesh& m) {
    double q = 1;
    for (const Tet& t : m.tets) q = std::min(q, quality(m, t));
    return q;
}

void require_exact(const Shape& s, const TetMesh& m) {
    REQUIRE(m.vertices.size() >= s.points.size());
    CHECK(std::equal(s.points.begin(), s.points.end(), m.vertices.begin()));
    CHECK(canonical(boundary_triangles(m.tets)) == canonical(s.triangles));
    double sum = 0;
    for (const Tet& t : m.tets) {
        const double v = volume(m, t);
        REQUIRE(v > 0);
        sum += v;
    }
    CHECK(sum == Approx(enclosed_volume(s.points, s.triangles)).epsilon(1e-12));
    CHECK(m.coverage == std::vector<double>(m.tets.size(), 1.0));
}

std::string code_of(const Shape& s, std::string* message = nullptr, double q = 0.8) {
    try {
        fill(s, q);
    } catch (const Error& e) {
        if (message) *message = e.what();
        return e.code;
    }
    return "none";
}

} // namespace

TEST_CASE("the boundary of the tets of ten iso meshes is the iso mesh, triangle by triangle", "[delaunay]") {
    for (const Shape& shape : ten_shapes()) {
        INFO(shape.name);
        const Shape s = remeshed(shape, 0.04);
        const TetMesh m = fill(s);
        require_exact(s, m);
        CHECK(dihedral_range(m)[0] > 5);
        CHECK(dihedral_range(m)[1] < 172);
        double mean = 0;
        for (const Tet& t : m.tets) mean += quality(m, t) / static_cast<double>(m.tets.size());
        CHECK(mean > 0.75);
    }
}

TEST_CASE("surfaces whose triangles Delaunay does not choose are filled exactly too", "[delaunay]") {
    std::vector<Shape> all{shape("cube", make_cube(1, 1, 1, 1, 1, 1)),
                           shape("fine cube", make_cube(1, 2, 3, 4, 4, 4)),
                           shape("plate", make_cube(4, 0.01, 4, 1, 1, 1)),
                           shape("sphere", make_sphere(1, 20, 20)),
                           shape("cylinder", make_cylinder(0.1, 3, 20, 1, 1)),
                           shape("helix", make_helix(1, 0.2, 2, 2, 8, 12)),
                           ten_shapes()[5]};
    // Slivers all over: a ball with its vertices moved about.
    Shape rough = shape("rough ball", make_sphere(1, 14, 10));
    std::mt19937 random(11);
    for (Vec3& p : rough.points) p *= 0.85 + 0.3 * (random() / 4294967296.0);
    all.push_back(rough);
    for (const std::string name : {"bones/humerus", "muscles/biceps", "muscles/brachialis"}) {
        const SurfaceMesh m = read_surface(std::string(SINEW_SOURCE_DIR) + "/graphs/scenes/arm_ziva/" + name + ".obj");
        all.push_back(shape(name, m));
    }
    for (const Shape& s : all) {
        INFO(s.name);
        require_exact(s, fill(s));
        require_exact(s, fill(s, 0));
    }
}

TEST_CASE("a prism that has no tets without a new vertex gets one, inside", "[delaunay]") {
    // Schoenhardt 1928: the top is turned, and the diagonals of the sides bend inwards.
    Shape twisted{"twisted prism", {}, {{0, 2, 1}, {3, 4, 5}}, true};
    for (int k = 0; k < 6; ++k) {
        const double angle = (k % 3) * 2 * M_PI / 3 + (k < 3 ? 0 : M_PI / 6);
        twisted.points.emplace_back(std::cos(angle), std::sin(angle), k < 3 ? 0 : 1);
    }
    Shape other = twisted;
    for (int k = 0; k < 3; ++k) {
        const int a = k, b = (k + 1) % 3, c = 3 + k, d = 3 + (k + 1) % 3;
        twisted.triangles.insert(twisted.triangles.end(), {{a, b, d}, {a, d, c}});
        other.triangles.insert(other.triangles.end(), {{a, b, c}, {b, d, c}});
    }
    // The smaller of the two is the one whose sides bend inwards.
    if (enclosed_volume(other.points, other.triangles) < enclosed_volume(twisted.points, twisted.triangles))
        std::swap(other, twisted);
    const TetMesh m = fill(twisted, 0);
    require_exact(twisted, m);
    CHECK(m.vertices.size() > 6);
    require_exact(other, fill(other, 0));
}

TEST_CASE("more quality gives more tets, and none gives no lattice inside", "[delaunay]") {
    const Shape s = remeshed(shape("ball", make_sphere(1, 32, 24)), 0.04);
    std::size_t before = 0;
    for (const double q : {0.0, 0.3, 0.6, 0.9, 1.0}) {
        INFO(q);
        const TetMesh m = fill(s, q);
        require_exact(s, m);
        CHECK(m.tets.size() > before);
        before = m.tets.size();
        if (q == 0) {
            // Only where tets were flat may there be new vertices.
            CHECK(m.vertices.size() < 1.3 * static_cast<double>(s.points.size()));
        }
        if (q >= 0.6) CHECK(dihedral_range(m)[0] > 10);
    }
}

TEST_CASE("a surface is filled with the same tets wherever it stands, and in every unit", "[delaunay]") {
    const SurfaceMesh bar = make_cube(2, 1, 1, 8, 4, 4);
    const TetMesh here = make_delaunay_tets(bar.points, bar.triangles, {0.8});
    REQUIRE(here.vertices.size() > bar.points.size());
    for (const double unit : {1.0, 0.01, 39.37})
        for (const Vec3& by : {Vec3(0, 0, 0), Vec3(0.37, 11.1, -7.7)}) {
            CAPTURE(unit, by.x());
            Points points = bar.points;
            for (Vec3& p : points) p = unit * (p + by);
            const TetMesh there = make_delaunay_tets(points, bar.triangles, {0.8});
            REQUIRE(there.tets == here.tets);
            CHECK(std::equal(points.begin(), points.end(), there.vertices.begin()));
            double farthest = 0;
            for (std::size_t v = 0; v < here.vertices.size(); ++v)
                farthest = std::max(farthest, (there.vertices[v] / unit - by - here.vertices[v]).norm());
            CHECK(farthest < 1e-9);
        }
}

TEST_CASE("a cavity stays empty and an inside-out surface is filled", "[delaunay]") {
    const Shape hollow = remeshed(ten_shapes()[5], 0.05);
    require_exact(hollow, fill(hollow));
    Shape turned = remeshed(ten_shapes()[0], 0.05);
    turned.triangles = reversed(turned.triangles);
    const TetMesh m = fill(turned);
    CHECK(canonical(boundary_triangles(m.tets)) == canonical(reversed(turned.triangles)));
}

TEST_CASE("improvement makes the worst tet better and leaves the boundary alone", "[delaunay]") {
    for (const int which : {0, 3, 6}) {
        const Shape s = remeshed(ten_shapes()[at(which)], 0.05);
        INFO(s.name);
        const GuardedDelaunay raw = guarded_delaunay(s.points, s.triangles, {}, {});
        REQUIRE(raw.missing.empty());
        TetMesh m{raw.vertices, raw.tets, {}};
        const double before = worst(m);
        REQUIRE(before < 0.05); // slivers
        improve_tets(m, 6);
        CHECK(worst(m) > before + 0.04);
        m.coverage.assign(m.tets.size(), 1.0);
        require_exact(s, m);
        TetMesh same{raw.vertices, raw.tets, {}};
        improve_tets(same, 0);
        CHECK(same.tets == raw.tets);
    }
}

TEST_CASE("what tets cannot have as their boundary is refused, and the message says where", "[delaunay]") {
    std::string message;
    const Shape ball = remeshed(shape("ball", make_sphere(1, 24, 16)), 0.08);
    Shape open = ball;
    const Triangle lost = open.triangles.back();
    open.triangles.pop_back();
    CHECK(code_of(open, &message) == "FE230");
    CHECK(message.find("3 edges with one triangle") != std::string::npos);
    CHECK(message.find(std::to_string(std::min(lost[0], lost[1])) + "-" + std::to_string(std::max(lost[0], lost[1]))) !=
          std::string::npos);

    Shape flipped = ball;
    std::swap(flipped.triangles[7][0], flipped.triangles[7][1]);
    CHECK(code_of(flipped, &message) == "FE236");
    CHECK(message.find("3 edges whose triangles face opposite sides") != std::string::npos);

    // Two tets that share an edge: four triangles there.
    const Shape wedge{"two tets on an edge",
                      {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}},
                      {{0, 2, 3}, {0, 1, 2}, {1, 3, 2}, {0, 3, 1}, {0, 4, 5}, {0, 1, 4}, {1, 5, 4}, {0, 5, 1}}};
    CHECK(code_of(wedge, &message) == "FE236");
    CHECK(message.find("1 edge with more than two triangles (0-1)") != std::string::npos);

    Shape repeated = ball;
    repeated.points.push_back(ball.points[3]);
    CHECK(code_of(repeated, &message) == "FE236");
    CHECK(message.find("1 vertex at the place of another (" + std::to_string(ball.points.size()) + ")") !=
          std::string::npos);
    CHECK(message.find("1 vertex of no triangle") != std::string::npos);

    Shape crossing = ball;
    append(crossing, ball.points, ball.triangles, {0.5, 0.01, 0.02});
    CHECK(code_of(crossing, &message) == "FE237");
    CHECK(message.find("pairs of crossing triangles (") != std::string::npos);

    CHECK(code_of({"nothing", {}, {}}) == "FE201");
    CHECK(code_of(ball, nullptr, 1.5) == "FE222");
    CHECK(code_of(ball, nullptr, NAN) == "FE222");
    for (const double seconds : {-1.0, std::numeric_limits<double>::quiet_NaN(), 1e-6}) try {
            make_delaunay_tets(ball.points, ball.triangles, {0.8, seconds});
            FAIL(seconds);
        } catch (const Error& e) {
            CHECK(e.code == (seconds > 0 ? "FE233" : "FE222"));
        }
    Shape infinite = ball;
    infinite.points[5].x() = INFINITY;
    CHECK(code_of(infinite) == "FE202");
}

TEST_CASE("tets have the same bits on every run, show rising progress and can be stopped", "[delaunay]") {
    const Shape s = remeshed(ten_shapes()[6], 0.035);
    std::vector<double> seen;
    int asked = 0;
    const MeshingControl watch{[&] { return ++asked, false; },
                               [&](double done, std::string_view) { seen.push_back(done); }};
    const TetMesh a = make_delaunay_tets(s.points, s.triangles, {0.9}, watch), b = fill(s, 0.9);
    CHECK(a.vertices == b.vertices);
    CHECK(a.tets == b.tets);
    REQUIRE(seen.size() > 10);
    CHECK(std::is_sorted(seen.begin(), seen.end()));
    CHECK(seen.back() == 1);
    for (const int when : {1, asked / 3, asked / 2, asked}) {
        int count = 0;
        const MeshingControl stop{[&] { return ++count >= when; }, {}};
        CHECK_THROWS_AS(make_delaunay_tets(s.points, s.triangles, {0.9}, stop), Stopped);
        CHECK(count == when);
    }
}

TEST_CASE("on Delaunay tets linear functions embed exactly, and extend within their bounds", "[delaunay]") {
    const Shape s = remeshed(ten_shapes()[6], 0.03);
    const TetMesh m = fill(s);
    const auto linear = [](const Vec3& p) { return 3.0 + 2 * p.x() - 0.7 * p.y() + 1.3 * p.z(); };

    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0, 1);
    Points inside;
    for (int i = 0; i < 500; ++i) {
        const Tet& t = m.tets[random() % m.tets.size()];
        std::array<double, 4> w{share(random), share(random), share(random), share(random)};
        const double sum = w[0] + w[1] + w[2] + w[3];
        Vec3 p = Vec3::Zero();
        for (std::size_t k = 0; k < 4; ++k) p += w[k] / sum * m.vertices[at(t[k])];
        inside.push_back(p);
    }
    const Embedding points = embed(m, inside);
    for (std::size_t i = 0; i < inside.size(); ++i) {
        double value = 0;
        for (std::size_t k = 0; k < 4; ++k)
            value += points.barycentric[i][k] * linear(m.vertices[at(m.tets[at(points.tet[i])][k])]);
        CHECK(std::abs(value - linear(inside[i])) < 1e-10);
    }

    // All boundary vertices are painted, so a linear map's extension is that map: linear elements have it
    // exactly.
    const Embedding surface = embed(m, s.points);
    const std::vector<double> areas = vertex_areas(s.points, s.triangles);
    std::vector<double> values;
    for (const Vec3& p : s.points) values.push_back(linear(p));
    const std::vector<char> all(s.points.size(), 1);
    const std::vector<double> extended = harmonic_extension(m, surface, areas, values, all);
    double error = 0;
    for (std::size_t v = 0; v < extended.size(); ++v)
        error = std::max(error, std::abs(extended[v] - linear(m.vertices[v])));
    CHECK(error < 1e-8);

    // Painted at both ends only: within the painted bounds everywhere.
    std::vector<char> ends;
    std::vector<double> painted;
    for (const Vec3& p : s.points) {
        ends.push_back(p.x() < -0.6 || p.x() > 1.5);
        painted.push_back(p.x() > 1.5 ? 1 : 0);
    }
    const std::vector<double> between = harmonic_extension(m, surface, areas, painted, ends);
    CHECK(*std::min_element(between.begin(), between.end()) >= 0);
    CHECK(*std::max_element(between.begin(), between.end()) <= 1);
    double middle = 0;
    for (const double v : between) middle += v / static_cast<double>(between.size());
    CHECK(middle > 0.2);
    CHECK(middle < 0.8);
}
