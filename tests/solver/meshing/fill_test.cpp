// Fill modes: what closed surfaces inside others mean, and which tets are kept.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice_checks.h"
#include "solver/error.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/embedding.h"
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"

#include <algorithm>
#include <numbers>

using namespace lattice_checks;

namespace {

void append(SurfaceMesh& mesh, SurfaceMesh part, const Vec3& shift, bool is_turned) {
    const int first = static_cast<int>(mesh.points.size());
    for (const Vec3& p : part.points) mesh.points.push_back(p + shift);
    for (Triangle t : part.triangles) {
        if (is_turned) std::swap(t[0], t[1]);
        mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
}

double volume(const SurfaceMesh& mesh) { return enclosed_volume(mesh.points, mesh.triangles); }

TetMesh lattice_of(const SurfaceMesh& mesh, Fill fill, double size, std::vector<double> refinement = {}) {
    LatticeOptions options;
    options.tet_size = size;
    options.least_coverage = 0;
    options.fill = fill;
    options.refinement = std::move(refinement);
    return make_lattice(mesh.points, mesh.triangles, options);
}

std::string failure(const SurfaceMesh& mesh, Fill fill) {
    try {
        lattice_of(mesh, fill, 0.5);
    } catch (const Error& e) {
        return e.code + ": " + e.what();
    }
    return "none";
}

const SurfaceMesh outer = make_sphere(1, 24, 24), inner = make_sphere(0.5, 16, 16), island = make_sphere(0.2, 10, 10);

} // namespace

TEST_CASE("a sphere with a cavity in all fill modes, whichever way the cavity is turned", "[fill]") {
    for (bool is_turned : {false, true})
        for (double levels : {0.0, 1.0}) {
            SurfaceMesh mesh;
            append(mesh, outer, Vec3::Zero(), false);
            append(mesh, inner, Vec3(0.1, 0, 0.05), is_turned);
            CAPTURE(is_turned, levels);
            const TetMesh filled = lattice_of(mesh, Fill::filled_cavities, 0.21, {levels});
            const TetMesh empty = lattice_of(mesh, Fill::empty_cavities, 0.21, {levels});
            const TetMesh shell = lattice_of(mesh, Fill::surface_only, 0.21, {levels});
            for (const TetMesh* lattice : {&filled, &empty, &shell}) require_sound(*lattice);
            REQUIRE(covered_volume(filled) == Approx(volume(outer)).epsilon(1e-9));
            REQUIRE(covered_volume(empty) == Approx(volume(outer) - volume(inner)).epsilon(1e-9));
            // The shell is made of the tets through which the two surfaces pass, and of no others.
            const SurfaceTree tree(mesh.points, mesh.triangles);
            std::size_t passed = 0;
            for (std::size_t t = 0; t < empty.tets.size(); ++t) passed += empty.coverage[t] < 1;
            REQUIRE(shell.tets.size() >= passed);
            REQUIRE(shell.tets.size() < passed * 11 / 10);
            for (std::size_t t = 0; t < shell.tets.size(); ++t) {
                const auto c = corners_of(shell, t);
                REQUIRE(tree.closest((c[0] + c[1] + c[2] + c[3]) / 4, longest_edge(c)).triangle >= 0);
            }
            REQUIRE(shell.tets.size() < empty.tets.size());
            const std::vector<double> outside = widths_outside(shell, embed(shell, mesh.points));
            REQUIRE(*std::max_element(outside.begin(), outside.end()) < 1e-9);
        }
}

TEST_CASE("solids and cavities alternate inwards, whatever way they are turned", "[fill]") {
    for (int turned = 0; turned < 8; ++turned) {
        SurfaceMesh mesh;
        append(mesh, outer, Vec3::Zero(), turned & 1);
        append(mesh, inner, Vec3::Zero(), turned & 2);
        append(mesh, island, Vec3(0.1, 0.1, 0), turned & 4);
        CAPTURE(turned);
        REQUIRE(covered_volume(lattice_of(mesh, Fill::empty_cavities, 0.25)) ==
                Approx(volume(outer) - volume(inner) + volume(island)).epsilon(1e-9));
        REQUIRE(covered_volume(lattice_of(mesh, Fill::filled_cavities, 0.25)) == Approx(volume(outer)).epsilon(1e-9));
    }
}

TEST_CASE("two cavities side by side are both empty, parts that cross are none", "[fill]") {
    SurfaceMesh two;
    append(two, outer, Vec3::Zero(), false);
    append(two, island, Vec3(-0.4, 0, 0), false);
    append(two, island, Vec3(0.4, 0, 0), true);
    REQUIRE(covered_volume(lattice_of(two, Fill::empty_cavities, 0.3)) ==
            Approx(volume(outer) - 2 * volume(island)).epsilon(1e-9));
    SurfaceMesh crossing;
    append(crossing, outer, Vec3::Zero(), false);
    append(crossing, inner, Vec3(0.9, 0, 0), false);
    const TetMesh filled = lattice_of(crossing, Fill::filled_cavities, 0.3);
    REQUIRE(lattice_of(crossing, Fill::empty_cavities, 0.3).coverage == filled.coverage);
    REQUIRE(covered_volume(filled) > volume(outer) + 0.3 * volume(inner));
    // The same surface twice, cut into other triangles, is one solid and no cavity.
    SurfaceMesh twice;
    append(twice, make_cube(1, 1, 1, 1, 1, 1), Vec3::Zero(), false);
    append(twice, make_cube(1, 1, 1, 3, 3, 3), Vec3::Zero(), false);
    for (Fill fill : {Fill::filled_cavities, Fill::empty_cavities})
        REQUIRE(covered_volume(lattice_of(twice, fill, 0.3)) == Approx(1).epsilon(1e-6));
}

TEST_CASE("empty cavities refuse a mesh with holes and say where, the others close them", "[fill]") {
    SurfaceMesh mesh = make_sphere(1, 24, 24);
    const Triangle removed = mesh.triangles[300];
    mesh.triangles.erase(mesh.triangles.begin() + 300);
    const std::string message = failure(mesh, Fill::empty_cavities);
    CAPTURE(message, removed[0], removed[1], removed[2]);
    REQUIRE(message.rfind("FE220: empty cavities need a watertight mesh; this one has 3 border edges", 0) == 0);
    int named = 0;
    for (std::size_t k = 0; k < 3; ++k)
        named +=
            message.find(std::to_string(removed[(k + 1) % 3]) + "-" + std::to_string(removed[k])) != std::string::npos;
    REQUIRE(named == 3);
    REQUIRE(failure(mesh, Fill::filled_cavities) == "none");
    REQUIRE(failure(mesh, Fill::surface_only) == "none");
    REQUIRE(covered_volume(lattice_of(mesh, Fill::filled_cavities, 0.4)) == Approx(volume(outer)).epsilon(1e-2));
    // Vertices doubled along a seam open nothing.
    SurfaceMesh seams;
    for (const Triangle& t : outer.triangles) {
        const int n = static_cast<int>(seams.points.size());
        for (int v : t) seams.points.push_back(outer.points[at(v)]);
        seams.triangles.push_back({n, n + 1, n + 2});
    }
    REQUIRE(failure(seams, Fill::empty_cavities) == "none");
}

TEST_CASE("a cavity inside a surface with a large hole is filled", "[fill]") {
    SurfaceMesh mesh;
    for (const Triangle& t : outer.triangles)
        if (outer.points[at(t[0])].y() + outer.points[at(t[1])].y() + outer.points[at(t[2])].y() < 1.8)
            mesh.triangles.push_back(t);
    mesh.points = outer.points;
    const double open = covered_volume(lattice_of(mesh, Fill::filled_cavities, 0.4));
    append(mesh, island, Vec3(0, -0.3, 0), true);
    REQUIRE(covered_volume(lattice_of(mesh, Fill::filled_cavities, 0.4)) == Approx(open).epsilon(1e-6));
}
