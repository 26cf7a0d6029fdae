// The meshing nodes: what they make, refuse, warn about, and that they mesh only when they must.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include "solver/mesh/mesh_check.h"

using namespace bench;

namespace {

const std::string two_balls = R"("ball": {"type": "polySphere"},
    "other": {"type": "transform", "inputs": {"mesh": {"from": "ball.outMesh"}, "translate": [1, 0, 0]}},
    "plane": {"type": "polyPlane"}, )";

std::string iso(const std::string& inputs) {
    return two_balls + R"("iso": {"type": "zIsoMesh", "inputs": {)" + inputs + "}}";
}

const std::string both = R"("meshes": [{"from": "ball.outMesh"}, {"from": "other.outMesh"}], "resolution": 64)";

} // namespace

TEST_CASE("zIsoMesh makes one closed mesh of several and meshes again only if an input changes", "[nodes]") {
    Session s(iso(both));
    const auto mesh = s.get<nodes::Mesh>("iso", "outMesh");
    const solver::MeshCheck found = solver::check_mesh(*mesh.points, mesh.topology->triangles);
    CHECK(found.is_closed());
    CHECK(found.is_manifold());
    CHECK(found.components == 1);
    CHECK(solver::least_angle(*mesh.points, mesh.topology->triangles) >= 30 - 1e-6);
    s.set("iso", "triangleSize", "2");
    CHECK(s.get<nodes::Mesh>("iso", "outMesh").points->size() < mesh.points->size() / 2);
    CHECK(s.counter.computes["iso"] == 2);
    s.set("iso", "triangleSize", "1");
    CHECK(s.get<nodes::Mesh>("iso", "outMesh").points_digest == mesh.points_digest);
    CHECK(s.counter.computes["iso"] == 2);
    // Another frame is another key, because a transform may follow a track; but its mesh is the same.
    CHECK(s.get<nodes::Mesh>("iso", "outMesh", 7).points == s.get<nodes::Mesh>("iso", "outMesh", 8).points);
    CHECK(s.counter.warnings.empty());
}

TEST_CASE("zIsoMesh says which input is to blame", "[nodes]") {
    std::string text;
    CHECK(codes(iso(R"("meshes": [{"from": "plane.outMesh"}])"), "iso", "outMesh", &text) == Codes{"FE230"});
    CHECK(text.find("isoValue") != std::string::npos);
    CHECK(codes(iso(R"("meshes": [{"from": "plane.outMesh"}], "isoValue": 0.05)"), "iso", "outMesh").empty());
    CHECK(codes(iso(both + R"(, "isoValue": -3)"), "iso", "outMesh", &text) == Codes{"FE231"});
    CHECK(text.find("iso") != std::string::npos);
    CHECK(codes(iso(both + R"(, "triangleSize": 1e-5)"), "iso", "outMesh", &text) == Codes{"FE232"});
    CHECK(text.find("triangleSize") != std::string::npos);
    CHECK(codes(iso(both + R"(, "maxTime": 1e-6)"), "iso", "outMesh", &text) == Codes{"FE233"});
    CHECK(text.find("maxTime") != std::string::npos);
    CHECK(codes(iso(""), "iso", "outMesh") == Codes{"DG019"});
}

TEST_CASE("zDelaunayTetMesh fills an iso mesh and leaves its triangles as they are", "[nodes]") {
    const std::string fill = iso(both) + R"(, "tets": {"type": "zDelaunayTetMesh", "inputs": {
        "mesh": {"from": "iso.outMesh"}}}, "flesh": {"type": "zMaterial"}, "tissue": {"type": "zTissue", "inputs": {
        "mesh": {"from": "iso.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}})";
    Session s(fill);
    const auto skin = s.get<nodes::Mesh>("iso", "outMesh");
    const auto tets = s.get<nodes::TetMeshValue>("tets", "outTets");
    CHECK(solver::boundary_triangles(tets.mesh->tets).size() == skin.topology->triangles.size());
    const auto& x = tets.mesh->vertices;
    CHECK(std::equal(skin.points->begin(), skin.points->end(), x.begin()));
    s.set("tets", "refinementQuality", "0.2");
    CHECK(s.get<nodes::TetMeshValue>("tets", "outTets").mesh->tets.size() < tets.mesh->tets.size());
    CHECK(s.pull("tissue", "outBody"));
    CHECK(s.counter.computes["iso"] == 1);
    CHECK(s.counter.warnings.empty());
    std::string text;
    const auto refused = [&](const std::string& mesh, const std::string& more = "") {
        return codes(two_balls + R"("tets": {"type": "zDelaunayTetMesh", "inputs": {"mesh": {"from": ")" + mesh +
                         R"("})" + more + "}}",
                     "tets", "outTets", &text);
    };
    CHECK(refused("plane.outMesh") == Codes{"FE230"});
    CHECK(text.find("tets.mesh") != std::string::npos);
    CHECK(refused("ball.outMesh", R"(, "maxTime": 0)").empty());
    CHECK(refused("ball.outMesh", R"(, "maxTime": 1e-6)") == Codes{"FE233"});
    CHECK(text.find("tets.maxTime") != std::string::npos);
}

TEST_CASE("a meshing node stops when the host asks", "[nodes]") {
    Session s(iso(both));
    std::stop_source stop;
    stop.request_stop();
    CHECK_THROWS_AS(s.evaluator.pull({s.graph, {"iso", "outMesh"}, 1, stop.get_token()}), engine::Cancelled);
    CHECK(s.get<nodes::Mesh>("iso", "outMesh").points->size() > 100);
}
