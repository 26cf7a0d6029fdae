// Iso meshes: angles, manifoldness, where the surface lies, what is refused, the same bits every time.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "soups.h"

#include "solver/error.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/mesh_check.h"
#include "solver/meshing/distance_grid.h"
#include "solver/meshing/iso_mesh.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace soups;

namespace {

constexpr double pi = std::numbers::pi;

IsoMeshOptions options(double iso, double size, int resolution = 64) {
    IsoMeshOptions o;
    o.iso_value = iso;
    o.triangle_size = size;
    o.resolution = resolution;
    return o;
}

IsoMesh mesh_of(const Shape& s, const IsoMeshOptions& o) { return make_iso_mesh(s.points, s.triangles, o); }

double diagonal(const Shape& s) { return bounding_box(s.points).size().norm(); }

void require_closed_manifold(const IsoMesh& mesh) {
    const MeshCheck found = check_mesh(mesh.points, mesh.triangles);
    REQUIRE(mesh.triangles.size() > 20);
    CHECK(found.open_edges.count == 0);
    CHECK(found.non_manifold_edges.count == 0);
    CHECK(found.badly_oriented_edges.count == 0);
    CHECK(found.non_manifold_vertices.count == 0);
    CHECK(found.duplicate_triangles.count == 0);
    CHECK(found.coinciding_vertices.count == 0);
    CHECK(found.unused_vertices.count == 0);
    CHECK(found.volume > 0);
}

std::string code_of(const Shape& s, const IsoMeshOptions& o, std::string* message = nullptr) {
    try {
        mesh_of(s, o);
    } catch (const Error& e) {
        if (message) *message = e.what();
        return e.code;
    }
    return "none";
}

} // namespace

TEST_CASE("iso meshes of ten inputs have no angle below 30 degrees and are closed manifolds", "[iso]") {
    for (const Shape& s : ten_shapes()) {
        INFO(s.name);
        const double d = diagonal(s);
        const IsoMesh mesh = mesh_of(s, options(s.is_closed ? 0 : 0.02 * d, 0.03 * d));
        CHECK(least_angle(mesh.points, mesh.triangles) >= 30 - 1e-6);
        CHECK(mesh.lost == 0);
        require_closed_manifold(mesh);
    }
}

TEST_CASE("ten soups give closed manifolds without small angles", "[iso]") {
    unsigned seed = 1;
    for (const Shape& whole : ten_shapes()) {
        const Shape s = broken(whole, seed++);
        INFO(s.name);
        const double d = diagonal(s);
        const IsoMesh mesh = mesh_of(s, options(0.015 * d, 0.025 * d));
        CHECK(least_angle(mesh.points, mesh.triangles) >= 30 - 1e-6);
        require_closed_manifold(mesh);
    }
}

TEST_CASE("angles hold where manifoldness is not asked for", "[iso]") {
    for (const Shape& s : ten_shapes()) {
        INFO(s.name);
        const double d = diagonal(s);
        IsoMeshOptions o = options(0.01 * d, 0.03 * d);
        o.is_manifold = false;
        const IsoMesh mesh = mesh_of(s, o);
        CHECK(least_angle(mesh.points, mesh.triangles) >= 30 - 1e-6);
        CHECK(mesh.triangles.size() > 50);
    }
}

TEST_CASE("offsets of a ball are balls", "[iso]") {
    const Shape ball = shape("ball", make_sphere(1, 64, 48));
    for (const double iso : {0.4, 0.1, 0.0, -0.1, -0.4}) {
        INFO(iso);
        const IsoMesh mesh = mesh_of(ball, options(iso, 0.1));
        // 0.0024: how far the facets of the input lie inside the ball; 0.0008: the grid's linear pieces.
        for (const Vec3& p : mesh.points) CHECK(std::abs(p.norm() - (1 + iso)) < 0.0035);
        const double r = 1 + iso, volume = enclosed_volume(mesh.points, mesh.triangles);
        CHECK(volume == Approx(4 * pi / 3 * r * r * r).epsilon(0.025)); // chords lie inside
        double length = 0;
        for (const Triangle& t : mesh.triangles)
            length +=
                (mesh.points[static_cast<std::size_t>(t[0])] - mesh.points[static_cast<std::size_t>(t[1])]).norm();
        CHECK(length / static_cast<double>(mesh.triangles.size()) == Approx(0.1).epsilon(0.25));
    }
}

TEST_CASE("every vertex lies at the iso value from the input, up to a cell of the grid", "[iso]") {
    for (const Shape& s : ten_shapes()) {
        INFO(s.name);
        const double d = diagonal(s), iso = 0.03 * d;
        const IsoMesh mesh = mesh_of(s, options(iso, 0.04 * d, 96));
        const SurfaceTree tree(s.points, s.triangles);
        const double cell = (bounding_box(s.points).size().maxCoeff() + 2 * iso) / 92;
        double worst = 0;
        for (const Vec3& p : mesh.points) worst = std::max(worst, std::abs(tree.closest(p).distance - iso));
        CHECK(worst < 0.6 * cell);
    }
}

TEST_CASE("a shrunk cube is a smaller cube", "[iso]") {
    const Shape cube = shape("cube", make_cube(1, 1, 1, 1, 1, 1));
    const IsoMesh mesh = mesh_of(cube, options(-0.2, 0.05, 96));
    CHECK(enclosed_volume(mesh.points, mesh.triangles) == Approx(0.6 * 0.6 * 0.6).epsilon(0.02));
    const Vec3 size = bounding_box(mesh.points).size();
    for (int d = 0; d < 3; ++d) CHECK(size[d] == Approx(0.6).margin(0.012));
}

TEST_CASE("the surface inside a union does not dent what is shrunk from its outside", "[iso]") {
    Shape two = shape("two cubes", make_cube(1, 1, 1, 1, 1, 1));
    append(two, make_cube(1, 1, 1, 1, 1, 1), {0.5, 0, 0});
    const IsoMesh mesh = mesh_of(two, options(-0.1, 0.06));
    CHECK(enclosed_volume(mesh.points, mesh.triangles) == Approx(1.3 * 0.8 * 0.8).epsilon(0.02));
    CHECK(mesh.components == 1);
}

TEST_CASE("components are all found, cavities of closed meshes stay, those of open ones are filled", "[iso]") {
    const auto shapes = ten_shapes();
    const auto find = [&](const std::string& name) {
        return *std::find_if(shapes.begin(), shapes.end(), [&](const Shape& s) { return s.name == name; });
    };
    const auto parts = [](const IsoMesh& m) { return check_mesh(m.points, m.triangles).components; };
    CHECK(parts(mesh_of(find("six small balls"), options(0, 0.1))) == 6);
    CHECK(parts(mesh_of(find("six small balls"), options(0.01, 0.3))) == 6); // triangles as large as the balls
    const IsoMesh hollow = mesh_of(find("hollow ball"), options(0.05, 0.1));
    CHECK(parts(hollow) == 2);
    CHECK(enclosed_volume(hollow.points, hollow.triangles) ==
          Approx(4 * pi / 3 * (std::pow(1.05, 3) - std::pow(0.45, 3))).epsilon(0.03));
    Shape shell = shape("shell with a hole", make_sphere(1, 40, 30));
    shell.triangles.pop_back();
    const IsoMesh filled = mesh_of(shell, options(0.1, 0.1));
    CHECK(parts(filled) == 1);
    CHECK(enclosed_volume(filled.points, filled.triangles) == Approx(4 * pi / 3 * std::pow(1.1, 3)).epsilon(0.02));
}

TEST_CASE("triangles of a closed mesh that face the wrong way are turned", "[iso]") {
    Shape ball = shape("ball", make_sphere(1, 32, 24));
    for (std::size_t t = 0; t < ball.triangles.size(); t += 7) std::swap(ball.triangles[t][0], ball.triangles[t][1]);
    const IsoMesh mesh = mesh_of(ball, options(-0.3, 0.1));
    CHECK(enclosed_volume(mesh.points, mesh.triangles) == Approx(4 * pi / 3 * 0.343).epsilon(0.03));
    Shape inside_out = shape("ball inside out", make_sphere(1, 32, 24));
    inside_out.triangles = reversed(inside_out.triangles);
    const IsoMesh turned = mesh_of(inside_out, options(-0.3, 0.1));
    CHECK(enclosed_volume(turned.points, turned.triangles) == Approx(4 * pi / 3 * 0.343).epsilon(0.03));
}

TEST_CASE("what has no level set is refused, and the message says why", "[iso]") {
    const Shape plane = shape("plane", make_plane(2, 1, 2, 1), false);
    std::string message;
    CHECK(code_of(plane, options(0, 0.1), &message) == "FE230");
    CHECK(message.find("6 edges") != std::string::npos); // the border of 2 x 1 quads
    CHECK(message.find("vertices 0 and 1") != std::string::npos);
    CHECK(code_of(plane, options(-0.1, 0.1)) == "FE230");
    CHECK(code_of(plane, options(0.1, 0.1)) == "none");
    const Shape ball = shape("ball", make_sphere(1, 20, 20));
    CHECK(code_of(ball, options(-1.5, 0.1)) == "FE231");
    CHECK(code_of(ball, options(0, 1e-5)) == "FE232");
    CHECK(code_of(ball, options(0, 0.1, 8)) == "FE222");
    CHECK(code_of(ball, options(0, -1)) == "FE222");
    CHECK(code_of(ball, options(NAN, 0.1)) == "FE222");
    CHECK(code_of({"nothing", {}, {}}, options(0, 0.1)) == "FE201");
    CHECK(code_of({"a line", {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}}, options(0.1, 0.1)) == "FE201");
    CHECK(code_of({"not a number", {{0, 0, 0}, {1, 0, 0}, {1, NAN, 0}}, {{0, 1, 2}}}, options(0.1, 0.1)) == "FE202");
    CHECK(code_of({"no such vertex", {{0, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}}, options(0.1, 0.1)) == "FE203");
}

TEST_CASE("an iso mesh has the same bits on every run and for every number of threads", "[iso]") {
    for (const Shape& s : {ten_shapes()[1], ten_shapes()[6], broken(ten_shapes()[0], 3)}) {
        INFO(s.name);
        const IsoMeshOptions o = options(0.05, 0.12);
        const auto with_threads = [&](std::size_t n) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
            return mesh_of(s, o);
        };
        const IsoMesh one = with_threads(1), four = with_threads(4), again = with_threads(4);
        CHECK(one.points == four.points);
        CHECK(one.triangles == four.triangles);
        CHECK(again.points == four.points);
        CHECK(again.triangles == four.triangles);
    }
}

TEST_CASE("a long iso mesh shows rising progress, can be stopped at any time and keeps its time limit", "[iso]") {
    const Shape ball = shape("ball", make_sphere(1, 40, 30));
    std::vector<double> seen;
    int asked = 0;
    const MeshingControl watch{[&] { return ++asked, false; },
                               [&](double done, std::string_view) { seen.push_back(done); }};
    const IsoMesh mesh = make_iso_mesh(ball.points, ball.triangles, options(0.1, 0.05), watch);
    REQUIRE(seen.size() > 10);
    CHECK(std::is_sorted(seen.begin(), seen.end()));
    CHECK(seen.front() >= 0);
    CHECK(seen.back() == 1);
    CHECK(mesh.triangles == mesh_of(ball, options(0.1, 0.05)).triangles); // watching changes nothing
    REQUIRE(asked > 10);
    for (const int when : {1, asked / 2, asked}) {
        int count = 0;
        const MeshingControl stop{[&] { return ++count >= when; }, {}};
        CHECK_THROWS_AS(make_iso_mesh(ball.points, ball.triangles, options(0.1, 0.05), stop), Stopped);
        CHECK(count == when);
    }
    IsoMeshOptions hurried = options(0.1, 0.05);
    hurried.most_seconds = 1e-6;
    CHECK(code_of(ball, hurried) == "FE233");
}

TEST_CASE("the distance grid is the distance", "[iso]") {
    const Shape ball = shape("ball", make_sphere(1, 64, 48));
    const Soup soup = make_soup(ball.points, ball.triangles);
    const SurfaceTree tree(soup.points, soup.triangles);
    for (const double iso : {0.2, 0.0, -0.2}) {
        const DistanceGrid grid = make_distance_grid(soup, iso, 64, {});
        CHECK(grid.step == Approx((2 + 2 * std::max(iso, 0.0)) / 60));
        std::mt19937 random(7);
        std::uniform_real_distribution<double> anywhere(-1.3, 1.3), nearby(-0.03, 0.03);
        for (int i = 0; i < 2000; ++i) {
            Vec3 p(anywhere(random), anywhere(random), anywhere(random));
            const double outside = p.norm() - (1 + iso);
            if (std::abs(outside) > 0.05) CHECK((grid.value(p) > 0) == (outside > 0));
            p *= (1 + iso + nearby(random)) / p.norm();
            const double signed_distance = (tree.inside(p) ? -1 : 1) * tree.closest(p).distance;
            CHECK(grid.value(p) == Approx(signed_distance - iso).margin(2e-3));
        }
    }
}
