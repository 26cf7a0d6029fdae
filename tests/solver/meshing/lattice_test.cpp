// The lattice: which tets, how much of each is solid, for good and bad surfaces.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/embedding.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <random>
#include <set>

using namespace sinew::solver;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

TetMesh lattice_of(const SurfaceMesh& mesh, double size = 0, double least = 0) {
    LatticeOptions options;
    options.tet_size = size;
    options.least_coverage = least;
    return make_lattice(mesh.points, mesh.triangles, options);
}

double volume_of(const TetMesh& mesh, std::size_t t) {
    const auto v = [&](std::size_t k) { return mesh.vertices[at(mesh.tets[t][k])]; };
    return tet_volume(v(0), v(1), v(2), v(3));
}

double covered_volume(const TetMesh& mesh) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) sum += mesh.coverage[t] * volume_of(mesh, t);
    return sum;
}

int whole_count(const TetMesh& mesh) {
    return static_cast<int>(std::count(mesh.coverage.begin(), mesh.coverage.end(), 1.0));
}

double longest_side(const SurfaceMesh& mesh) { return bounding_box(mesh.points).size().maxCoeff(); }

/// All that must hold for any lattice.
void require_sound(const TetMesh& mesh, double size) {
    REQUIRE(mesh.coverage.size() == mesh.tets.size());
    std::set<std::array<int, 4>> seen;
    std::vector<char> used(mesh.vertices.size(), 0);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        REQUIRE(volume_of(mesh, t) == Approx(size * size * size / 12).epsilon(1e-9));
        REQUIRE(mesh.coverage[t] > 0);
        REQUIRE(mesh.coverage[t] <= 1);
        std::array<int, 4> key = mesh.tets[t];
        std::sort(key.begin(), key.end());
        REQUIRE(seen.insert(key).second);
        for (int v : key) used[at(v)] = 1;
    }
    REQUIRE(std::count(used.begin(), used.end(), 0) == 0);
    for (std::size_t v = 1; v < mesh.vertices.size(); ++v) {
        const Vec3 &a = mesh.vertices[v - 1], &b = mesh.vertices[v];
        REQUIRE(std::tuple(a.z(), a.y(), a.x()) < std::tuple(b.z(), b.y(), b.x()));
    }
}

std::string code_of(const SurfaceMesh& mesh, LatticeOptions options = {}, std::string* message = nullptr) {
    try {
        make_lattice(mesh.points, mesh.triangles, options);
    } catch (const Error& e) {
        if (message) *message = e.what();
        return e.code;
    }
    return "none";
}

SurfaceMesh joined(const SurfaceMesh& a, const SurfaceMesh& b, const Vec3& shift) {
    Points points = a.points;
    std::vector<Triangle> triangles = a.triangles;
    for (const Vec3& p : b.points) points.push_back(p + shift);
    const int n = static_cast<int>(a.points.size());
    for (const Triangle& t : b.triangles) triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    return SurfaceMesh::from_triangles(points, triangles);
}

std::vector<std::string> arm_meshes() {
    std::vector<std::string> files;
    for (const char* folder : {"bones", "muscles"})
        for (const auto& entry :
             std::filesystem::directory_iterator(std::string(SINEW_SOURCE_DIR "/graphs/scenes/arm_ziva/") + folder))
            if (entry.path().extension() == ".obj") files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
}

} // namespace

TEST_CASE("the unit sphere at 2/3.5 has 600 tets, 168 of them wholly inside", "[lattice]") {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    for (double size : {0.0, 2 / 3.5}) {
        const TetMesh mesh = lattice_of(sphere, size);
        REQUIRE(mesh.tets.size() == 600);
        REQUIRE(whole_count(mesh) == 168);
        REQUIRE(covered_volume(mesh) == Approx(enclosed_volume(sphere.points, sphere.triangles)).epsilon(1e-12));
        require_sound(mesh, 2 / 3.5);
        // One lattice vertex lies exactly at the centre of the bounding box.
        REQUIRE(std::find(mesh.vertices.begin(), mesh.vertices.end(), Vec3(0, 0, 0)) != mesh.vertices.end());
    }
}

TEST_CASE("coverage agrees with random points in each tet", "[lattice]") {
    const SurfaceMesh helix = make_helix(1, 0.35, 1.5, 1.5, 12, 30);
    const TetMesh mesh = lattice_of(helix, 0.6);
    const SurfaceTree tree(helix.points, helix.triangles);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> u(0, 1);
    constexpr int samples = 300;
    double worst = 0, squares = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        int inside = 0;
        for (int s = 0; s < samples; ++s) {
            std::array<double, 3> cut{u(random), u(random), u(random)};
            std::sort(cut.begin(), cut.end());
            const double b[4] = {cut[0], cut[1] - cut[0], cut[2] - cut[1], 1 - cut[2]};
            Vec3 p = Vec3::Zero();
            for (std::size_t k = 0; k < 4; ++k) p += b[k] * mesh.vertices[at(mesh.tets[t][k])];
            inside += tree.inside(p);
        }
        const double c = mesh.coverage[t], deviation = std::sqrt((c * (1 - c) + 1e-3) / samples);
        const double error = (inside / static_cast<double>(samples) - c) / deviation;
        worst = std::max(worst, std::abs(error));
        squares += error * error / static_cast<double>(mesh.tets.size());
    }
    CAPTURE(worst, squares, mesh.tets.size());
    REQUIRE(worst < 5);      // standard deviations, over some hundred tets
    REQUIRE(squares < 1.15); // and no bias on the whole
}

TEST_CASE("the covered volume of every arm mesh is its own volume, at any size", "[lattice][arm]") {
    const std::vector<std::string> files = arm_meshes();
    REQUIRE(files.size() >= 12);
    for (const std::string& file : files) {
        const SurfaceMesh mesh = read_surface(file);
        const double volume = enclosed_volume(mesh.points, mesh.triangles), side = longest_side(mesh);
        for (double size : {side / 3.5, side / 20}) {
            const TetMesh lattice = lattice_of(mesh, size);
            INFO(file << " size " << size);
            REQUIRE(covered_volume(lattice) == Approx(volume).epsilon(1e-9));
            // The surface sticks out of nothing.
            for (const auto& b : embed(lattice, mesh.points).barycentric)
                REQUIRE(*std::min_element(b.begin(), b.end()) > -1e-8);
        }
        require_sound(lattice_of(mesh, side / 20), side / 20);
    }
}

TEST_CASE("the least coverage lifts grazed tets and hardly changes the volume", "[lattice]") {
    const SurfaceMesh biceps = read_surface(SINEW_SOURCE_DIR "/graphs/scenes/arm_ziva/muscles/biceps.obj");
    const TetMesh exact = lattice_of(biceps, 0), lifted = make_lattice(biceps.points, biceps.triangles, {});
    REQUIRE(lifted.tets == exact.tets);
    REQUIRE(*std::min_element(lifted.coverage.begin(), lifted.coverage.end()) == 1e-3);
    for (std::size_t t = 0; t < exact.tets.size(); ++t)
        REQUIRE(lifted.coverage[t] == std::max(exact.coverage[t], 1e-3));
    REQUIRE(covered_volume(lifted) == Approx(covered_volume(exact)).epsilon(1e-3));
}

TEST_CASE("boxes whose faces lie in lattice planes are filled exactly, without empty tets", "[lattice]") {
    // Faces through cube corners, through cube centres, and both.
    for (const Vec3& size : {Vec3(1, 1, 1), Vec3(2, 0.3, 0.5), Vec3(0.7, 0.9, 0.4), Vec3(0.1, 0.1, 0.1)}) {
        const SurfaceMesh box = make_cube(size.x(), size.y(), size.z(), 3, 2, 1);
        const TetMesh mesh = lattice_of(box, 0.1);
        CAPTURE(size.transpose());
        REQUIRE(covered_volume(mesh) == Approx(size.prod()).epsilon(1e-10));
        require_sound(mesh, 0.1);
        REQUIRE(*std::min_element(mesh.coverage.begin(), mesh.coverage.end()) > 0.01);
    }
    REQUIRE(lattice_of(make_cube(1, 1, 1, 1, 1, 1), 0.5).tets.size() == 144);
}

TEST_CASE("a plate thinner than a tet is covered by its own volume", "[lattice]") {
    for (double thickness : {1e-2, 1e-4, 1e-5}) {
        const SurfaceMesh plate = make_cube(1, thickness, 0.7, 1, 1, 1);
        const TetMesh mesh = lattice_of(plate, 0.13);
        REQUIRE(covered_volume(mesh) == Approx(0.7 * thickness).epsilon(1e-6));
        REQUIRE(whole_count(mesh) == 0);
    }
}

TEST_CASE("place and scale do not change a lattice beyond rounding", "[lattice]") {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    for (double scale : {1e-3, 1.0, 1e3}) {
        SurfaceMesh moved = sphere;
        for (Vec3& p : moved.points) p = scale * (p + Vec3(1000, -300, 77));
        const TetMesh mesh = lattice_of(moved);
        REQUIRE(mesh.tets.size() == 600);
        REQUIRE(whole_count(mesh) == 168);
        REQUIRE(covered_volume(mesh) == Approx(enclosed_volume(moved.points, moved.triangles)).epsilon(1e-9));
    }
}

TEST_CASE("a surface turned inside out gives the same lattice", "[lattice]") {
    SurfaceMesh helix = make_helix(1, 0.2, 1, 1.2, 8, 20);
    const TetMesh mesh = lattice_of(helix);
    for (Triangle& t : helix.triangles) std::swap(t[0], t[1]);
    const TetMesh turned = lattice_of(helix);
    REQUIRE(turned.tets == mesh.tets);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        REQUIRE(turned.coverage[t] == Approx(mesh.coverage[t]).margin(1e-12));
}

TEST_CASE("parts that overlap count once", "[lattice]") {
    const SurfaceMesh a = make_cube(1, 1, 1, 4, 4, 4), b = make_cube(0.8, 1.3, 0.6, 4, 4, 4);
    const SurfaceMesh both = joined(a, b, {0.437, 0.119, 0.0713});
    const double overlap = (0.5 - 0.437 + 0.4) * (0.5 - 0.119 + 0.5 + 0.119) * 0.6;
    const double volume = 1 + 0.8 * 1.3 * 0.6 - overlap;
    double error[2];
    for (int k = 0; k < 2; ++k) error[k] = std::abs(covered_volume(lattice_of(both, 0.3 / (1 << k))) / volume - 1);
    CAPTURE(error[0], error[1]);
    REQUIRE(error[0] < 2e-3);
    REQUIRE(error[1] < 5e-4);
    // The same part twice is one part.
    REQUIRE(covered_volume(lattice_of(joined(a, a, {0, 0, 0}), 0.3)) == Approx(1).epsilon(1e-6));
    // A part that is inside out beside one that is not is solid too.
    SurfaceMesh turned = b;
    for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
    REQUIRE(covered_volume(lattice_of(joined(a, turned, {3, 0, 0}), 0.3)) == Approx(1 + 0.8 * 1.3 * 0.6).epsilon(1e-6));
}

TEST_CASE("vertices doubled along seams do not open a surface", "[lattice]") {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    Points points;
    std::vector<Triangle> triangles;
    for (const Triangle& t : sphere.triangles) {
        const int n = static_cast<int>(points.size());
        for (int v : t) points.push_back(sphere.points[at(v)]);
        triangles.push_back({n, n + 1, n + 2});
    }
    const TetMesh mesh = lattice_of(SurfaceMesh::from_triangles(points, triangles));
    REQUIRE(mesh.tets == lattice_of(sphere).tets);
    REQUIRE(covered_volume(mesh) == Approx(4.0948612).epsilon(1e-6));
}

TEST_CASE("a scanned bone with cracks and self-intersections is filled", "[lattice]") {
    const SurfaceMesh radius = read_surface(SINEW_SOURCE_DIR "/tests/solver/mesh/data/radius_with_cracks.obj");
    REQUIRE_FALSE(is_closed(radius.triangles));
    const double volume = enclosed_volume(radius.points, radius.triangles); // near enough with small cracks
    for (double parts : {3.5, 20.0}) {
        const TetMesh mesh = lattice_of(radius, longest_side(radius) / parts);
        REQUIRE(covered_volume(mesh) == Approx(volume).epsilon(2e-3));
        require_sound(mesh, longest_side(radius) / parts);
    }
}

TEST_CASE("a few missing triangles change the volume by no more than their dents", "[lattice]") {
    SurfaceMesh sphere = make_sphere(1, 40, 40);
    const double volume = enclosed_volume(sphere.points, sphere.triangles);
    std::vector<Triangle> some;
    for (std::size_t t = 0; t < sphere.triangles.size(); ++t)
        if (t % 97 != 5 && t != 300 && t != 301) some.push_back(sphere.triangles[t]);
    sphere.triangles = some;
    REQUIRE(covered_volume(lattice_of(sphere)) == Approx(volume).epsilon(1e-3));
}

TEST_CASE("a large hole is closed by the surface of winding number one half, at second order", "[lattice]") {
    const SurfaceMesh sphere = make_sphere(1, 32, 32);
    std::vector<Triangle> cup;
    for (const Triangle& t : sphere.triangles)
        if (sphere.points[at(t[0])].y() + sphere.points[at(t[1])].y() + sphere.points[at(t[2])].y() < 0.9)
            cup.push_back(t);
    const SurfaceMesh open = SurfaceMesh::from_triangles(sphere.points, cup);
    double volume[3];
    for (int k = 0; k < 3; ++k) {
        const TetMesh mesh = lattice_of(open, 0.8 / (1 << k));
        volume[k] = covered_volume(mesh);
        require_sound(mesh, 0.8 / (1 << k));
    }
    CAPTURE(volume[0], volume[1], volume[2]);
    // Between the cup filled to its rim and the whole sphere.
    REQUIRE(volume[2] > 0.5 * 4.18);
    REQUIRE(volume[2] < 4.18);
    REQUIRE(std::abs(volume[1] - volume[0]) < 0.02 * volume[2]);
    REQUIRE(std::abs(volume[2] - volume[1]) < 0.35 * std::abs(volume[1] - volume[0]) + 1e-4 * volume[2]);
}

TEST_CASE("far from a large hole the coverage is exactly that of the closed surface", "[lattice]") {
    const SurfaceMesh sphere = make_sphere(1, 32, 32);
    std::vector<Triangle> cup;
    for (const Triangle& t : sphere.triangles)
        if (sphere.points[at(t[0])].y() + sphere.points[at(t[1])].y() + sphere.points[at(t[2])].y() < 2.1)
            cup.push_back(t);
    // A point at the pole keeps the bounding box, and so the lattice, where it is.
    Points points = sphere.points;
    const int first = static_cast<int>(points.size());
    for (const Vec3& p : {Vec3(0, 1, 0), Vec3(1e-5, 1, 0), Vec3(0, 1, 1e-5)}) points.push_back(p);
    cup.push_back({first, first + 1, first + 2});
    const TetMesh closed = lattice_of(sphere, 0.3);
    const TetMesh open = lattice_of(SurfaceMesh::from_triangles(points, cup), 0.3);
    std::map<std::array<double, 3>, double> coverage; // by the middle
    const auto middle = [](const TetMesh& mesh, std::size_t t) {
        Vec3 sum = Vec3::Zero();
        for (int v : mesh.tets[t]) sum += mesh.vertices[at(v)];
        return std::array<double, 3>{sum.x(), sum.y(), sum.z()};
    };
    for (std::size_t t = 0; t < closed.tets.size(); ++t) coverage[middle(closed, t)] = closed.coverage[t];
    int compared = 0;
    for (std::size_t t = 0; t < open.tets.size(); ++t) {
        if (middle(open, t)[1] > -1.2) continue; // four times the height
        REQUIRE(coverage.count(middle(open, t)) == 1);
        REQUIRE(open.coverage[t] == Approx(coverage[middle(open, t)]).margin(1e-9));
        compared += open.coverage[t] < 1;
    }
    REQUIRE(compared > 200);
}

TEST_CASE("curved sheets and random triangles give some lattice or an Error", "[lattice]") {
    SurfaceMesh sheet = make_plane(1, 1, 8, 8);
    for (Vec3& p : sheet.points) p.y() = 0.1 * std::sin(5 * p.x());
    require_sound(lattice_of(sheet, 0.2, 1e-3), 0.2);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> u(0, 1);
    for (int trial = 0; trial < 30; ++trial) {
        SurfaceMesh soup;
        for (int i = 0; i < 12; ++i) soup.points.emplace_back(u(random), u(random), u(random));
        for (int i = 0; i < 25; ++i)
            soup.triangles.push_back({int(random() % 12), int(random() % 12), int(random() % 12)});
        LatticeOptions options;
        options.tet_size = 0.4;
        const std::string code = code_of(soup, options);
        REQUIRE((code == "none" || code == "FE223"));
    }
}

TEST_CASE("unusable surfaces and options are refused with their code", "[lattice]") {
    const SurfaceMesh cube = make_cube(1, 1, 1, 1, 1, 1);
    REQUIRE(code_of(SurfaceMesh{}) == "FE201");
    SurfaceMesh bad = cube;
    bad.triangles.clear();
    REQUIRE(code_of(bad) == "FE201");
    bad = cube;
    bad.points[3].y() = std::nan("");
    REQUIRE(code_of(bad) == "FE202");
    bad = cube;
    bad.triangles[2][1] = 8;
    REQUIRE(code_of(bad) == "FE203");
    REQUIRE(code_of(make_plane(1, 1, 3, 3)) == "FE223");
    bad = cube;
    for (Vec3& p : bad.points) p = Vec3(1, 2, 3);
    REQUIRE(code_of(bad) == "FE223");
    bad = cube;
    for (Vec3& p : bad.points) p = Vec3(p.x(), p.x(), p.x());
    REQUIRE(code_of(bad) == "FE223");
    bad = cube;
    for (Vec3& p : bad.points) p *= 1e200;
    REQUIRE(code_of(bad) == "FE224");
    // A closed sheet without an inside.
    SurfaceMesh sheet = make_plane(1, 1, 2, 2);
    sheet.points[4].y() = 0.3;
    const std::size_t n = sheet.triangles.size();
    for (std::size_t t = 0; t < n; ++t)
        sheet.triangles.push_back({sheet.triangles[t][0], sheet.triangles[t][2], sheet.triangles[t][1]});
    REQUIRE(code_of(sheet) == "FE223");
    for (double size : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        LatticeOptions options;
        options.tet_size = size;
        REQUIRE(code_of(cube, options) == "FE222");
    }
}

TEST_CASE("a lattice that would be too fine is refused with its count", "[lattice]") {
    const SurfaceMesh box = make_cube(3, 1, 1, 1, 1, 1);
    LatticeOptions options;
    std::string message;
    options.tet_size = 0.01;
    REQUIRE(code_of(box, options, &message) == "FE210");
    REQUIRE(message.find("300 cubes") != std::string::npos);
    REQUIRE(message.find("150") != std::string::npos);
    options.max_resolution = 10;
    options.tet_size = 0.3;
    REQUIRE(code_of(box, options) == "none");
    options.tet_size = 0.29;
    REQUIRE(code_of(box, options) == "FE210");
    options.max_resolution = std::numeric_limits<int>::max();
    for (double tiny : {1e-4, 1e-30, 1e-310}) {
        options.tet_size = tiny;
        REQUIRE(code_of(box, options, &message) == "FE210");
    }
}

TEST_CASE("a lattice of more tets than memory holds is refused at once whatever the maximum resolution", "[lattice]") {
    const SurfaceMesh box = make_cube(1, 1, 1, 1, 1, 1);
    LatticeOptions options;
    options.max_resolution = 100000;
    std::string message;
    options.tet_size = 0.0083; // 12 tets a cube
    REQUIRE(code_of(box, options, &message) == "FE210");
    REQUIRE(message == "the lattice would have about 21 million tets; the limit is 20 million");
    options.tet_size = 0.004;
    REQUIRE(code_of(box, options, &message) == "FE210");
    REQUIRE(message == "the lattice would have about 188 million tets; the limit is 20 million");
    options.fill = Fill::surface_only; // a shell one tet thick
    options.tet_size = 0.05;
    REQUIRE(code_of(box, options) == "none");
}

TEST_CASE("a lattice of huge tets is refused at once with a size that would do", "[lattice]") {
    const SurfaceMesh box = make_cube(3, 1, 1, 1, 1, 1);
    const auto begin = std::chrono::steady_clock::now();
    for (const double huge : {1e5, 1e100, 1e154, 1e300, std::numeric_limits<double>::max()})
        for (const double levels : {0.0, 3.0}) {
            INFO(huge << " refined " << levels);
            LatticeOptions options;
            options.tet_size = huge;
            options.refinement = {levels};
            try {
                make_lattice(box.points, box.triangles, options);
                FAIL("made");
            } catch (const Error& e) {
                CHECK(e.code == "FE210");
                CHECK(std::string(e.what()).find("too large for this mesh: its longest side is 3") !=
                      std::string::npos);
                CHECK(e.hint.find("choose a tet size of ") == 0);
            }
        }
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(10));
}

TEST_CASE("a lattice has the same bits on one thread and on many", "[lattice]") {
    const SurfaceMesh biceps = read_surface(SINEW_SOURCE_DIR "/graphs/scenes/arm_ziva/muscles/biceps.obj");
    const SurfaceMesh crossed = make_helix(1, 0.4, 1.2, 1.5, 8, 20); // overlaps itself
    for (const SurfaceMesh& mesh : {biceps, crossed}) {
        TetMesh one;
        {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
            one = lattice_of(mesh, longest_side(mesh) / 10);
        }
        const TetMesh many = lattice_of(mesh, longest_side(mesh) / 10);
        REQUIRE(one.vertices == many.vertices);
        REQUIRE(one.tets == many.tets);
        REQUIRE(one.coverage == many.coverage);
    }
}
