// Meshes that deform from outside: pickMesh, meshSequence and skinCluster, alone and as bones of a simulation.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "solver/mesh/mesh_files.h"

#include <chrono>
#include <cmath>
#include <cstring>

using namespace bench;

namespace {

/// Layer one: a soft block tied to a bone that moves up. `u`: what else stands in the graph.
std::string first_layer(const std::string& u) {
    return R"("cube": {"type": "polyCube", "inputs": {"subdivisionsWidth": 2, "subdivisionsHeight": 2, "subdivisionsDepth": 2}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 5e4}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "cube.outMesh"}, "tetSize": 0.7}},
        "block": {"type": "zTissue", "inputs": {"mesh": {"from": "cube.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "above": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": {"keys": [[1, [0, 1, 0]], [5, [0.2, 1.4, 0]]]}}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "above.outMesh"}}},
        "top": {"type": "weights", "inputs": {"mesh": {"from": "cube.outMesh"}, "mode": "ramp", "axis": "y", "start": 0.3, "end": 0.5}},
        "tie": {"type": "zAttachment", "inputs": {"source": {"from": "block.outBody"}, "target": {"from": "bone.outBody"}, "weights": {"from": "top.outWeights"}}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "bone.outBody"}, {"from": "block.outBody"}], "attachments": [{"from": "tie.outAttachment"}]}})" +
           u;
}

/// Layer two: a second block below, tied to the first one's surface, which `mesh` gives.
std::string second_layer(const std::string& mesh, int substeps) {
    return R"(, "below": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0, -1, 0]}},
        "tets2": {"type": "zTet", "inputs": {"mesh": {"from": "below.outMesh"}, "tetSize": 0.7}},
        "block2": {"type": "zTissue", "inputs": {"mesh": {"from": "below.outMesh"}, "tets": {"from": "tets2.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "carrier": {"type": "zBone", "inputs": {"mesh": {"from": ")" +
           mesh + R"("}}},
        "tie2": {"type": "zAttachment", "inputs": {"source": {"from": "block2.outBody"}, "target": {"from": "carrier.outBody"}, "weights": {"from": "top2.outWeights"}}},
        "top2": {"type": "weights", "inputs": {"mesh": {"from": "below.outMesh"}, "mode": "ramp", "axis": "y", "start": -0.7, "end": -0.5}},
        "solver2": {"type": "zSolver", "inputs": {"scale": 1, "substeps": )" +
           std::to_string(substeps) +
           R"(, "bodies": [{"from": "carrier.outBody"}, {"from": "block2.outBody"}], "attachments": [{"from": "tie2.outAttachment"}]}})";
}

const char* const picked =
    R"(, "pick": {"type": "pickMesh", "inputs": {"meshes": {"from": "solver.outMeshes"}, "body": "block"}})";

solver::Points mesh_at(Session& s, const std::string& node, double frame) {
    return *s.get<nodes::Mesh>(node, "outMesh", frame).points;
}

solver::Points solved(Session& s, const std::string& node, double frame) {
    return *s.get<nodes::MeshList>(node, "outMeshes", frame).meshes[1].points;
}

std::string frame_name(const std::string& stem, int frame, const char* ending = ".obj") {
    char digits[8];
    std::snprintf(digits, sizeof digits, "%04d", frame);
    return stem + "." + digits + ending;
}

/// A quad that lies at height `z`.
std::string quad(double z) {
    const std::string h = " " + std::to_string(z) + "\n";
    return "v 0 0" + h + "v 1 0" + h + "v 1 1" + h + "v 0 1" + h + "f 1 2 3 4\n";
}

std::string sequence(const std::string& file, const std::string& more = "") {
    return R"("n": {"type": "meshSequence", "inputs": {"file": ")" + file + "\"" + more + "}}";
}

template <class T>
void put(std::string& out, T v) {
    std::string raw(sizeof v, ' ');
    std::memcpy(raw.data(), &v, sizeof v);
    out += raw;
}

} // namespace

TEST_CASE("pickMesh gives the mesh of a body, by name or place, and follows a renamed node", "[nodes]") {
    Session s(first_layer(std::string(picked) + R"(,
        "second": {"type": "pickMesh", "inputs": {"meshes": {"from": "solver.outMeshes"}, "index": 0}})"));
    CHECK(mesh_at(s, "pick", 4) == solved(s, "solver", 4));
    CHECK(mesh_at(s, "second", 4) == mesh_at(s, "above", 4));
    s.counter.computes.clear(), s.counter.steps.clear();
    s.graph = engine::Edit(s.graph).rename_node("block", "heart").commit().graph;
    CHECK(mesh_at(s, "pick", 4) == solved(s, "solver", 4));
    CHECK(s.counter.computes.empty());
    CHECK(s.counter.steps.empty());
    // The other way round the names stand for other places.
    s.set("solver", "bodies", R"([{"from": "heart.outBody"}, {"from": "bone.outBody"}])");
    CHECK(mesh_at(s, "pick", 2) == *s.get<nodes::MeshList>("solver", "outMeshes", 2).meshes[0].points);
}

TEST_CASE("pickMesh says which meshes there are where it is given none of them", "[nodes]") {
    std::string text;
    const auto pick = [&](const std::string& inputs) {
        return codes(first_layer(R"(, "n": {"type": "pickMesh", "inputs": {"meshes": {"from": "solver.outMeshes"})" +
                                 inputs + "}}"),
                     "n", "outMesh", &text);
    };
    CHECK(pick(R"(, "body": "blok")") == Codes{"FE290"});
    CHECK(text.find("bone") != std::string::npos);
    CHECK(text.find("did you mean \"block\"") != std::string::npos);
    CHECK(pick(R"(, "index": 2)") == Codes{"FE290"});
    CHECK(text.find("0 bone, 1 block") != std::string::npos);
    CHECK(pick("") == Codes{"DG110"});
    CHECK(text.find("0 bone, 1 block") != std::string::npos);
    CHECK(pick(R"(, "index": 0, "body": "block")") == Codes{"DG110"});
    CHECK(pick(R"(, "body": {"from": "cube.outMesh"})") == Codes{"DG029"});
    CHECK(pick(R"(, "index": 1)").empty());
    CHECK(
        codes(
            R"("ball": {"type": "polySphere"}, "n": {"type": "pickMesh", "inputs": {"meshes": {"from": "ball.outMesh"}}})",
            "n", "outMesh") == Codes{"DG024"});
}

TEST_CASE("one solver's result is the next one's bone: in one graph, at sub-steps, and the same from files",
          "[nodes]") {
    for (const int substeps : {1, 2}) {
        Session s(first_layer(picked + second_layer("pick.outMesh", substeps)));
        Folder folder;
        for (int frame = 1; frame <= 5; ++frame)
            folder.write(frame_name("block", frame),
                         solver::write_obj(s.get<nodes::Mesh>("pick", "outMesh", frame).surface()));
        const solver::Points middle = mesh_at(s, "pick", 3.5), a = mesh_at(s, "pick", 3), b = mesh_at(s, "pick", 4);
        for (std::size_t v = 0; v < a.size(); ++v) CHECK((middle[v] - 0.5 * (a[v] + b[v])).norm() < 1e-15);
        Session files(first_layer(R"(, "read": {"type": "meshSequence", "inputs": {"file": ")" +
                                  folder.path("block.####.obj") + R"("}})" + second_layer("read.outMesh", substeps)));
        for (int frame = 1; frame <= 5; ++frame) {
            CHECK(mesh_at(files, "read", frame) == mesh_at(s, "pick", frame));
            CHECK(solved(files, "solver2", frame) == solved(s, "solver2", frame));
        }
        CHECK(files.counter.steps["solver"] == 0);
        const solver::Points rest = solved(s, "solver2", 1), now = solved(s, "solver2", 5);
        CHECK(largest_difference(rest, now) > 0.1);
        CHECK(s.counter.warnings.empty());
    }
}

TEST_CASE("a sequence of files goes by what each frame holds", "[nodes]") {
    const Folder folder;
    for (int frame = 1; frame <= 5; ++frame)
        folder.write(frame_name("block", frame), solver::write_obj([&] {
                         Session s(first_layer(""));
                         auto cube = s.get<nodes::Mesh>("cube", "outMesh").surface();
                         for (auto& p : cube.points) p.y() += 0.01 * frame;
                         return cube;
                     }()));
    Session s(first_layer(R"(, "read": {"type": "meshSequence", "inputs": {"file": ")" + folder.path("block.####.obj") +
                          R"("}})" + second_layer("read.outMesh", 1)));
    (void)solved(s, "solver2", 5);
    CHECK(s.counter.steps["solver2"] == 5);
    // Written again with the same content at another time: nothing runs.
    const std::string third = folder.path(frame_name("block", 3));
    std::ifstream in(third);
    std::string text((std::istreambuf_iterator<char>(in)), {});
    std::filesystem::last_write_time(third, std::filesystem::last_write_time(third) + std::chrono::seconds(2));
    s.counter.steps.clear();
    (void)solved(s, "solver2", 5);
    CHECK(s.counter.steps["solver2"] == 0);
    // Frame 4 moved: frames 4 and 5 run again.
    folder.write(frame_name("block", 4), text);
    (void)solved(s, "solver2", 5);
    CHECK(s.counter.steps["solver2"] == 2);
}

TEST_CASE("meshSequence maps frames, goes straight between them and holds or fails beyond", "[nodes]") {
    const Folder folder;
    for (const int frame : {8, 9, 10}) folder.write(frame_name("q", frame), quad(frame));
    const std::string file = folder.path("q.####.obj");
    const auto height = [&](const std::string& more, double frame) {
        Session s(sequence(file, more));
        return mesh_at(s, "n", frame).front().z();
    };
    CHECK(height("", 9) == 9);
    CHECK(height("", 9.25) == Approx(9.25));
    CHECK(height(R"(, "frameOffset": 8)", 1) == 9);
    CHECK(height(R"(, "frameOffset": 7, "frameRate": 0.5)", 4) == Approx(9.5));
    CHECK(height(R"(, "beyond": "hold")", 1) == 8);
    CHECK(height(R"(, "beyond": "hold")", 20) == 10);
    std::string text;
    CHECK(codes(sequence(file), "n", "outMesh", &text, 1) == Codes{"FE293"});
    CHECK(text.find("there are frames 8 to 10") != std::string::npos);
    std::filesystem::remove(folder.path(frame_name("q", 9)));
    CHECK(codes(sequence(file), "n", "outMesh", &text, 9) == Codes{"FE293"});
    CHECK(text.find("frame 9 is missing") != std::string::npos);
    CHECK(codes(sequence(file), "n", "outMesh", &text, 8).empty());
}

TEST_CASE("meshSequence refuses frames of other meshes, cut files and what is no sequence", "[nodes]") {
    const Folder folder;
    std::string text;
    folder.write(frame_name("q", 1), quad(1));
    folder.write(frame_name("q", 2), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write(frame_name("q", 3), "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 1 2 4\nf 2 3 4\n");
    folder.write(frame_name("q", 4), quad(1).substr(0, 20));
    const std::string file = folder.path("q.####.obj");
    CHECK(codes(sequence(file), "n", "outMesh", &text, 2) == Codes{"FE294"});
    CHECK(text.find("q.0002.obj has 3 vertices, q.0001.obj has 4") != std::string::npos);
    CHECK(codes(sequence(file), "n", "outMesh", &text, 3) == Codes{"FE294"});
    CHECK(text.find("other faces") != std::string::npos);
    CHECK_FALSE(codes(sequence(file), "n", "outMesh", &text, 4).empty());
    CHECK(text.find("q.0004.obj") != std::string::npos);
    CHECK(codes(sequence(folder.path(frame_name("q", 1))), "n", "outMesh", &text) == Codes{"IO404"});
    CHECK(codes(sequence(folder.path("none.####.obj")), "n", "outMesh", &text) == Codes{"IO401"});
    CHECK(text.find("no file like") != std::string::npos);
}

TEST_CASE("point caches move the mesh that is connected", "[nodes]") {
    const Folder folder;
    std::string cache("POINTCACHE2\0", 12);
    put(cache, std::int32_t{1}), put(cache, std::int32_t{4}), put(cache, 1.0f), put(cache, 1.0f),
        put(cache, std::int32_t{2});
    for (const float z : {1.0f, 2.0f})
        for (const float c : {0.f, 0.f, z, 1.f, 0.f, z, 1.f, 1.f, z, 0.f, 1.f, z}) put(cache, c);
    const std::string file = folder.write("q.pc2", cache), obj = folder.write("q.obj", quad(0));
    const std::string mesh = R"("m": {"type": "meshFile", "inputs": {"file": ")" + obj + R"("}}, )";
    Session s(mesh + sequence(file, R"(, "mesh": {"from": "m.outMesh"})"));
    CHECK(mesh_at(s, "n", 1)[2] == solver::Vec3(1, 1, 1));
    CHECK(mesh_at(s, "n", 1.5)[3] == solver::Vec3(0, 1, 1.5));
    std::string text;
    CHECK(codes(sequence(file), "n", "outMesh", &text) == Codes{"DG110"});
    folder.write("q.pc2", cache.substr(0, cache.size() - 1));
    CHECK(codes(mesh + sequence(file, R"(, "mesh": {"from": "m.outMesh"})"), "n", "outMesh", &text) == Codes{"IO403"});
    CHECK(text.find("cut off") != std::string::npos);
    folder.write("q.pc2", cache);
    CHECK(codes(R"("m": {"type": "polyCube"}, )" + sequence(file, R"(, "mesh": {"from": "m.outMesh"})"), "n", "outMesh",
                &text) == Codes{"FE294"});
}

namespace {

/// A strip of 0 to 2 along x, its halves on two joints, of which the second turns about x = 1 by a right angle.
std::string strip(const std::string& skin) {
    return R"("plane": {"type": "polyPlane", "inputs": {"width": 2, "height": 1, "subdivisionsWidth": 2, "subdivisionsHeight": 1}},
        "mesh": {"type": "transform", "inputs": {"mesh": {"from": "plane.outMesh"}, "translate": [1, 0, 0]}},
        "root": {"type": "transform", "inputs": {"translate": [5, 0, 0]}},
        "tip": {"type": "transform", "inputs": {"rotate": {"keys": [[1, [0, 0, 30]], [3, [0, 0, 120]]]}, "rotatePivot": [1, 0, 0]}},
        "here": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "start": 2, "end": 0}},
        "there": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "start": 0, "end": 2}},
        "skin": {"type": "skinCluster", "inputs": {"mesh": {"from": "mesh.outMesh"},
            "joints": [{"from": "root.outMatrix"}, {"from": "tip.outMatrix"}])" +
           skin + "}}";
}

const char* const both = R"(, "weights": [{"from": "here.outWeights"}, {"from": "there.outWeights"}])";

} // namespace

TEST_CASE("a skin is as bound at the first frame, and follows its joints by their weights from there", "[nodes]") {
    Session s(strip(both));
    const solver::Points bound = mesh_at(s, "mesh", 1);
    CHECK(mesh_at(s, "skin", 1) == bound); // though its joints are turned and moved
    const solver::Points now = mesh_at(s, "skin", 3);
    const solver::Mat3 quarter = (solver::Mat3() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
    const solver::Vec3 about(1, 0, 0);
    for (std::size_t v = 0; v < bound.size(); ++v) {
        const double share = bound[v].x() / 2;
        const solver::Vec3 turned = quarter * (bound[v] - about) + about;
        CHECK((now[v] - ((1 - share) * bound[v] + share * turned)).norm() < 1e-14);
    }
    s.set("skin", "skinningMethod", "\"dualQuaternion\"");
    CHECK(mesh_at(s, "skin", 1) == bound);
    // Halfway along: by half of the angle about the pivot.
    const solver::Points rigid = mesh_at(s, "skin", 3);
    for (std::size_t v = 0; v < bound.size(); ++v)
        if (bound[v].x() == 1) CHECK((rigid[v] - bound[v]).norm() < 1e-14);
    s.set("skin", "bindMatrices", R"([{"from": "root.outMatrix"}, {"from": "root.outMatrix"}])");
    CHECK(largest_difference(mesh_at(s, "skin", 1), bound) > 0.1);
    CHECK(s.counter.warnings.empty());
}

TEST_CASE("skin weights come from a file, are normalised with a word or refused, and must fit", "[nodes]") {
    const Folder folder;
    std::string text;
    const std::string good = folder.write("w.json", R"({"skin": [[1,0],[0.5,0.5],[0,1],[1,0],[0.5,0.5],[0,1]]})");
    const auto from = [](const std::string& file, const std::string& more = "") {
        return strip(R"(, "weightsPointer": "/skin", "weightsFile": ")" + file + "\"" + more);
    };
    Session painted(strip(both)), read(from(good));
    CHECK(largest_difference(mesh_at(read, "skin", 3), mesh_at(painted, "skin", 3)) < 1e-14);
    const std::string heavy = folder.write("h.json", R"({"skin": [[1,0],[1,1],[0,1],[1,0],[0.5,0.5],[0,1]]})");
    Session s(from(heavy));
    CHECK(largest_difference(mesh_at(s, "skin", 3), mesh_at(painted, "skin", 3)) < 1e-14);
    REQUIRE_FALSE(s.counter.warnings.empty());
    CHECK(s.counter.warnings.front().code == "FE296");
    CHECK(s.counter.warnings.front().message.find("1 of 6 vertices") != std::string::npos);
    CHECK(codes(from(heavy, R"(, "sums": "refuse")"), "skin", "outMesh", &text) == Codes{"FE296"});
    CHECK(codes(from(folder.write("n.json", R"({"skin": [[1,0],[0,0],[0,1],[1,0],[0.5,0.5],[0,1]]})")), "skin",
                "outMesh", &text) == Codes{"FE295"});
    CHECK(text.find("the first is 1") != std::string::npos);
    CHECK(codes(from(folder.write("s.json", R"({"skin": [[1,0],[0,1]]})")), "skin", "outMesh", &text) ==
          Codes{"FE295"});
    CHECK(codes(from(folder.write("m.json", R"({"skin": [[2,-1],[0,1],[0,1],[1,0],[0.5,0.5],[0,1]]})")), "skin",
                "outMesh", &text) == Codes{"FE295"});
    CHECK(codes(strip(R"(, "weights": [{"from": "here.outWeights"}])"), "skin", "outMesh") == Codes{"FE295"});
    CHECK(codes(strip(""), "skin", "outMesh") == Codes{"DG110"});
    CHECK(codes(from(good, both), "skin", "outMesh") == Codes{"DG110"});
    Session scaled(strip(both));
    scaled.set("tip", "scale", "[2, 1, 1]");
    CHECK(codes([&] { scaled.pull("skin", "outMesh", 3); }).empty()); // scaled at the first frame too
    scaled.set("tip", "scale", R"({"keys": [[1, [1, 1, 1]], [3, [2, 1, 1]]]})");
    CHECK(codes([&] { scaled.pull("skin", "outMesh", 3); }).empty());
    scaled.set("skin", "skinningMethod", "\"dualQuaternion\"");
    CHECK(codes([&] { scaled.pull("skin", "outMesh", 3); }, &text) == Codes{"FE297"});
    CHECK(text.find("tip") != std::string::npos);
    scaled.set("tip", "scale", "[0, 1, 1]");
    CHECK(codes([&] { scaled.pull("skin", "outMesh", 3); }) == Codes{"FE332"}); // the joint itself
}

TEST_CASE("a bone that a skin deforms carries what is attached to it and what lies on it", "[nodes]") {
    // A slab whose right half rises by 0.3; blocks of flesh lie on it, one tied, one in contact.
    const auto block = [](const std::string& name, double x) {
        return R"(, ")" + name +
               R"(Mesh": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [)" +
               std::to_string(x) + R"(, 0.35, 0], "scale": [0.4, 0.4, 0.4]}},
        ")" + name +
               R"(Tets": {"type": "zTet", "inputs": {"mesh": {"from": ")" + name + R"(Mesh.outMesh"}, "tetSize": 0.3}},
        ")" + name +
               R"(": {"type": "zTissue", "inputs": {"mesh": {"from": ")" + name +
               R"(Mesh.outMesh"}, "tets": {"from": ")" + name +
               R"(Tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}})";
    };
    Session s(
        R"("cube": {"type": "polyCube"}, "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e5}},
        "slab": {"type": "polyCube", "inputs": {"width": 4, "height": 0.3, "depth": 1, "subdivisionsWidth": 8}},
        "still": {"type": "transform"}, "rise": {"type": "transform", "inputs": {"translate": {"keys": [[1, [0, 0, 0]], [9, [0, 0.3, 0]]]}}},
        "left": {"type": "weights", "inputs": {"mesh": {"from": "slab.outMesh"}, "mode": "ramp", "start": 0.4, "end": -0.4}},
        "right": {"type": "weights", "inputs": {"mesh": {"from": "slab.outMesh"}, "mode": "ramp", "start": -0.4, "end": 0.4}},
        "skin": {"type": "skinCluster", "inputs": {"mesh": {"from": "slab.outMesh"}, "joints": [{"from": "still.outMatrix"}, {"from": "rise.outMatrix"}],
            "weights": [{"from": "left.outWeights"}, {"from": "right.outWeights"}]}},
        "ground": {"type": "zBone", "inputs": {"mesh": {"from": "skin.outMesh"}, "contactStiffness": 1e7}})" +
        block("tied", 1.5) + block("loose", 0.9) +
        R"(, "foot": {"type": "weights", "inputs": {"mesh": {"from": "tiedMesh.outMesh"}, "mode": "ramp", "axis": "y", "start": 0.3, "end": 0.15}},
        "tie": {"type": "zAttachment", "inputs": {"source": {"from": "tied.outBody"}, "target": {"from": "ground.outBody"}, "weights": {"from": "foot.outWeights"}}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "collisionDetection": true, "substeps": 2, "bodies": [{"from": "ground.outBody"}, {"from": "tied.outBody"}, {"from": "loose.outBody"}],
            "attachments": [{"from": "tie.outAttachment"}]}})");
    const auto lowest = [&](std::size_t body) {
        double least = 1e9;
        for (const auto& p : *s.get<nodes::MeshList>("solver", "outMeshes", 14).meshes[body].points)
            least = std::min(least, p.y());
        return least;
    };
    CHECK(lowest(1) == Approx(0.15 + 0.3).margin(0.01));
    CHECK(lowest(2) == Approx(0.15 + 0.3).margin(0.01));
    CHECK(s.get<nodes::SolveReport>("solver", "outReport", 14).record.converged);
}

TEST_CASE("a bone of another shape, its faces as before, is another scene to the same session", "[nodes]") {
    // Twice as wide it has more points that press into the block.
    const std::string graph =
        R"("cube": {"type": "polyCube"}, "flesh": {"type": "zMaterial"},
        "slab": {"type": "polyCube", "inputs": {"width": 1.2, "height": 0.3, "depth": 1.2, "subdivisionsWidth": 2, "subdivisionsDepth": 2}},
        "shape": {"type": "transform", "inputs": {"mesh": {"from": "slab.outMesh"}}},
        "ground": {"type": "zBone", "inputs": {"mesh": {"from": "shape.outMesh"}}},
        "over": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0.1, 0.651, 0]}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "over.outMesh"}, "tetSize": 0.5}},
        "block": {"type": "zTissue", "inputs": {"mesh": {"from": "over.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "collisionDetection": true, "collisionSubdivision": true, "collisionPointSpacing": 0.2,
            "bodies": [{"from": "ground.outBody"}, {"from": "block.outBody"}]}})";
    const std::string wider = "[2.2, 1, 2.2]";
    Session edited(graph), fresh(graph);
    edited.get<nodes::MeshList>("solver", "outMeshes", 4);
    edited.set("shape", "scale", wider);
    fresh.set("shape", "scale", wider);
    const auto points = [](Session& s) { return *s.get<nodes::MeshList>("solver", "outMeshes", 4).meshes[1].points; };
    CHECK(points(edited) == points(fresh));
}
