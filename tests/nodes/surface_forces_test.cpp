// Pressure and surface tension from end to end: what zMaterial and zTissue say about them, in any scene unit.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "solver/mesh/surface_mesh.h"

#include <cmath>

using namespace bench;

namespace {

/// A ball of 5 cm in its lattice that nothing holds; `u` scene units a metre.
std::string ball(double u, const std::string& material, const std::string& tissue = "",
                 const std::string& element = "linear", const std::string& more_materials = "") {
    return R"("mesh": {"type": "polySphere", "inputs": {"radius": )" + number(0.05 * u) +
           R"(, "subdivisionsAxis": 24, "subdivisionsHeight": 24}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1000, "poissonsRatio": 0.45, )" +
           material + R"(}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": )" +
           number(0.03 * u) + R"(, "element": ")" + element + R"("}},
        "ball": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"},
            "material": "LogNeoHookean", "materials": [{"from": "flesh.outMaterial"})" +
           more_materials + "]" + tissue + R"(}},
        "solver": {"type": "zSolver", "inputs": {"scale": )" +
           number(u) + R"(, "maxNewtonIterations": 40, "gravity": [0, 0, 0], "bodies": [{"from": "ball.outBody"}]}})";
}

solver::Points points(Session& s, double frame) {
    return *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[0].points;
}

/// Mean stretch since the start frame, by the volume inside.
double stretch(Session& s, double frame) {
    const nodes::Mesh mesh = s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[0];
    const auto triangles = mesh.surface().triangles;
    return std::cbrt(solver::enclosed_volume(*mesh.points, triangles) /
                     solver::enclosed_volume(points(s, 1), triangles));
}

solver::Vec3 way(Session& s, double frame) {
    const solver::Points from = points(s, 1), to = points(s, frame);
    solver::Vec3 out = solver::Vec3::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) out += (to[i] - from[i]) / static_cast<double>(from.size());
    return out;
}

} // namespace

TEST_CASE("pressure and tension of a material press a ball to the stretch of the tables, in any unit", "[nodes]") {
    // Bonet and Wood's law under 500 Pa, and under Laplace's 2 x 25 / (0.05 l) Pa.
    for (const char* element : {"linear", "quadratic"}) {
        solver::Points in_metres[2];
        for (const double u : {1.0, 100.0, 0.01}) {
            Session pressed(ball(u, R"("pressure": 500)", "", element));
            CHECK(stretch(pressed, 20) == Approx(0.95699924).epsilon(1e-3));
            Session tense(ball(u, R"("surfaceTension": 25)", "", element));
            CHECK(stretch(tense, 20) == Approx(0.91864104).epsilon(2e-3));
            CHECK(pressed.counter.warnings.empty());
            int k = 0;
            for (Session* s : {&pressed, &tense}) {
                solver::Points now = points(*s, 20);
                for (solver::Vec3& p : now) p /= u;
                if (u == 1) in_metres[k] = now;
                CHECK(largest_difference(now, in_metres[k++]) < 1e-7);
            }
        }
    }
}

TEST_CASE("envelopes multiply pressure and tension, push the other way below 0, and may be keyed", "[nodes]") {
    Session half(ball(1, R"("pressure": 500)", R"(, "pressureEnvelope": 0.5)"));
    Session same(ball(1, R"("pressure": 250)"));
    CHECK(largest_difference(points(half, 6), points(same, 6)) < 1e-12);
    Session out(ball(1, R"("pressure": 500, "surfaceTension": 5)",
                     R"(, "pressureEnvelope": -0.5, "surfaceTensionEnvelope": -1)"));
    Session also_out(ball(1, R"("pressure": -250, "surfaceTension": -5)"));
    CHECK(stretch(out, 6) > 1.01);
    CHECK(largest_difference(points(out, 6), points(also_out, 6)) < 1e-12);

    Session keyed(ball(1, R"("pressure": 500)", R"(, "pressureEnvelope": {"keys": [[1, 0], [4, 0], [6, 1]]})"));
    CHECK(stretch(keyed, 4) == Approx(1).epsilon(1e-9));
    CHECK(stretch(keyed, 20) == Approx(0.95699924).epsilon(1e-3));
    const int steps = keyed.counter.steps["solver"];
    keyed.set("ball", "pressureEnvelope", R"({"keys": [[1, 0], [4, 0], [6, -0.2]]})");
    points(keyed, 4);
    CHECK(keyed.counter.steps["solver"] == steps); // earlier frames stand
    CHECK(stretch(keyed, 20) > 1);
    CHECK(keyed.get<nodes::SolveReport>("solver", "outReport", 20).terms.back() == "pressure");
    Session none(ball(1, R"("pressure": 0)"));
    for (const std::string& term : none.get<nodes::SolveReport>("solver", "outReport", 2).terms)
        CHECK(term != "pressure"); // nothing is made of it
}

TEST_CASE("painted pressure acts where the layer is painted, times what its envelope leaves", "[nodes]") {
    // A layer that covers the lower half more and more: 1000 Pa at the bottom to 0 at the top lift the ball by the
    // gradient times the volume, whatever carries it.
    const std::string paint =
        R"(, "low": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp",
        "axis": "y", "start": 0.05, "end": -0.05}},
        "water": {"type": "zMaterial", "inputs": {"youngsModulus": 1e6, "pressure": 1000, "envelope": )";
    const auto painted = [&](const std::string& envelope, const std::string& element) {
        return ball(1, R"("massDensity": 5000)", "", element, R"(, {"from": "water.outMaterial"})") + paint + envelope +
               R"(, "massDensity": 5000, "weights": {"from": "low.outWeights"}}})";
    };
    const double acceleration = 1000 / 0.1 / 5000, h = 1.0 / 24;
    for (const char* element : {"linear", "quadratic"}) {
        Session s(painted("1", element));
        CHECK(way(s, 3).y() == Approx(3 * acceleration * h * h).epsilon(0.03)); // backward Euler: 1 + 2
        CHECK(std::abs(way(s, 3).x()) < 1e-3 * way(s, 3).y());
        Session weak(painted("0.25", element));
        CHECK(way(weak, 3).y() == Approx(0.25 * 3 * acceleration * h * h).epsilon(0.03));
    }
}

TEST_CASE("pressure on a mesh that is open or looks inwards is warned of", "[nodes]") {
    const Folder folder;
    const auto warnings = [&](const std::string& faces, const std::string& material) {
        const std::string file = folder.write("tet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" + faces);
        Session s(R"("mesh": {"type": "meshFile", "inputs": {"file": ")" + file + R"("}},
            "flesh": {"type": "zMaterial", "inputs": {)" +
                  material + R"(}}, "body": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"},
            "materials": [{"from": "flesh.outMaterial"}]}})");
        s.pull("body", "outBody");
        std::string text;
        for (const engine::Diagnostic& d : s.counter.warnings) text += d.code + " " + d.attribute + " " + d.message;
        return text;
    };
    const std::string outwards = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n",
                      inwards = "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n", open = "f 1 3 2\nf 1 2 4\nf 2 3 4\n";
    const std::string pressed = R"("pressure": 10)", tense = R"("surfaceTension": 10)";
    CHECK(warnings(outwards, pressed).empty());
    CHECK_THAT(warnings(inwards, pressed),
               Catch::StartsWith("FE245 mesh") &&
                   Catch::Contains("look inwards, so its pressure acts the other way than it says"));
    // Half a square metre is missing of 1.5 + sqrt(3)/2.
    CHECK_THAT(warnings(open, pressed), Catch::StartsWith("FE245 mesh") && Catch::Contains("by 27 %"));
    for (const std::string& faces : {outwards, inwards, open}) CHECK(warnings(faces, tense).empty());
}
