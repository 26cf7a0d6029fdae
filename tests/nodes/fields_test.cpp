// The field nodes from end to end: what their numbers mean in any scene unit, whom they reach, keys over time.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include <cmath>

using namespace bench;

namespace {

std::string triple(double x, double y, double z) { return "[" + number(x) + ", " + number(y) + ", " + number(z) + "]"; }

/// A field node "f".
std::string field(const std::string& type, const std::string& inputs, const std::string& name = "f") {
    return ", \"" + name + R"(": {"type": ")" + type + R"(", "inputs": {)" + inputs + "}}";
}

/// A ball of 0.2 m in its lattice that nothing holds; `u` scene units a metre.
std::string ball(double u, const std::string& field, const std::string& solver_inputs = "",
                 const std::string& element = "linear") {
    return R"("mesh": {"type": "polySphere", "inputs": {"radius": )" + number(0.1 * u) +
           R"(, "subdivisionsAxis": 10, "subdivisionsHeight": 8}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 2e4}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": )" +
           number(0.08 * u) + R"(, "element": ")" + element + R"("}},
        "ball": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"},
                                               "materials": [{"from": "flesh.outMaterial"}]}},
        "solver": {"type": "zSolver", "inputs": {"scale": )" +
           number(u) +
           R"(, "maxNewtonIterations": 40, "bodies": [{"from": "ball.outBody"}], "forces": [{"from": "f.outForce"}])" +
           solver_inputs + "}}" + field;
}

solver::Points points(Session& s, double frame, std::size_t body = 0) {
    return *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[body].points;
}

/// How far the middle of the body has come since the start frame, in scene units.
solver::Vec3 way(Session& s, double frame, std::size_t body = 0) {
    const solver::Points from = points(s, 1, body), to = points(s, frame, body);
    solver::Vec3 out = solver::Vec3::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) out += (to[i] - from[i]) / static_cast<double>(from.size());
    return out;
}

const std::string weightless = R"(, "gravity": [0, 0, 0])";

} // namespace

TEST_CASE("a reference's air field of magnitude 1,040,000 at scale 100 is 10,400 N/m^3, and holds flesh in its lattice",
          "[nodes]") {
    // 1060 kg/m^3 weigh 10,388 N/m^3; a second's fall is 490 scene units.
    for (const char* element : {"linear", "quadratic"}) {
        Session s(ball(100, field("airField", R"("magnitude": 10400, "direction": [0, 1, 0])"), "", element));
        const solver::Vec3 moved = way(s, 25);
        INFO(element << ": " << moved.transpose());
        CHECK(moved.norm() < 4.9);
        CHECK(moved.y() > 0.1); // what 12 N/m^3 too much lift
        CHECK(s.counter.warnings.empty());
        const auto report = s.get<nodes::SolveReport>("solver", "outReport", 25);
        CHECK(report.terms.back() == "field");
    }
}

TEST_CASE("the same fields in metres and in centimetres move a body alike", "[nodes]") {
    const auto fields = [](double u) {
        return std::vector<std::pair<std::string, std::string>>{
            {"uniformField", R"("attenuation": 1, "referenceDistance": )" + number(0.2 * u) + R"(, "translate": )" +
                                 triple(0.5 * u, 0, 0)},
            {"gravityField", R"("magnitude": 3, "direction": [1, 1, 0])"},
            {"airField", R"("useMaxDistance": true, "airSpeed": 2, "maxDistance": )" + number(0.3 * u) +
                             R"(, "translate": )" + triple(0, 0.25 * u, 0)},
            {"newtonField", R"("magnitude": 5, "referenceDistance": )" + number(0.3 * u) + R"(, "translate": )" +
                                triple(0, -0.5 * u, 0)},
            {"radialField",
             R"("referenceDistance": )" + number(0.1 * u) + R"(, "translate": )" + triple(0, 0, 0.2 * u)},
            {"vortexField",
             R"("referenceDistance": )" + number(0.1 * u) + R"(, "translate": )" + triple(0.2 * u, 0, 0.1 * u)},
            {"turbulenceField",
             R"("magnitude": 3000, "noiseLevel": 1, "rate": 0.2, "phase": [0.5, 0, 0], "frequency": )" + number(4 / u)},
            {"volumeAxisField", R"("aroundAxis": 1, "volumeShape": "cylinder", "radius": )" + number(0.4 * u) +
                                    R"(, "height": )" + number(u) + R"(, "translate": )" + triple(0.1 * u, 0, 0)},
        };
    };
    const auto metres = fields(1), centimetres = fields(100);
    for (std::size_t k = 0; k < metres.size(); ++k) {
        INFO(metres[k].first);
        Session a(ball(1, field(metres[k].first, metres[k].second), weightless));
        Session b(ball(100, field(centimetres[k].first, centimetres[k].second), weightless));
        const solver::Points small = points(a, 7), large = points(b, 7);
        double worst = 0, moved = 0;
        for (std::size_t i = 0; i < small.size(); ++i) {
            worst = std::max(worst, (large[i] / 100 - small[i]).norm());
            moved = std::max(moved, (small[i] - points(a, 1)[i]).norm());
        }
        CHECK(moved > 0.002);
        CHECK(worst < 1e-5 * moved);
        CHECK(a.counter.warnings.empty());
    }
}

TEST_CASE("fields push where their attributes say", "[nodes]") {
    const auto way_of = [](const std::string& type, const std::string& inputs) {
        Session s(ball(100, field(type, inputs), weightless));
        return way(s, 5);
    };
    // Uniform acceleration a over 4 steps of backward Euler: 10 a h^2; 1000/1060 m/s^2 here.
    const double one = 100 * 10 * 1000.0 / 1060 / (24.0 * 24);
    CHECK((way_of("uniformField", "") - solver::Vec3(one, 0, 0)).norm() < 1e-6 * one);
    CHECK(
        (way_of("uniformField", R"("magnitude": -500, "direction": [0, 0, 9])") - solver::Vec3(0, 0, -one / 2)).norm() <
        1e-6 * one);
    CHECK((way_of("gravityField", R"("direction": [0, 0, 1], "magnitude": )" + number(1000.0 / 1060)) -
           solver::Vec3(0, 0, one))
              .norm() < 1e-6 * one);
    CHECK((way_of("radialField", R"("translate": [-300, 0, 0])") - solver::Vec3(one, 0, 0)).norm() < 1e-3 * one);
    CHECK((way_of("radialField", R"("translate": [-300, 0, 0], "attenuation": 1, "referenceDistance": 30)") -
           solver::Vec3(one / 10, 0, 0))
              .norm() < 1e-3 * one);
    CHECK((way_of("newtonField",
                  R"("translate": [0, 3000, 0], "referenceDistance": 1000, "magnitude": )" + number(9000.0 / 1060)) -
           solver::Vec3(0, one, 0))
              .norm() < 2e-3 * one);
    CHECK((way_of("vortexField", R"("translate": [0, 0, 300])") - solver::Vec3(-one, 0, 0)).norm() < 2e-3 * one);
    CHECK(way_of("radialField", R"("translate": [-300, 0, 0], "useMaxDistance": true, "maxDistance": 200)").norm() ==
          0);
    CHECK(way_of("dragField", "").norm() == 0);
    CHECK((way_of("volumeAxisField",
                  R"("radius": 100, "awayFromCenter": 0, "directionalSpeed": 0.5, "direction": [0, 0, 1])") -
           solver::Vec3(0, 0, one / 2))
              .norm() < 1e-6 * one);
    CHECK((way_of("volumeAxisField", R"("radius": 900, "translate": [-300, 0, 0])") - solver::Vec3(one, 0, 0)).norm() <
          1e-3 * one);
    // At phase 0 the ball sits in a knot of the noise.
    const std::string off = R"("phase": [0.3, 0.6, 0.2])";
    CHECK(way_of("turbulenceField", off).norm() > 0.1 * one);
    CHECK(way_of("turbulenceField", off) == way_of("turbulenceField", off));
    CHECK(way_of("turbulenceField", off + R"(, "rate": 0.5)") != way_of("turbulenceField", off));
}

TEST_CASE("a field acts on the tissues it names, or on all", "[nodes]") {
    const auto two = [](const std::string& bodies) {
        return ball(
            100,
            R"(, "other": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "materials": [{"from": "heavy.outMaterial"}]}},
            "heavy": {"type": "zMaterial", "inputs": {"massDensity": 2120}})" +
                field("uniformField", bodies),
            weightless +
                R"(, "solverToleranceFactor": 1e-3, "bodies": [{"from": "ball.outBody"}, {"from": "other.outBody"}])");
    };
    // The later "bodies" would be a repeated key: put both into the first.
    std::string all = two(""), named = two(R"("bodies": [{"from": "other.outBody"}])");
    for (std::string* text : {&all, &named}) {
        const std::string first = R"("bodies": [{"from": "ball.outBody"}], )";
        text->erase(text->find(first), first.size());
    }
    Session a(all), b(named);
    CHECK(way(a, 4, 0).x() == Approx(2 * way(a, 4, 1).x()).epsilon(1e-5));
    CHECK(way(b, 4, 0).norm() < 1e-12);
    CHECK(way(b, 4, 1).x() == Approx(way(a, 4, 1).x()).epsilon(1e-7));
}

TEST_CASE("what a field does to a body counts while the body is on", "[nodes]") {
    Session s(ball(1, field("uniformField", R"("magnitude": 3)"), weightless));
    s.set("ball", "enable", R"({"keys": [[1, true], [3, false]]})");
    const auto force = [&](double frame) {
        return solver::value_of(s.get<nodes::SolveReport>("solver", "outReport", frame).record.measured, "field",
                                "force_x_N");
    };
    const auto mesh = s.get<nodes::Mesh>("mesh", "outMesh", 1);
    const double volume = solver::enclosed_volume(*mesh.points, mesh.surface().triangles);
    CHECK(force(2) == Approx(3 * volume).epsilon(1e-6)); // [N/m^3]
    CHECK(force(3) == 0);
}

TEST_CASE("a field keyed at a later frame leaves earlier frames alone", "[nodes]") {
    Session s(ball(1, field("airField", R"("magnitude": {"keys": [[1, 0], [4, 0], [5, 800]]})")));
    points(s, 6);
    CHECK(s.counter.steps["solver"] == 6);
    s.set("f", "magnitude", R"({"keys": [[1, 0], [4, 0], [5, 900]]})");
    points(s, 4);
    CHECK(s.counter.steps["solver"] == 6);
    points(s, 6);
    CHECK(s.counter.steps["solver"] == 8);
}

TEST_CASE("fields that cannot be used are refused where they stand", "[nodes]") {
    const auto of = [](const std::string& type, const std::string& inputs, std::string* text = nullptr) {
        return codes(ball(1, R"(, "bone": {"type": "zBone", "inputs": {"mesh": {"from": "mesh.outMesh"}}})" +
                                 field(type, inputs)),
                     "solver", "outMeshes", text, 2);
    };
    std::string text;
    CHECK(of("uniformField", R"("direction": [0, 0, 0])", &text) == Codes{"FE304"});
    CHECK_THAT(text, Catch::Contains("f.direction") && Catch::Contains("zero"));
    CHECK(of("vortexField", R"("axis": [0, 0, 0])", &text) == Codes{"FE304"});
    CHECK_THAT(text, Catch::Contains("f.axis"));
    CHECK(of("airField", R"("bodies": [{"from": "bone.outBody"}])", &text) == Codes{"FE218"});
    CHECK_THAT(text, Catch::Contains("f.bodies") && Catch::Contains("bone is a bone"));
    CHECK(of("dragField", R"("magnitude": -1)") == Codes{"DG013"});
    CHECK(of("airField", R"("airSpeed": 0)") == Codes{"DG013"});
    CHECK(of("newtonField", R"("attenuation": -1)") == Codes{"DG013"});
    CHECK(of("dragField", R"("direction": [0, 0, 0])").empty()); // not asked for
}
