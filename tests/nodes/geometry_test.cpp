// Mesh sources and writers: what they read, make and refuse.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include "solver/mesh/mesh_files.h"
#include "solver/meshing/self_intersections.h"

using namespace bench;

namespace {

std::string mesh_file(const std::string& path) {
    return R"("m": {"type": "meshFile", "inputs": {"file": ")" + path + R"("}})";
}

} // namespace

TEST_CASE("primitives have Maya's counts and sizes", "[nodes]") {
    Session s(
        R"("sphere": {"type": "polySphere"}, "cube": {"type": "polyCube", "inputs": {"width": 2, "height": 4, "depth": 6}},
                 "plane": {"type": "polyPlane"}, "cylinder": {"type": "polyCylinder"}, "helix": {"type": "polyHelix"})");
    const auto sphere = s.get<nodes::Mesh>("sphere", "outMesh");
    CHECK(sphere.points->size() == 382);
    CHECK(sphere.topology->face_sizes.size() == 400);
    const auto cube = s.get<nodes::Mesh>("cube", "outMesh");
    CHECK(cube.points->size() == 8);
    CHECK(solver::bounding_box(*cube.points).size() == solver::Vec3(2, 4, 6));
    CHECK(solver::bounding_box(*cube.points).centre() == solver::Vec3(0, 0, 0));
    CHECK(s.get<nodes::Mesh>("plane", "outMesh").points->size() == 121);
    CHECK(solver::is_closed(s.get<nodes::Mesh>("cylinder", "outMesh").topology->triangles));
    const auto helix = s.get<nodes::Mesh>("helix", "outMesh");
    CHECK(solver::is_closed(helix.topology->triangles));
    CHECK(solver::self_intersections(*helix.points, helix.topology->triangles).count == 0);
}

TEST_CASE("a mesh file keeps its polygons", "[nodes]") {
    const Folder folder;
    const std::string path = folder.write("quad.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n");
    Session s(mesh_file(path));
    const auto m = s.get<nodes::Mesh>("m", "outMesh");
    CHECK(m.topology->face_sizes == std::vector<int>{4});
    CHECK(m.topology->triangles.size() == 2);
    CHECK((*m.points)[2] == solver::Vec3(2, 2, 0));
}

TEST_CASE("a mesh file that cannot be used says why", "[nodes]") {
    const Folder folder;
    CHECK(codes(mesh_file(folder.path("none.obj")), "m", "outMesh") == Codes{"IO401"});
    CHECK(codes(mesh_file(folder.write("a.xyz", "1 2 3\n")), "m", "outMesh") == Codes{"IO404"});
    CHECK(codes(mesh_file(folder.write("empty.obj", "# nothing\n")), "m", "outMesh") == Codes{"FE201"});
    CHECK(codes(mesh_file(folder.write("nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n")), "m", "outMesh") ==
          Codes{"FE202"});
    CHECK(codes(mesh_file(folder.write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")), "m", "outMesh") ==
          Codes{"FE203"});
    CHECK(codes(R"("m": {"type": "meshFile"})", "m", "outMesh") == Codes{"DG019"});
}

TEST_CASE("a tet mesh file gives tets and their boundary", "[nodes]") {
    const Folder folder;
    const std::string path =
        folder.write("t.mesh", "MeshVersionFormatted 1\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n"
                               "0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 3 2 4 0\nEnd\n");
    Session s(R"("t": {"type": "tetMeshFile", "inputs": {"file": ")" + path + R"("}},
                 "own": {"type": "zTet", "inputs": {"tets": {"from": "t.outTets"}}}, "none": {"type": "zTet"})");
    const auto tets = s.get<nodes::TetMeshValue>("t", "outTets");
    REQUIRE(tets.mesh->tets.size() == 1);
    const solver::Tet& t = tets.mesh->tets.front();
    const auto& x = tets.mesh->vertices;
    CHECK(solver::tet_volume(x[static_cast<std::size_t>(t[0])], x[static_cast<std::size_t>(t[1])],
                             x[static_cast<std::size_t>(t[2])], x[static_cast<std::size_t>(t[3])]) == Approx(1.0 / 6));
    CHECK(s.get<nodes::Mesh>("t", "outMesh").topology->triangles.size() == 4);
    CHECK(s.get<nodes::TetMeshValue>("own", "outTets").digest == tets.digest);
    CHECK(codes([&] { s.pull("none", "outTets"); }) == Codes{"DG110"});
}

TEST_CASE("a lattice has its default size and refuses to grow beyond its limit", "[nodes]") {
    Session s(R"("cube": {"type": "polyCube", "inputs": {"width": 3.5, "height": 3.5, "depth": 3.5}},
                 "a": {"type": "zTet", "inputs": {"mesh": {"from": "cube.outMesh"}}},
                 "b": {"type": "zTet", "inputs": {"mesh": {"from": "cube.outMesh"}, "tetSize": 1}},
                 "c": {"type": "zTet", "inputs": {"mesh": {"from": "cube.outMesh"}, "tetSize": 0.01}})");
    CHECK(s.get<nodes::TetMeshValue>("a", "outTets").digest == s.get<nodes::TetMeshValue>("b", "outTets").digest);
    CHECK(codes([&] { s.pull("c", "outTets"); }) == Codes{"FE210"});
}

TEST_CASE("written meshes read back as they were, each format in its own ending", "[nodes]") {
    const Folder folder;
    for (const std::string format : {"obj", "off", "ply", "stl"}) {
        Session s(
            R"("cube": {"type": "polyCube"}, "w": {"type": "meshWriter", "inputs": {"mesh": {"from": "cube.outMesh"},
                     "format": ")" +
            format + R"("}}, "none": {"type": "meshWriter"})");
        const auto file = s.get<nodes::FileContent>("w", "outFile");
        CHECK(file.ending == format);
        const solver::SurfaceMesh back = solver::read_surface(folder.write("cube." + format, file.bytes));
        CHECK(back.points.size() == 8);
        CHECK(back.face_sizes.size() == (format == "stl" ? 12 : 6));
        CHECK(codes([&] { s.pull("none", "outFile"); }) == Codes{"DG110"});
    }
}

TEST_CASE("several meshes go into one file with their own vertices", "[nodes]") {
    const Folder folder;
    Session s(
        R"("cube": {"type": "polyCube"}, "far": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [5, 0, 0]}},
                 "a": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}}},
                 "b": {"type": "zBone", "inputs": {"mesh": {"from": "far.outMesh"}}},
                 "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "a.outBody"}, {"from": "b.outBody"}]}},
                 "w": {"type": "meshWriter", "inputs": {"meshes": {"from": "solver.outMeshes"}}})");
    const auto file = s.get<nodes::FileContent>("w", "outFile");
    const solver::SurfaceMesh back = solver::read_surface(folder.write("two.obj", file.bytes));
    CHECK(back.points.size() == 16);
    CHECK(solver::bounding_box(back.points).max == solver::Vec3(5.5, 0.5, 0.5));
}

TEST_CASE("a curve comes from numbers, JSON or text, and is refused if it is no polyline", "[nodes]") {
    const Folder folder;
    const std::string json = folder.write("c.json", R"({"lines": {"biceps": [[0, 0, 0], [1, 2, 3]]}})");
    const std::string text = folder.write("c.txt", "0 0 0\n1 2 3\n");
    Session s(R"("a": {"type": "curve", "inputs": {"points": [0, 0, 0, 1, 2, 3]}},
                 "b": {"type": "curve", "inputs": {"file": ")" +
              json + R"(", "key": "/lines/biceps"}},
                 "c": {"type": "curve", "inputs": {"file": ")" +
              text + R"("}},
                 "odd": {"type": "curve", "inputs": {"points": [0, 0, 0, 1]}}, "none": {"type": "curve"},
                 "both": {"type": "curve", "inputs": {"points": [0, 0, 0, 1, 2, 3], "file": ")" +
              text + R"("}},
                 "wrong": {"type": "curve", "inputs": {"file": ")" +
              json + R"(", "key": "/lines/triceps"}})");
    const engine::Value a = s.pull("a", "outCurve");
    CHECK(a.as<nodes::CurvePoints>().points.back() == solver::Vec3(1, 2, 3));
    CHECK(s.pull("b", "outCurve").digest() == a.digest());
    CHECK(s.pull("c", "outCurve").digest() == a.digest());
    CHECK(codes([&] { s.pull("odd", "outCurve"); }) == Codes{"FE216"});
    CHECK(codes([&] { s.pull("none", "outCurve"); }) == Codes{"FE216"});
    CHECK(codes([&] { s.pull("both", "outCurve"); }) == Codes{"DG110"});
    CHECK(codes([&] { s.pull("wrong", "outCurve"); }) == Codes{"IO403"});
}

TEST_CASE("tets written in every format come back as they were", "[nodes]") {
    const Folder folder;
    for (const std::string format : {"vtk", "mesh", "msh", "veg"}) {
        INFO(format);
        Session s(
            R"("cube": {"type": "polyCube"}, "fill": {"type": "zTet", "inputs": {"mesh": {"from": "cube.outMesh"}}},
                     "write": {"type": "tetWriter", "inputs": {"tets": {"from": "fill.outTets"}, "format": ")" +
            format + R"("}})");
        const auto file = s.get<nodes::FileContent>("write", "outFile");
        CHECK(file.ending == format);
        const auto before = s.get<nodes::TetMeshValue>("fill", "outTets");
        Session back(R"("t": {"type": "tetMeshFile", "inputs": {"file": ")" + folder.write("t." + format, file.bytes) +
                     R"("}})");
        const auto after = back.get<nodes::TetMeshValue>("t", "outTets");
        CHECK(after.mesh->vertices == before.mesh->vertices);
        CHECK(after.mesh->tets == before.mesh->tets);
    }
}

TEST_CASE("quadratic tets from a file that knows of cut ones the share alone are warned about", "[nodes]") {
    const Folder folder;
    Session s(R"("ball": {"type": "polySphere"}, "fill": {"type": "zTet", "inputs": {"mesh": {"from": "ball.outMesh"}}},
                 "write": {"type": "tetWriter", "inputs": {"tets": {"from": "fill.outTets"}, "format": "vtk"}})");
    const std::string file = folder.write("t.vtk", s.get<nodes::FileContent>("write", "outFile").bytes);
    const auto told = [&](const std::string& element) {
        Session back(R"("t": {"type": "tetMeshFile", "inputs": {"file": ")" + file + R"("}},
            "u": {"type": "zTet", "inputs": {"tets": {"from": "t.outTets"}, "element": ")" +
                     element + R"("}})");
        (void)back.pull("u", "outTets");
        std::string out;
        for (const engine::Diagnostic& d : back.counter.warnings) out += d.code + " " + d.node + "." + d.attribute;
        return out;
    };
    CHECK(told("quadratic") == "FE346 u.tets");
    CHECK(told("linear").empty());
}

TEST_CASE("TetGen's two files are named both, and both enter the key", "[nodes]") {
    const Folder folder;
    const auto reader = [](const std::string& node, const std::string& ele) {
        return R"("t": {"type": "tetMeshFile", "inputs": {"file": ")" + node + "\"" +
               (ele.empty() ? "" : R"(, "elementFile": ")" + ele + "\"") + "}}";
    };
    const std::string node = folder.write("a.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n"),
                      ele = folder.write("other.ele", "1 4 0\n0 0 1 2 3\n"),
                      bad = folder.write("bad.ele", "1 4 0\n0 0 1 2 7\n");
    Session s(reader(node, ele));
    const auto tets = s.get<nodes::TetMeshValue>("t", "outTets");
    CHECK(tets.mesh->tets == std::vector<solver::Tet>{{0, 1, 2, 3}});
    folder.write("other.ele", "1 4 0\n0 1 2 0 3\n");
    CHECK(Session(reader(node, ele)).get<nodes::TetMeshValue>("t", "outTets").digest != tets.digest);
    std::string text;
    CHECK(codes(reader(node, bad), "t", "outTets", &text) == Codes{"FE203"});
    CHECK(text.find("t.elementFile") != std::string::npos);
    CHECK(text.find("vertex 7") != std::string::npos);
    CHECK(codes(reader(node, ""), "t", "outTets") == Codes{"DG110"});
    CHECK(codes(reader(folder.write("a.veg", "*VERTICES\n"), ele), "t", "outTets") == Codes{"DG110"});
}
