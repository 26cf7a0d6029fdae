// Numbers that are too large, sizes that would not fit: told about the input that asks for them, before any work.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include "solver/error.h"
#include "solver/mesh/closest_point.h"

using namespace bench;

namespace {

std::string text_of(const std::string& nodes, const std::string& node, const std::string& output, const Codes& wanted) {
    Session s(nodes);
    std::string text;
    CHECK(codes([&] { s.pull(node, output); }, &text) == wanted);
    return text;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("no mesh lies farther out than numbers can hold, wherever it comes from", "[nodes]") {
    const Folder folder;
    const std::string far = folder.write("far.obj", "v 0 0 0\nv 1e155 0 0\nv 0 1 0\nv 0 0 1\n"
                                                    "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    CHECK(has(text_of(R"("n": {"type": "meshFile", "inputs": {"file": ")" + far + "\"}}", "n", "outMesh", {"FE224"}),
              "n.file"));
    const std::string tet = "MeshVersionFormatted 1\nDimension 3\nVertices\n4\n"
                            "0 0 0 0\n1e155 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 2 3 4 0\nEnd\n";
    const std::string far_tet = folder.write("far.mesh", tet);
    CHECK(has(
        text_of(R"("n": {"type": "tetMeshFile", "inputs": {"file": ")" + far_tet + "\"}}", "n", "outTets", {"FE224"}),
        "n.file"));
    const std::string nodes = folder.write("far.node", "4 3 0 0\n0 0 0 0\n1 1e155 0 0\n2 0 1 0\n3 0 0 1\n");
    const std::string elements = folder.write("far.ele", "1 4 0\n0 0 1 2 3\n");
    text_of(R"("n": {"type": "tetMeshFile", "inputs": {"file": ")" + nodes + R"(", "elementFile": ")" + elements +
                "\"}}",
            "n", "outTets", {"FE224"});
    for (const char* made :
         {R"("polySphere", "inputs": {"radius": 1e100})", R"("polyCube", "inputs": {"width": 1e300})"})
        CHECK(codes([&] { Session(R"("n": {"type": )" + std::string(made) + "}"); }) == Codes{"DG013"});
    const std::string cube = R"("cube": {"type": "polyCube"}, )";
    const std::string large = R"("cube": {"type": "polyCube", "inputs": {"height": 1e59}}, )";
    for (const char* move : {R"("translate": [0, 1e60, 0])", R"("scale": [1, 1e40, 1])"}) {
        const std::string place =
            large + R"("n": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, )" + move + "}}";
        CHECK(has(text_of(place, "n", "outMesh", {"FE224"}), "n.mesh"));
    }
    for (const char* move : {R"("translate": [1e155, 0, 0])", R"("scale": [1, 1e100, 1])", R"("rotate": [0, 1e10, 0])",
                             R"("rotatePivot": [0, 0, 1e61])"})
        CHECK(codes([&] { Session(R"("n": {"type": "transform", "inputs": {)" + std::string(move) + "}}"); }) ==
              Codes{"DG013"});
    // A bone that a matrix would carry there: as a literal, and through a connection.
    CHECK(codes([&] {
              Session(cube + R"("n": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"},
                  "matrix": [1,0,0,1e155, 0,1,0,0, 0,0,1,0, 0,0,0,1]}})");
          }) == Codes{"DG013"});
    const std::string bone = cube + R"("t": {"type": "transform", "inputs": {"scale": [1, 1e40, 1],
        "offsetParentMatrix": [1,0,0,0, 0,1e40,0,0, 0,0,1,0, 0,0,0,1]}},
        "n": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}, "matrix": {"from": "t.outMatrix"}}})";
    CHECK(has(text_of(bone, "n", "outBody", {"DG013"}), "(from t)"));
    const std::string both = cube + R"("t": {"type": "transform", "inputs": {"scale": [1e40, 1, 1]}},
        "big": {"type": "polyCube", "inputs": {"width": 1e40}},
        "n": {"type": "zBone", "inputs": {"mesh": {"from": "big.outMesh"}, "matrix": {"from": "t.outMatrix"}}})";
    CHECK(has(text_of(both, "n", "outBody", {"FE224"}), "n.matrix"));
}

TEST_CASE("a closest point is found wherever a query may lie, and refused beyond", "[nodes]") {
    const solver::Points points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<solver::Triangle> triangles{{0, 1, 2}};
    const solver::SurfaceTree tree(points, triangles);
    for (const double far : {1.0, 1e30, 1e59}) CHECK(tree.closest({far, far, far}).triangle == 0);
    for (const double far : {1e61, 1e155, 1e300}) CHECK_THROWS_AS(tree.closest({far, 0, 0}), solver::Error);
    CHECK(tree.closest({std::nan(""), 0, 0}).triangle == -1);
    CHECK_THROWS_AS(solver::SurfaceTree({{0, 0, 0}, {1e155, 0, 0}, {0, 1, 0}}, triangles), solver::Error);
}

TEST_CASE("meshes of absurd size are refused before any work, at the input that asks for them", "[nodes]") {
    CHECK(
        has(text_of(R"("n": {"type": "polyHelix", "inputs": {"radius": 3}})", "n", "outMesh", {"FE222"}), "n.radius"));
    CHECK(
        has(text_of(R"("n": {"type": "polyHelix", "inputs": {"coils": 1e9}})", "n", "outMesh", {"FE222"}), "n.coils"));
    text_of(R"("n": {"type": "polyHelix", "inputs": {"coils": 20000, "subdivisionsAxis": 4096}})", "n", "outMesh",
            {"FE232"});
    const std::string all = R"("subdivisionsWidth": 4096, "subdivisionsHeight": 4096)";
    CHECK(has(text_of(R"("n": {"type": "polyCube", "inputs": {)" + all + R"(, "subdivisionsDepth": 4096}})", "n",
                      "outMesh", {"FE232"}),
              "1.01e+08 faces"));
    text_of(R"("n": {"type": "polyCylinder", "inputs": {"subdivisionsAxis": 4096, "subdivisionsHeight": 4096,
               "subdivisionsCaps": 4096}})",
            "n", "outMesh", {"FE232"});
}
