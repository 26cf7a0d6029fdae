// Tet mesh files: what comes back from the writers, and what the readers say of what they refuse.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/mesh_readers.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace sinew::solver;

namespace {

TetMesh two_tets() {
    TetMesh m;
    m.vertices = {{0.1, 1.0 / 3, -0.0}, {1e-17, 2e200, 0}, {0, 1, M_PI}, {-7, 0.3, 1}, {1, 1, 1e-300}};
    m.vertices[1] = {1, 0.25, 1e-17};
    m.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
    check_and_orient(m);
    return m;
}

std::string problem(const std::string& bytes, const std::string& file, const std::string& code = "IO403") {
    try {
        parse_tets(bytes, file);
    } catch (const Error& e) {
        CHECK(e.code == code);
        CHECK(std::string(e.what()).find(file) == 0);
        return e.what();
    }
    return "no problem";
}

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::string v2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n",
                  nodes2 = "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";

std::string elements2(const std::string& lines, int count = 1) {
    return v2 + nodes2 + "$Elements\n" + std::to_string(count) + "\n" + lines + "$EndElements\n";
}

} // namespace

TEST_CASE("every tet writer's file reads back to the same bits", "[mesh][files]") {
    const TetMesh mesh = two_tets();
    const auto same = [&](const TetMesh& back) {
        CHECK(back.vertices == mesh.vertices);
        CHECK(back.tets == mesh.tets);
    };
    same(parse_tets(write_vtk(mesh), "a.vtk"));
    same(parse_tets(write_medit(mesh), "a.mesh"));
    same(parse_tets(write_gmsh(mesh), "a.msh"));
    same(parse_tets(write_veg(mesh), "a.veg"));
    same(read_tetgen(write_node(mesh), "a.node", write_ele(mesh), "a.ele"));
}

TEST_CASE("TetGen's files are found beside each other", "[mesh][files]") {
    namespace fs = std::filesystem;
    const fs::path folder = fs::temp_directory_path() / ("sinew_tetgen_" + std::to_string(::getpid()));
    fs::create_directories(folder);
    const std::string node = (folder / "a.node").string(), ele = (folder / "a.ele").string();
    const TetMesh mesh = two_tets();
    std::ofstream(node) << write_node(mesh);
    CHECK_THROWS_AS(read_tets(node), Error); // no .ele yet
    std::ofstream(ele) << "# a comment\n" << write_ele(mesh);
    CHECK(read_tets(node).tets == mesh.tets);
    CHECK(read_tets(ele).tets == mesh.tets);
    fs::remove_all(folder);
    CHECK(says(problem("", "a.node", "IO404"), "two files"));
}

TEST_CASE("TetGen: attributes and markers are passed over, numbers begin anywhere", "[mesh][files]") {
    const TetMesh m = read_tetgen("4 3 2 1\n5 0 0 0 9 9 1 # c\n6 1 0 0 9 9 1\n7 0 1 0 8 8 0\n8 0 0 1 7 7 0\n", "a.node",
                                  "1 4 1\n5 5 6 7 8 3.5\n", "a.ele");
    CHECK(m.vertices.size() == 4);
    CHECK(m.tets == std::vector<Tet>{{0, 1, 2, 3}});
    const auto refused = [](const std::string& node, const std::string& ele) {
        try {
            read_tetgen(node, "a.node", ele, "a.ele");
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("no problem");
    };
    const std::string four = "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n";
    CHECK(refused(four, "1 4 0\n0 0 1 2 3\n") == "no problem");
    CHECK(says(refused("3 2 0 0\n", "1 4 0\n0 0 1 2 3\n"), "a.node:1: the vertices have dimension 2"));
    CHECK(says(refused(four, "1 10 0\n"), "a.ele:1: tets with 10 corners"));
    CHECK(says(refused(four, "1 4 0\n0 0 1 2 9\n"), "tet 0 uses vertex 9"));
    CHECK(says(refused(four, "2 4 0\n0 0 1 2 3\n"), "a.ele"));
    CHECK(says(refused("4 3 0 0\n0 0 0 0\n0 1 0 0\n2 0 1 0\n3 0 0 1\n", "1 4 0\n0 0 1 2 3\n"),
               "a.node:3: vertex 0 appears twice"));
}

TEST_CASE("Gmsh: faces and lines are left out, other solids and broken files are refused with the line",
          "[mesh][files]") {
    CHECK(parse_tets(elements2("1 15 2 0 0 1\n2 1 2 0 0 1 2\n3 2 2 0 0 1 2 3\n4 4 2 0 0 1 2 3 4\n", 4), "a.msh")
              .tets.size() == 1);
    CHECK(says(problem(elements2("1 11 2 0 0 1 2 3 4 1 2 3 4 1 2\n"), "a.msh"),
               "a.msh:13: elements of type 11 cannot be used"));
    CHECK(says(problem(elements2("1 77 0\n"), "a.msh"), "type 77 are not known"));
    CHECK(says(problem(elements2("1 4 2 0 0 1 2 3 9\n"), "a.msh", "FE203"), "a.msh:13: tet 0 uses node 9"));
    CHECK(says(problem(elements2("1 4 2 0 0 1 2 3 4\n", 2), "a.msh"), "'$EndElements' is not a whole number"));
    CHECK(says(problem(elements2("1 4 2 0 0 1 2 3 4\n2 4 2 0 0 1 2 3 4\n", 1), "a.msh"),
               "'2' stands where $EndElements should"));
    CHECK(says(problem(v2 + nodes2, "a.msh"), "the file has no elements"));
    CHECK(says(problem(v2 + nodes2 + nodes2, "a.msh"), "the nodes appear twice"));
    CHECK(says(problem(v2 + "$Nodes\n2\n1 0 0 0\n1 1 0 0\n", "a.msh"), "node 1 appears twice"));
    CHECK(says(problem("$MeshFormat\n4 0 8\n$EndMeshFormat\n", "a.msh"), "save it as 2.2 or 4.1"));
    CHECK(says(problem("$MeshFormat\n4.1 0 4\n$EndMeshFormat\n", "a.msh"), "numbers of 4 bytes"));
    CHECK(says(problem("$MeshFormat\n4.1 1 8\n????\n$EndMeshFormat\n", "a.msh"), "order of bytes"));
    CHECK(says(problem("solid\n", "a.msh"), "begins neither"));
    CHECK(says(problem(v2 + "$Nodes\n1\n1 0 0 nan\n", "a.msh", "FE202"), "not finite"));
    CHECK(says(problem(elements2("1 4 2 0 0 1 2 3 3\n"), "a.msh", "FE215"), "no volume"));
}

TEST_CASE("VegaFEM: sections in any order, others are passed over, hexahedra and includes refused", "[mesh][files]") {
    const std::string vertices = "*VERTICES\n4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n",
                      tets = "*ELEMENTS\nTET\n1 4 0\n0 0 1 2 3\n";
    CHECK(parse_tets(vertices + "*SET s\n1, 2\n" + tets, "a.veg").tets == std::vector<Tet>{{0, 1, 2, 3}});
    CHECK(parse_tets(tets + vertices, "a.veg").tets.size() == 1);
    CHECK(says(problem(vertices + "*ELEMENTS\nCUBIC\n1 8 0\n", "a.veg"), "a.veg:8: elements 'CUBIC'"));
    CHECK(says(problem("*INCLUDE b.veg\n", "a.veg"), "a.veg:1: *INCLUDE"));
    CHECK(says(problem(vertices, "a.veg"), "no *ELEMENTS"));
    CHECK(says(problem(tets, "a.veg"), "no *VERTICES"));
    CHECK(says(problem(vertices + vertices, "a.veg"), "twice"));
    CHECK(says(problem("hello\n", "a.veg"), "'hello' stands where a section"));
}

TEST_CASE("the share of each tet that is solid survives a VTK file", "[mesh][files]") {
    TetMesh mesh = two_tets();
    mesh.coverage = {1.0 / 3, 1e-3};
    const std::string text = write_vtk(mesh);
    CHECK(parse_tets(text, "a.vtk").coverage == mesh.coverage);

    // Beside other cells and other data, in either place that programs keep it in.
    const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
                             "0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 2 9\n3 0 1 2\n4 0 1 2 3\nCELL_TYPES 2\n5\n10\n";
    const std::string other = "SCALARS part int\nLOOKUP_TABLE default\n7 8\n",
                      points = "POINT_DATA 4\nSCALARS coverage float 1\nLOOKUP_TABLE default\n9 9 9 9\n";
    const auto coverage = [&](const std::string& data) { return parse_tets(head + data, "a.vtk").coverage; };
    CHECK(coverage("") == std::vector<double>{1});
    CHECK(coverage(points) == std::vector<double>{1});
    CHECK(coverage(points + "CELL_DATA 2\n" + other + "SCALARS coverage double\nLOOKUP_TABLE default\n0 0.25\n") ==
          std::vector<double>{0.25});
    CHECK(coverage("CELL_DATA 2\n" + other + "FIELD FieldData 2\npart 1 2 int\n1 1\ncoverage 1 2 double\n0 0.5\n" +
                   points) == std::vector<double>{0.5});
    CHECK(says(problem(head + "CELL_DATA 2\nSCALARS coverage double 1\nLOOKUP_TABLE default\n1 0\n", "a.vtk"),
               "a.vtk:16: the coverage of cell 1 is 0"));
    CHECK(says(problem(head + "CELL_DATA 3\nSCALARS coverage double 1\nLOOKUP_TABLE default\n1 1 1\n", "a.vtk"),
               "3 cells for 2"));
}

TEST_CASE("a vertex that does not exist is named in the file's own numbers, with the line", "[mesh][files]") {
    const std::string head = "MeshVersionFormatted 2\nDimension 3\n",
                      points = "Vertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n",
                      tets = "Tetrahedra\n2\n1 2 3 4 0\n1 2 3 9 0\n";
    const char* wanted = "tet 1 uses vertex 9; the file has 4 vertices, numbered from 1";
    CHECK(says(problem(head + points + tets + "End\n", "a.mesh", "FE203"), std::string("a.mesh:12: ") + wanted));
    CHECK(says(problem(head + tets + points + "End\n", "a.mesh", "FE203"), std::string("a.mesh:6: ") + wanted));
    const std::string grid = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
                             "0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 4\nCELL_TYPES 1\n10\n";
    CHECK(says(problem(grid, "a.vtk", "FE203"),
               "a.vtk:8: cell 0 uses vertex 4; the file has 4 vertices, numbered from 0"));
    CHECK(says(problem("*VERTICES\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n*ELEMENTS\nTET\n1 4 0\n1 1 2 3 9\n",
                       "a.veg", "FE203"),
               "a.veg:10: tet 0 uses vertex 9"));
}
