// Mesh files: what each reader accepts, exactly, and what it says about what it refuses.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/primitives.h"

#include <catch2/catch.hpp>

#include <clocale>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace sinew::solver;

namespace {

struct Refusal {
    std::string code, message;
    bool says(const std::string& part) const { return message.find(part) != std::string::npos; }
};

Refusal refusal(const std::string& bytes, const std::string& file) {
    try {
        const std::string ending = std::filesystem::path(file).extension().string();
        if (ending == ".mesh" || ending == ".vtk")
            parse_tets(bytes, file);
        else
            parse_surface(bytes, file);
    } catch (const Error& e) {
        return {e.code, e.what()};
    }
    return {"none", ""};
}

void require_same(const SurfaceMesh& a, const SurfaceMesh& b) {
    REQUIRE(a.points == b.points);
    REQUIRE(a.face_sizes == b.face_sizes);
    REQUIRE(a.face_vertices == b.face_vertices);
    REQUIRE(a.triangles == b.triangles);
}

template <class T>
void put(std::string& out, T value, bool big) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    for (std::size_t i = 0; i < sizeof value; ++i) out += raw[big ? sizeof value - 1 - i : i];
}

const std::string header_vtk = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n";
const std::string points_vtk = "POINTS 5 double\n0 0 0  1 0 0  0 1 0\n0 0 1  1 1 1\n";

} // namespace

TEST_CASE("OBJ: slashes, negative numbers, n-gons, groups, continuation, CRLF and colours are read", "[mesh][files]") {
    const std::string text = "# a comment\r\nmtllib x.mtl\r\no thing\r\ng a b\r\ns off\r\n"
                             "v 0 0 0\r\nv +1.5 0 0 0.1 0.2 0.3\r\nv 1 1e0 .0\r\nv 0 1 0\r\nv -1 0.5 -0\r\n"
                             "vn 0 0 1\r\nvt 0 0\r\nusemtl m\r\n"
                             "f 1 2/1 3/1/1 4//1 -1\r\n"
                             "f -5 -4 \\\r\n -3 # tail\r\n"
                             "l 1 2\r\nv 9 9 9\r\n";
    const SurfaceMesh mesh = parse_surface(text, "a.obj");
    REQUIRE(mesh.points.size() == 6);
    REQUIRE(mesh.points[1] == Vec3(1.5, 0, 0));
    REQUIRE(mesh.face_sizes == std::vector<int>{5, 3});
    REQUIRE(mesh.face_vertices == std::vector<int>{0, 1, 2, 3, 4, 0, 1, 2});
    REQUIRE(mesh.triangles.size() == 4);
    // The same with lone line feeds, carriage returns and no end of line at the end.
    for (const char* end : {"\n", "\r"}) {
        std::string other;
        for (char c : text)
            if (c == '\r')
                other += end;
            else if (c != '\n')
                other += c;
        other.pop_back();
        require_same(parse_surface(other, "a.OBJ"), mesh);
    }
}

TEST_CASE("OBJ: faces may stand before their vertices", "[mesh][files]") {
    REQUIRE(parse_surface("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", "a.obj").triangles.size() == 1);
}

TEST_CASE("OBJ: refusals name the line and what is wrong", "[mesh][files]") {
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    REQUIRE(refusal(three + "f 1 2\n", "a.obj").says("a.obj:4: a face has 2 corners"));
    REQUIRE(refusal(three + "\nf 1 2 0\n", "a.obj").says("a.obj:5: vertex 0 does not exist"));
    REQUIRE(refusal(three + "f 1 2 -4\n", "a.obj").says("vertex -4 does not exist; 3 are defined"));
    REQUIRE(refusal(three + "f 1 2 99999999999999999999\n", "a.obj").code == "IO403");
    REQUIRE(refusal(three + "f 1 2 9999999999\n", "a.obj").code == "IO403");
    const Refusal high = refusal(three + "f 1 2 3\nf 1 2 4\n", "a.obj");
    REQUIRE(high.code == "FE203");
    REQUIRE(high.says("a.obj:5: a face uses vertex 4 of 3"));
    REQUIRE(refusal("v 0 0\n", "a.obj").says("a.obj:1: vertex 1 has fewer than three"));
    REQUIRE(refusal("v 0 0 zero\n", "a.obj").says("a.obj:1: 'zero' is not a number"));
    REQUIRE(refusal("v 0 0 0x1\n", "a.obj").code == "IO403");
    REQUIRE(refusal("v 0 0 1,5\n", "a.obj").says("'1,5'"));
    REQUIRE(refusal(three + "f 1 2 3\nnonsense 1\n", "a.obj").says("a.obj:5: 'nonsense' is not an OBJ statement"));
    REQUIRE(refusal("", "a.obj").code == "FE201");
    REQUIRE(refusal(three, "a.obj").code == "FE201");
    for (const char* number : {"nan", "inf", "-inf", "1e999", "NAN"}) {
        const Refusal r = refusal(three + "v 0 " + number + " 0\nf 1 2 3\n", "a.obj");
        INFO(number << ": " << r.code << " " << r.message);
        REQUIRE(r.code == "FE202");
        REQUIRE(r.says("a.obj:4:"));
        REQUIRE(r.says("vertex 4")); // as its faces count
    }
    REQUIRE(parse_surface("v 1e-999 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj").points[0] == Vec3(0, 0, 0));
}

TEST_CASE("OFF: colours and normals are passed over", "[mesh][files]") {
    const SurfaceMesh mesh = parse_surface("COFF # colours\n4 2 0\n0 0 0 255 0 0 255\n1 0 0 1 1 1 1\n\n0 1 "
                                           "0\n0 0 1\n3 0 1 2 0.5 0.5 0.5\n4 0 1 2 3\n",
                                           "a.off");
    REQUIRE(mesh.points.size() == 4);
    REQUIRE(mesh.face_sizes == std::vector<int>{3, 4});
    REQUIRE(parse_surface("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a.off").triangles.size() == 1);
    REQUIRE(refusal("3 1 0\n", "a.off").says("does not begin with OFF"));
    REQUIRE(refusal("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off").says("a.off:6: face 0 uses vertex 3 of 3"));
    REQUIRE(refusal("OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", "a.off").code == "FE202");
    REQUIRE(refusal("OFF\n3000000000 1 0\n", "a.off").says("more than the rest of the file can hold"));
    REQUIRE(refusal("OFF\n-3 1 0\n", "a.off").says("negative"));
    REQUIRE(refusal("OFF BINARY\n", "a.off").says("binary OFF"));
    REQUIRE(refusal("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "a.off").says("face 0 has 2 corners"));
}

TEST_CASE("PLY: ascii and both binary orders with further properties give the same mesh", "[mesh][files]") {
    const auto header = [](const std::string& encoding) {
        return "ply\nformat " + encoding +
               " 1.0\ncomment hello\nobj_info x\nelement camera 1\nproperty float f\nproperty list uchar "
               "short l\n"
               "element vertex 4\nproperty uchar red\nproperty double x\nproperty float y\nproperty int16 z\n"
               "property list uint16 float32 uv\nelement face 2\nproperty list uint8 uint vertex_index\n"
               "property int flags\nend_header\n";
    };
    const double x[4] = {0, 1.25, 1, 0.1}, y[4] = {0, 0, 1, 1}, z[4] = {0, 2, -3, 4};
    const std::vector<std::vector<unsigned>> faces{{0, 1, 2, 3}, {0, 1, 2}};
    std::string ascii = header("ascii") + "1.5 2 7 8\n";
    for (int i = 0; i < 4; ++i) {
        char line[100];
        std::snprintf(line, sizeof line, "255 %.17g %g %g 1 0.5\n", x[i], y[i], z[i]);
        ascii += line;
    }
    ascii += "4 0 1 2 3 9\n3 0 1 2 9\n";
    const SurfaceMesh expected = parse_surface(ascii, "a.ply");
    REQUIRE(expected.points[1] == Vec3(1.25, 0, 2));
    REQUIRE(expected.face_sizes == std::vector<int>{4, 3});
    for (bool big : {false, true}) {
        std::string bytes = header(big ? "binary_big_endian" : "binary_little_endian");
        put(bytes, 1.5f, big), put(bytes, std::uint8_t{2}, big), put(bytes, std::int16_t{7}, big),
            put(bytes, std::int16_t{8}, big);
        for (int i = 0; i < 4; ++i) {
            put(bytes, std::uint8_t{255}, big), put(bytes, x[i], big), put(bytes, static_cast<float>(y[i]), big);
            put(bytes, static_cast<std::int16_t>(z[i]), big), put(bytes, std::uint16_t{1}, big), put(bytes, 0.5f, big);
        }
        for (const auto& face : faces) {
            put(bytes, static_cast<std::uint8_t>(face.size()), big);
            for (unsigned v : face) put(bytes, static_cast<std::uint32_t>(v), big);
            put(bytes, std::int32_t{9}, big);
        }
        require_same(parse_surface(bytes, "a.ply"), expected);
        const Refusal cut = refusal(bytes.substr(0, bytes.size() - 1), "a.ply");
        REQUIRE(cut.code == "IO403");
        REQUIRE(cut.says("face 1"));
    }
}

TEST_CASE("PLY: strips of triangles", "[mesh][files]") {
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
                             "property float z\nelement tristrips 2\nproperty list int int vertex_indices\nend_header\n"
                             "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n";
    // Two strips that fill a rectangle, all facing +z; the second list holds two, one with repeated vertices.
    const SurfaceMesh mesh = parse_surface(head + "4 0 1 2 3\n9 2 3 4 -1 3 3 4 5 5\n", "a.ply");
    REQUIRE(mesh.face_sizes == std::vector<int>{3, 3, 3, 3});
    REQUIRE(mesh.face_vertices == std::vector<int>{0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5});
    double area = 0;
    for (const Triangle& t : mesh.triangles) {
        const auto at = [&](int k) { return mesh.points[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])]; };
        const Vec3 twice = (at(1) - at(0)).cross(at(2) - at(0));
        REQUIRE(twice.z() == 1);
        area += twice.z() / 2;
    }
    REQUIRE(area == 2); // of the rectangle
    REQUIRE(refusal(head + "3 0 1 -2\n3 0 1 2\n", "a.ply").says("strip 0 is not a whole number from -1"));
    REQUIRE(refusal(head + "3 0 1 7\n3 0 1 2\n", "a.ply").code == "FE203");
}

TEST_CASE("a byte order mark or blank lines in front are passed over", "[mesh][files]") {
    const SurfaceMesh mesh = make_cylinder(1, 2, 6, 1, 0);
    const std::string mark = "\xEF\xBB\xBF";
    require_same(parse_surface(mark + write_obj(mesh), "a.obj"), mesh);
    require_same(parse_surface(mark + write_off(mesh), "a.off"), mesh);
    require_same(parse_surface("\n \r\n" + write_off(mesh), "a.off"), mesh);
    const std::string triangle = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    REQUIRE(refusal(mark + triangle, "a.ply").code == "none");
    REQUIRE(refusal(mark + "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                           "endloop\nendfacet\nendsolid a\n",
                    "a.stl")
                .code == "none");
}

TEST_CASE("PLY: refusals say what is missing", "[mesh][files]") {
    const std::string begin = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n";
    const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    REQUIRE(refusal("plyx\n", "a.ply").says("does not begin with ply"));
    REQUIRE(refusal("ply\nelement vertex 1\nproperty float x\nend_header\n", "a.ply").says("no format"));
    REQUIRE(refusal(begin + faces, "a.ply").says("one property z"));
    REQUIRE(refusal(begin + "property float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n", "a.ply").code == "FE201");
    const std::string good = begin + "property float z\n" + faces + "0 0 0\n1 0 0\n0 1 0\n";
    REQUIRE(refusal(good + "3 0 1 2\n", "a.ply").code == "none");
    REQUIRE(refusal(good + "3 0 1 3\n", "a.ply").code == "FE203");
    REQUIRE(refusal(good + "3 0 1 -1\n", "a.ply").says("not a whole number"));
    REQUIRE(refusal(good + "3 0 1 0.5\n", "a.ply").says("not a whole number"));
    REQUIRE(refusal(good + "2 0 1\n", "a.ply").says("face 0 has 2 corners"));
    REQUIRE(refusal(good + "250 0 1\n", "a.ply").code == "IO403");
    REQUIRE(refusal(begin + "property float z\nproperty nibble q\n" + faces, "a.ply").says("'nibble'"));
    REQUIRE(refusal("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\n", "a.ply").says("more than"));
    REQUIRE(refusal("ply\nformat ascii 1.0\nproperty float x\n", "a.ply").says("before the first element"));
    REQUIRE(refusal("ply\nformat ascii 1.0\n", "a.ply").says("no end_header"));
}

TEST_CASE("STL: ascii and binary are welded to the same mesh", "[mesh][files]") {
    std::string ascii = "solid a name\n";
    const SurfaceMesh cube = make_cube(1, 1, 1, 1, 1, 1);
    for (const Triangle& t : cube.triangles) {
        ascii += " facet normal nan nan nan\n  outer loop\n";
        for (int v : t) {
            char line[100];
            const Vec3& p = cube.points[static_cast<std::size_t>(v)];
            std::snprintf(line, sizeof line, "   vertex %g %g %g\n", p[0], p[1], p[2]);
            ascii += line;
        }
        ascii += "  endloop\n endfacet\n";
    }
    ascii += "endsolid a name\n";
    const SurfaceMesh from_ascii = parse_surface(ascii, "a.stl");
    REQUIRE(from_ascii.points.size() == 8);
    REQUIRE(is_closed(from_ascii.triangles));
    REQUIRE(enclosed_volume(from_ascii.points, from_ascii.triangles) == Approx(1));
    const std::string binary = write_stl(cube);
    REQUIRE(binary.size() == 84 + 50 * 12);
    require_same(parse_surface(binary, "a.stl"), from_ascii);
    // Binary files whose header begins with "solid" exist.
    std::string solid = binary;
    solid.replace(0, 5, "solid");
    require_same(parse_surface(solid, "a.stl"), from_ascii);
    REQUIRE(refusal(binary.substr(0, 300), "a.stl").says("12 triangles announced"));
    REQUIRE(refusal("", "a.stl").code == "IO403");
    REQUIRE(refusal("solid x\nendsolid\n", "a.stl").code == "FE201");
    REQUIRE(refusal("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\n", "a.stl").code == "FE202");
    REQUIRE(refusal("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n", "a.stl")
                .says("a.stl:5: 'endloop'"));
    std::string infinite = binary;
    infinite[84 + 15] = '\x7f', infinite[84 + 14] = '\x80';
    REQUIRE(refusal(infinite, "a.stl").code == "FE202");
}

TEST_CASE("STL: binary files with something behind their triangles are read, down to a single one", "[mesh][files]") {
    const SurfaceMesh one = SurfaceMesh::from_triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    const std::string binary = write_stl(one);
    REQUIRE(binary.size() == 84 + 50);
    require_same(parse_surface(binary + "some more", "a.stl"), one);
}

TEST_CASE("STL: zero and minus zero are one place", "[mesh][files]") {
    const std::string facet =
        "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n"
        "facet normal 0 0 0 outer loop vertex -0 0 -0 vertex 0 1 0 vertex -1 0 0 endloop endfacet\n";
    REQUIRE(parse_surface("solid\n" + facet + "endsolid\n", "a.stl").points.size() == 4);
}

TEST_CASE("Medit: other entities are passed over, numbers begin at 1", "[mesh][files]") {
    const std::string text =
        "MeshVersionFormatted 2\n# comment\nDimension\n3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 0\n0 0 1 0\n"
        "Corners 1\n1\nTriangles\n1\n1 2 3 0\nTetrahedra 1\n1 3 2 4 7\nRequiredVertices 0\nEnd\njunk";
    const TetMesh mesh = parse_tets(text, "a.mesh");
    REQUIRE(mesh.vertices.size() == 4);
    REQUIRE(mesh.tets == std::vector<Tet>{{0, 2, 3, 1}}); // turned to positive volume
    REQUIRE(mesh.coverage == std::vector<double>{1});
    REQUIRE(refusal("MeshVersionFormatted 2\nDimension 2\n", "a.mesh").says("dimension 2"));
    REQUIRE(refusal("\x01\x02", "a.mesh").says("MeshVersionFormatted"));
    REQUIRE(refusal("MeshVersionFormatted 1\nVertices 1\n0 0 0 0\nTetrahedra 1\n0 1 1 1 0\n", "a.mesh")
                .says("tet 0 uses vertex 0"));
    REQUIRE(refusal("MeshVersionFormatted 1\nVertices 1\n0 0 0 0\nTetrahedra 1\n1 1 1 2 0\n", "a.mesh").code ==
            "FE203");
    REQUIRE(refusal("MeshVersionFormatted 1\nVertices 1\n0 0 0 0\nTetrahedra 1\n1 1 1 1 0\n", "a.mesh").code ==
            "FE215");
    REQUIRE(refusal("MeshVersionFormatted 1\nVertices 1\n0 nan 0 0\n", "a.mesh").code == "FE202");
    REQUIRE(refusal("MeshVersionFormatted 1\nHexahedra 1\n", "a.mesh").says("only linear"));
    REQUIRE(refusal("MeshVersionFormatted 1\nVertices 12345678901\n", "a.mesh").says("more than"));
    REQUIRE(refusal("MeshVersionFormatted 1\nEnd\n", "a.mesh").code == "FE201");
}

TEST_CASE("the square beam of the public test set is read in full", "[mesh][files]") {
    const TetMesh beam = read_tets(SINEW_SOURCE_DIR "/tests/solver/mesh/data/square_beam.mesh");
    REQUIRE(beam.vertices.size() == 739);
    REQUIRE(beam.tets.size() == 2886);
    double volume = 0;
    for (const Tet& t : beam.tets) {
        const auto v = [&](std::size_t k) { return beam.vertices[static_cast<std::size_t>(t[k])]; };
        const double one = tet_volume(v(0), v(1), v(2), v(3));
        REQUIRE(one > 0);
        volume += one;
    }
    REQUIRE(volume == Approx(20 * 20 * 100).epsilon(1e-12));
    // Its border is the surface of the box.
    const std::vector<Triangle> border = boundary_triangles(beam.tets);
    REQUIRE(is_closed(border));
    REQUIRE(enclosed_volume(beam.vertices, border) == Approx(volume).epsilon(1e-12));
}

TEST_CASE("VTK: both kinds of cell lists give the same tets, other cells are passed over", "[mesh][files]") {
    const std::string old_style = header_vtk + points_vtk +
                                  "CELLS 3 14\n4 0 1 2 3\n3 0 1 2\n4 1 2 3 4\nCELL_TYPES 3\n10\n5\n10\n"
                                  "CELL_DATA 3\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3\n";
    const TetMesh mesh = parse_tets(old_style, "a.vtk");
    REQUIRE(mesh.tets.size() == 2);
    REQUIRE(mesh.tets[0] == Tet{0, 1, 2, 3});
    const std::string new_style = "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n" + points_vtk +
                                  "METADATA\nINFORMATION 0\n\nCELLS 4 11\nOFFSETS vtktypeint64\n0 4 7 11\n"
                                  "CONNECTIVITY vtktypeint64\n0 1 2 3 0 1 2 1 2 3 4\nCELL_TYPES 3\n10 5 10\n";
    REQUIRE(parse_tets(new_style, "a.vtk").tets == mesh.tets);
    REQUIRE(refusal(header_vtk + points_vtk + "CELLS 1 5\n4 0 1 2 5\nCELL_TYPES 1\n10\n", "a.vtk").code == "FE203");
    REQUIRE(refusal(header_vtk + points_vtk + "CELLS 1 6\n4 0 1 2 3\nCELL_TYPES 1\n10\n", "a.vtk").says("announces 6"));
    REQUIRE(refusal(header_vtk + points_vtk + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n12\n", "a.vtk").says("type 12"));
    REQUIRE(refusal(header_vtk + points_vtk + "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n", "a.vtk").says("tet with 3"));
    REQUIRE(
        refusal(header_vtk + points_vtk + "CELL_TYPES 0\nCELLS 1 5\n4 0 1 2 3\n", "a.vtk").says("0 cell types for 1"));
    REQUIRE(refusal(header_vtk + points_vtk + "CELLS 1 5\n4 0 1 2 3\n", "a.vtk").code == "IO403");
    REQUIRE(refusal(header_vtk + points_vtk + "CELLS 1 5\n4 0 1 2 -3\n", "a.vtk").says("vertex -3"));
    REQUIRE(refusal(header_vtk + points_vtk + "CELLS 3 4\nOFFSETS int\n0 9 4\n", "a.vtk").says("offset 9"));
    REQUIRE(refusal("# vtk DataFile Version 3.0\nt\nBINARY\n", "a.vtk").says("not ASCII"));
    REQUIRE(refusal("<VTKFile/>", "a.vtk").says("XML"));
    REQUIRE(refusal(header_vtk + "POINTS 99999999 double\n", "a.vtk").says("more than"));
}

TEST_CASE("what is written reads back to the same bits", "[mesh][files]") {
    SurfaceMesh mesh = make_cylinder(0.1, 1.0 / 3, 20, 3, 0); // with 20-gons
    for (Vec3& p : mesh.points) p += Vec3(1e-7, 123456.789, -1e5 / 3);
    require_same(parse_surface(write_obj(mesh), "a.obj"), mesh);
    require_same(parse_surface(write_off(mesh), "a.off"), mesh);
    require_same(parse_surface(write_ply(mesh), "a.ply"), mesh);
    const SurfaceMesh many = make_cylinder(1, 1, 300, 1, 0); // faces too large for a byte
    require_same(parse_surface(write_ply(many), "a.ply"), many);
    TetMesh tets;
    tets.vertices = {{0, 0, 0}, {1.0 / 3, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e5}};
    tets.tets = {{0, 1, 2, 3}};
    tets.coverage = {0.5};
    const TetMesh back = parse_tets(write_vtk(tets), "a.vtk");
    REQUIRE(back.vertices == tets.vertices);
    REQUIRE(back.tets == tets.tets);
}

TEST_CASE("numbers do not depend on the locale", "[mesh][files]") {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"}) std::setlocale(LC_ALL, name); // if installed
    const SurfaceMesh mesh = parse_surface("v 0.5 0 0\nv 1.5 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj");
    const std::string text = write_obj(mesh);
    std::setlocale(LC_ALL, before.c_str());
    REQUIRE(mesh.points[0][0] == 0.5);
    REQUIRE(text.find("v 0.5 0 0") == 0);
}

TEST_CASE("missing, unreadable and unknown files have codes of their own", "[mesh][files]") {
    const auto code = [](const std::string& path) {
        try {
            read_surface(path);
        } catch (const Error& e) {
            return e.code;
        }
        return std::string("none");
    };
    const auto folder =
        std::filesystem::temp_directory_path() / ("sinew_mesh_files_test_" + std::to_string(::getpid()) + ".obj");
    std::filesystem::create_directories(folder);
    REQUIRE(code("/nowhere/at/all.obj") == "IO401");
    REQUIRE(code(folder.string()) == "IO402");
    std::filesystem::remove(folder);
    std::ofstream(folder) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    REQUIRE(code(folder.string()) == "none");
    std::filesystem::remove(folder);
    REQUIRE(refusal("", "a.fbx").code == "IO404");
    REQUIRE(refusal("", "noending").code == "IO404");
    try {
        parse_tets("", "a.abc");
        FAIL("not refused");
    } catch (const Error& e) {
        REQUIRE(e.code == "IO404");
    }
}
