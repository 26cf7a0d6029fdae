// hostMesh: what is sent is what comes out, at keys and between them, with the faces that were given.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

using namespace bench;

namespace {

/// A square and a triangle beside it.
const std::string two_faces = R"("points": [0,0,0, 1,0,0, 1,1,0, 0,1,0, 2,0.5,0], "faceSizes": [4, 3],
    "faceVertices": [0,1,2,3, 1,4,2])";

/// An L of six corners, which has to be cut at its inner corner.
const std::string corner = R"("faceSizes": [6], "faceVertices": [0,1,2,3,4,5], )";

std::string node(const std::string& inputs) { return R"("n": {"type": "hostMesh", "inputs": {)" + inputs + "}}"; }

nodes::Mesh mesh(const std::string& inputs, double frame = 1) {
    Session s(node(inputs));
    return s.get<nodes::Mesh>("n", "outMesh", frame);
}

std::string code(const std::string& inputs) {
    const Codes found = codes(node(inputs), "n", "outMesh");
    return found.size() == 1 ? found.front() : "not one";
}

} // namespace

TEST_CASE("a hostMesh has the points and faces that were written", "[nodes]") {
    const nodes::Mesh m = mesh(two_faces);
    REQUIRE(m.points->size() == 5);
    CHECK((*m.points)[4] == solver::Vec3(2, 0.5, 0));
    CHECK(m.topology->face_sizes == std::vector<int>{4, 3});
    CHECK(m.topology->face_vertices == std::vector<int>{0, 1, 2, 3, 1, 4, 2});
    CHECK(m.topology->triangles.size() == 3);
    const nodes::Mesh t = mesh(R"("points": [0,0,0, 1,0,0, 0,1,0], "faceVertices": [0, 1, 2])");
    CHECK(t.topology->triangles == std::vector<solver::Triangle>{{0, 1, 2}});
}

TEST_CASE("keyed points move on straight lines between keys", "[nodes]") {
    const std::string keyed = R"("faceVertices": [0, 1, 2],
        "points": {"keys": [[2, [0,0,0, 1,0,0, 0,1,0]], [4, [0,0,8, 1,0,4, 0,1,2]]]})";
    const auto heights = [&](double frame) {
        const nodes::Mesh m = mesh(keyed, frame);
        return std::vector<double>{(*m.points)[0][2], (*m.points)[1][2], (*m.points)[2][2]};
    };
    CHECK(heights(1) == std::vector<double>{0, 0, 0});
    CHECK(heights(2.5) == std::vector<double>{2, 1, 0.5});
    CHECK(heights(3) == std::vector<double>{4, 2, 1});
    CHECK(heights(9) == std::vector<double>{8, 4, 2});
    CHECK(codes(R"("n": {"type": "hostMesh", "inputs": {"faceVertices": [0, 1, 2],
        "points": {"keys": [[2, [0,0,0, 1,0,0, 0,1,0]], [4, [0,0,8]]]}}})",
                "n", "outMesh") == Codes{"DG017"});
}

TEST_CASE("a sent frame leaves the frames before it alone, and the first one holds for them", "[nodes]") {
    Session s(node(R"("faceVertices": [0, 1, 2])"));
    const auto send = [&](double frame, double z) {
        s.graph =
            engine::Edit(s.graph)
                .set_input({"n", "points"}, frame, engine::Value::of<engine::NumberList>({0, 0, z, 1, 0, z, 0, 1, z}))
                .commit()
                .graph;
    };
    const auto height = [&](double frame) { return (*s.get<nodes::Mesh>("n", "outMesh", frame).points)[1][2]; };
    send(1, 5);
    CHECK(height(-3) == 5);
    send(2, 7);
    CHECK(height(1) == 5);
    CHECK(height(1.5) == 6);
    send(4, 1); // 3 was skipped: it stays as it was
    CHECK(height(3) == 7);
    CHECK(height(4) == 1);
    // Another number of vertices, and a coordinate beyond all limits.
    const auto refused = [&](engine::NumberList numbers) {
        return codes([&] {
            engine::Edit(s.graph)
                .set_input({"n", "points"}, 5, engine::Value::of<engine::NumberList>(std::move(numbers)))
                .commit();
        });
    };
    CHECK(refused({0, 0, 0}) == Codes{"DG017"});
    CHECK(refused({0, 0, 0, 1, 0, 1e61, 0, 1, 0}) == Codes{"DG013"});
    CHECK(refused({0, 0, 0, 1, 0, std::nan(""), 0, 1, 0}) == Codes{"DG027"});
}

TEST_CASE("faces are cut alike at all frames where restPoints say how", "[nodes]") {
    const std::string flat = "0,0,0, 2,0,0, 2,1,0, 1,1,0, 1,2,0, 0,2,0",
                      bent = "0,0,0, 2,0,0, 2,1,0, 9,9,0, 1,2,0, 0,2,0";
    const auto triangles = [&](const std::string& points, const std::string& more) {
        return mesh(corner + "\"points\": [" + points + "]" + more).topology->triangles;
    };
    CHECK(triangles(bent, "") != triangles(flat, ""));
    CHECK(triangles(bent, ", \"restPoints\": [" + flat + "]") == triangles(flat, ""));
}

TEST_CASE("a hostMesh says what does not fit", "[nodes]") {
    CHECK(code("") == "DG124");
    CHECK(code(R"("points": [0,0,0, 1])") == "DG125");
    CHECK(code(R"("points": [0,0,0, 1,0,0, 0,1,0], "faceVertices": [0,1])") == "DG125");
    CHECK(code(R"("points": [0,0,0, 1,0,0, 0,1,0], "faceVertices": [0,1,0.5])") == "DG125");
    CHECK(code(R"("points": [0,0,0, 1,0,0, 0,1,0], "faceVertices": [0,1,-1])") == "DG125");
    CHECK(code(R"("points": [0,0,0, 1,0,0, 0,1,0], "faceVertices": [0,1,2], "faceSizes": [4])") == "DG125");
    CHECK(code(R"("points": [0,0,0, 1,0,0, 0,1,0], "faceVertices": [0,1], "faceSizes": [2])") == "DG125");
    CHECK(code(R"("points": [0,0,0, 1,0,0, 0,1,0], "faceVertices": [0,1,3])") == "FE203");
    CHECK(code(R"("points": [0,0,0, 1,0,0, 0,1,0])") == "FE201");
    CHECK(code(R"("points": [0,0,0, 1,0,0, 0,1,0], "faceVertices": [0,1,2], "restPoints": [0,0,0])") == "DG125");
}

TEST_CASE("tissue on a hostMesh bone runs on from the frame that was sent", "[nodes]") {
    Session s(node(R"("faceVertices": [0,1,2, 0,3,1, 1,3,2, 2,3,0])") +
              R"(, "bone": {"type": "zBone", "inputs": {"mesh": {"from": "n.outMesh"}}},
        "ball": {"type": "polySphere", "inputs": {"radius": 2}}, "flesh": {"type": "zMaterial"},
        "t": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "tie": {"type": "zAttachment", "inputs": {"source": {"from": "t.outBody"}, "target": {"from": "bone.outBody"}}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "t.outBody"}, {"from": "bone.outBody"}],
                   "attachments": [{"from": "tie.outAttachment"}]}})");
    for (int frame = 1; frame <= 5; ++frame) {
        const double y = 0.1 * frame;
        s.graph = engine::Edit(s.graph)
                      .set_input({"n", "points"}, frame,
                                 engine::Value::of<engine::NumberList>({0, y, 0, 1, y, 0, 0, y, 1, 0, 1 + y, 0}))
                      .commit()
                      .graph;
        const nodes::MeshList meshes = s.get<nodes::MeshList>("solver", "outMeshes", frame);
        CHECK((*meshes.meshes[1].points)[3] == solver::Vec3(0, 1 + y, 0));
        CHECK(s.counter.steps["solver"] == frame); // the start counts as one
    }
}
