// zTet: painted refinement, fill modes, limits, and meshing that is kept, watched and stopped.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include <set>

using namespace bench;

namespace {

/// A ball of radius 1, paint on its top, and zTet `t` of the ball with further inputs.
std::string ball(const std::string& inputs, const std::string& size = "0.4") {
    return R"("ball": {"type": "polySphere", "inputs": {"radius": 1}},
        "top": {"type": "weights", "inputs": {"mesh": {"from": "ball.outMesh"}, "mode": "ramp", "axis": "y", "start": 0.6, "end": 0.9}},
        "t": {"type": "zTet", "inputs": {"mesh": {"from": "ball.outMesh"}, "tetSize": )" +
           size + inputs + "}}";
}

std::size_t count(Session& s) { return s.get<nodes::TetMeshValue>("t", "outTets").mesh->tets.size(); }

class Watch : public engine::Observer {
  public:
    void progress(const std::string&, double done, std::string_view what) override {
        phases.emplace(what);
        last = done;
        if (++reports == stop_at) stop.request_stop();
    }
    std::set<std::string> phases;
    double last = 0;
    int reports = 0, stop_at = -1;
    std::stop_source stop;
};

} // namespace

TEST_CASE("without paint zTet gives the plain lattice, whatever its refinement", "[nodes]") {
    Session s(ball(""));
    const engine::Digest plain = s.pull("t", "outTets").digest();
    s.set("t", "surfaceRefinement", "5");
    s.set("t", "refinementPropagation", "1");
    CHECK(s.pull("t", "outTets").digest() == plain);
    s.set("t", "weights", R"({"from": "top.outWeights"})");
    s.set("t", "envelope", "0");
    CHECK(s.pull("t", "outTets").digest() == plain);
}

TEST_CASE("zTet multiplies envelope, weights and surfaceRefinement", "[nodes]") {
    Session s(ball(R"(, "weights": {"from": "top.outWeights"})"));
    const std::size_t once = count(s);
    s.set("t", "surfaceRefinement", "2");
    const std::size_t twice = count(s);
    s.set("t", "envelope", "0.5");
    CHECK(count(s) == once);
    s.set("t", "refinementPropagation", "1");
    CHECK(count(s) > once);
    s.set("t", "refinementPropagation", "0");
    s.set("t", "envelope", "1");
    s.set("t", "surfaceRefinement", "0");
    const std::size_t none = count(s);
    CHECK(none < once);
    CHECK(once < twice);
    CHECK(twice < 6 * none); // the cap alone is refined
    SECTION("one number counts for all vertices, none for 1 everywhere") {
        s.set("t", "surfaceRefinement", "1");
        s.set("t", "weights", "[1]");
        const std::size_t all = count(s);
        CHECK(all > once);
        s.set("t", "weights", "[]");
        CHECK(count(s) == all);
    }
}

TEST_CASE("zTet's border is a closed mesh on the tets' vertices, of the user's tets too", "[nodes]") {
    Session s(ball(R"(, "weights": {"from": "top.outWeights"})") +
              R"(, "own": {"type": "zTet", "inputs": {"tets": {"from": "t.outTets"}}})");
    const auto tets = s.get<nodes::TetMeshValue>("t", "outTets").mesh;
    const auto border = s.get<nodes::Mesh>("t", "outMesh");
    CHECK(*border.points == tets->vertices);
    CHECK(solver::is_closed(border.topology->triangles));
    double volume = 0;
    for (const solver::Tet& t : tets->tets) {
        const auto at = [&](int v) { return tets->vertices[static_cast<std::size_t>(v)]; };
        volume += solver::tet_volume(at(t[0]), at(t[1]), at(t[2]), at(t[3]));
    }
    CHECK(solver::enclosed_volume(*border.points, border.topology->triangles) == Approx(volume).epsilon(1e-12));
    CHECK(s.pull("own", "outMesh").digest() == s.pull("t", "outMesh").digest());
}

TEST_CASE("zTet refuses weights for another mesh and refinement past maxResolution, by name", "[nodes]") {
    Session s(ball(""));
    std::string text;
    s.set("t", "weights", "[1, 0, 1]");
    CHECK(codes([&] { count(s); }, &text) == Codes{"FE204"});
    CHECK(text.find("t.weights") != std::string::npos);
    s.set("t", "weights", "[1]");
    s.set("t", "maxResolution", "9");
    CHECK(codes([&] { count(s); }, &text) == Codes{"FE210"});
    CHECK(text.find("10 cubes along the longest side of 2, with a tet size of 0.4, refined 1 times") !=
          std::string::npos);
    CHECK(text.find("t.surfaceRefinement") != std::string::npos);
    s.set("t", "maxResolution", "10");
    CHECK(count(s) > 100);
    s.set("t", "surfaceRefinement", "0");
    s.set("t", "tetSize", "0.01");
    CHECK(codes([&] { count(s); }, &text) == Codes{"FE210"});
    CHECK(text.find("t.tetSize") != std::string::npos);
    CHECK(text.find("200 cubes along the longest side of 2, with a tet size of 0.01; the limit is 10") !=
          std::string::npos);
    CHECK(text.find("if the mesh is in another unit than the tet size, scale it by a transform") != std::string::npos);
    s.set("t", "tetSize", "1000");
    CHECK(codes([&] { count(s); }, &text) == Codes{"FE210"});
    CHECK(text.find("t.tetSize") != std::string::npos);
    CHECK(text.find("too large for this mesh") != std::string::npos);
}

TEST_CASE("zTet's fill modes reach the lattice, and an open mesh is told where it is open", "[nodes]") {
    Session s(ball(R"(, "fillInterior": "SurfaceOnly")"));
    const std::size_t shell = count(s);
    s.set("t", "fillInterior", "\"FilledCavities\"");
    const std::size_t filled = count(s);
    s.set("t", "fillInterior", "\"EmptyCavities\"");
    CHECK(count(s) == filled);
    CHECK(shell < filled);
    const Folder folder;
    // A tetrahedron without its floor.
    const std::string file =
        folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    Session open(R"("m": {"type": "meshFile", "inputs": {"file": ")" + file + R"("}},
        "t": {"type": "zTet", "inputs": {"mesh": {"from": "m.outMesh"}, "fillInterior": "EmptyCavities"}})");
    std::string text;
    CHECK(codes([&] { count(open); }, &text) == Codes{"FE220"});
    CHECK(text.find("3 border edges, the first between vertices 0-1, 2-0, 1-2") != std::string::npos);
    CHECK(text.find("t.fillInterior") != std::string::npos);
    open.set("t", "fillInterior", "\"FilledCavities\"");
    CHECK(count(open) > 10);
}

TEST_CASE("meshing is kept by its inputs, says how far it is and can be cancelled", "[nodes]") {
    const auto g = graph(ball("", "0.1"));
    Watch watch;
    engine::Evaluator evaluator({}, 1, &watch);
    watch.stop_at = 4;
    CHECK_THROWS_AS(evaluator.pull({g, {"t", "outTets"}, 1, watch.stop.get_token()}), engine::Cancelled);
    CHECK(watch.reports <= 6);
    evaluator.pull({g, {"t", "outTets"}, 1});
    CHECK(watch.phases.size() >= 4);
    CHECK(watch.last == 1);
    const int reports = watch.reports;
    evaluator.pull({g, {"t", "outTets"}, 7});
    const auto edited = engine::Edit(g).set_json({"top", "start"}, "0.1").commit().graph;
    evaluator.pull({edited, {"t", "outTets"}, 1});
    CHECK(watch.reports == reports);
}

TEST_CASE("zTet makes the moments that its element needs, and they count in digest and size", "[nodes]") {
    Session s(ball(""));
    const auto linear = s.get<nodes::TetMeshValue>("t", "outTets");
    s.set("t", "element", "\"quadratic\"");
    const auto quadratic = s.get<nodes::TetMeshValue>("t", "outTets");
    CHECK(linear.mesh->cut.degree == 1);
    CHECK(quadratic.mesh->cut.degree == 4);
    CHECK(linear.mesh->cut.tets == quadratic.mesh->cut.tets);
    REQUIRE_FALSE(linear.mesh->cut.tets.empty());
    CHECK(linear.with_element(quadratic.element).digest != quadratic.digest);
    CHECK(engine::ValueTraits<nodes::TetMeshValue>::bytes(quadratic) -
              engine::ValueTraits<nodes::TetMeshValue>::bytes(linear) ==
          31 * sizeof(double) * linear.mesh->cut.tets.size());
    solver::TetMesh other = *quadratic.mesh;
    other.cut.moments.back() *= 1 + 1e-15;
    CHECK(nodes::TetMeshValue::from(other).digest != nodes::TetMeshValue::from(*quadratic.mesh).digest);
}

TEST_CASE("a lattice made for linear tets is refused where zTet.element is quadratic", "[nodes]") {
    Session s(ball("") +
              R"(, "u": {"type": "zTet", "inputs": {"tets": {"from": "t.outTets"}, "element": "quadratic"}})");
    std::string text;
    CHECK(codes([&] { s.pull("u", "outTets"); }, &text) == Codes{"DG110"});
    CHECK(text.find("Set element to quadratic on the zTet that makes the lattice") != std::string::npos);
    s.set("t", "element", "\"quadratic\"");
    CHECK(s.get<nodes::TetMeshValue>("u", "outTets").digest == s.get<nodes::TetMeshValue>("t", "outTets").digest);
    s.set("u", "element", "\"linear\""); // the other way round all is known
    CHECK(s.get<nodes::TetMeshValue>("u", "outTets").element == solver::ElementKind::linear);
}
