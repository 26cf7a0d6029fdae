// Tet meshes: orientation, border, checks.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_boundary.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace sinew::solver;

namespace {

TetMesh one_tet() {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tets = {{0, 1, 2, 3}};
    return mesh;
}

std::string code_of(TetMesh mesh) {
    try {
        check_and_orient(mesh);
    } catch (const Error& e) {
        return e.code;
    }
    return "none";
}

} // namespace

TEST_CASE("a tet has its signed volume", "[mesh]") {
    REQUIRE(tet_volume({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}) == Approx(1.0 / 6));
    REQUIRE(tet_volume({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}) == Approx(-1.0 / 6));
}

TEST_CASE("turned tets are flipped and coverage becomes one", "[mesh]") {
    TetMesh mesh = one_tet();
    std::swap(mesh.tets[0][0], mesh.tets[0][1]);
    check_and_orient(mesh);
    const Tet& t = mesh.tets[0];
    REQUIRE(tet_volume(mesh.vertices[static_cast<std::size_t>(t[0])], mesh.vertices[static_cast<std::size_t>(t[1])],
                       mesh.vertices[static_cast<std::size_t>(t[2])],
                       mesh.vertices[static_cast<std::size_t>(t[3])]) == Approx(1.0 / 6));
    REQUIRE(mesh.coverage == std::vector<double>{1});
}

TEST_CASE("the border of two tets has six outward triangles around their volume", "[mesh]") {
    TetMesh mesh = one_tet();
    mesh.vertices.emplace_back(1, 1, 1);
    mesh.tets.push_back({1, 2, 3, 4});
    check_and_orient(mesh);
    const std::vector<Triangle> border = boundary_triangles(mesh.tets);
    REQUIRE(border.size() == 6);
    REQUIRE(is_closed(border));
    REQUIRE(enclosed_volume(mesh.vertices, border) == Approx(0.5));
    const TetBoundary with_tets = tet_boundary(mesh.tets);
    REQUIRE(with_tets.triangles == border);
    REQUIRE(with_tets.tet == std::vector<int>{0, 0, 0, 1, 1, 1});
}

TEST_CASE("a tet that repeats another is refused, whichever way it is turned", "[mesh]") {
    TetMesh mesh = one_tet();
    mesh.vertices.emplace_back(1, 1, 1);
    mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
    REQUIRE(code_of(mesh) == "none");
    mesh.tets.push_back({3, 1, 0, 2});
    REQUIRE(code_of(mesh) == "FE221");
    try {
        check_and_orient(mesh);
    } catch (const Error& e) {
        REQUIRE(std::string(e.what()).find("tet 2 has the corners of tet 0") == 0);
    }
}

TEST_CASE("unusable tet meshes are refused with their code", "[mesh]") {
    REQUIRE(code_of(one_tet()) == "none");
    REQUIRE(code_of(TetMesh{}) == "FE201");
    TetMesh mesh = one_tet();
    mesh.tets.clear();
    REQUIRE(code_of(mesh) == "FE201");
    mesh = one_tet();
    mesh.vertices[2][1] = std::numeric_limits<double>::infinity();
    REQUIRE(code_of(mesh) == "FE202");
    mesh = one_tet();
    mesh.tets[0][3] = 4;
    REQUIRE(code_of(mesh) == "FE203");
    mesh = one_tet();
    mesh.tets[0][3] = 0;
    REQUIRE(code_of(mesh) == "FE215");
    mesh = one_tet();
    mesh.vertices[3] = {0.3, 0.3, 0};
    REQUIRE(code_of(mesh) == "FE215");
    mesh = one_tet();
    mesh.coverage = {1, 1};
    REQUIRE(code_of(mesh) == "FE204");
}

TEST_CASE("unused vertices are dropped without changing the order of the others", "[mesh]") {
    TetMesh mesh = one_tet();
    mesh.vertices.insert(mesh.vertices.begin() + 1, Vec3(9, 9, 9));
    mesh.tets = {{0, 2, 3, 4}};
    REQUIRE(drop_unused_vertices(mesh) == 1);
    REQUIRE(mesh.vertices == one_tet().vertices);
    REQUIRE(mesh.tets == one_tet().tets);
    REQUIRE(drop_unused_vertices(mesh) == 0);
}
