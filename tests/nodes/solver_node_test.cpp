// zSolver from end to end on small beams: frames, units, the rules across bodies and attachments, restarts,
// bits.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

using namespace bench;

namespace {

/// A soft beam of 1 m x 0.25 m x 0.25 m, tied at its -x end to a bone block that can move; `u` scene units a
/// metre.
std::string beam(double u, const std::string& solver_inputs = "", const std::string& extra = "") {
    const std::string size = R"("inputs": {"width": )" + number(u) + R"(, "height": )" + number(u / 4) +
                             R"(, "depth": )" + number(u / 4) +
                             R"(, "subdivisionsWidth": 8, "subdivisionsHeight": 2, "subdivisionsDepth": 2}})";
    return R"("mesh": {"type": "polyCube", )" + size + R"(, "box": {"type": "polyCube", "inputs": {"width": )" +
           number(u / 4) + R"(, "height": )" + number(u / 4) + R"(, "depth": )" + number(u / 4) + R"(}},
        "place": {"type": "transform", "inputs": {"translate": {"keys": [[1, [)" +
           number(-0.625 * u) + R"(, 0, 0]], [4, [)" + number(-0.625 * u) + ", " + number(0.05 * u) +
           R"(, 0]]]}}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "box.outMesh"}, "matrix": {"from": "place.outMatrix"}}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 2e5}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": )" +
           number(u / 6) + R"(}},
        "beam": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "end": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "start": )" +
           number(-0.49 * u) + R"(, "end": )" + number(-0.5 * u) + R"(}},
        "tie": {"type": "zAttachment", "inputs": {"source": {"from": "beam.outBody"}, "target": {"from": "bone.outBody"}, "weights": {"from": "end.outWeights"}}},
        "solver": {"type": "zSolver", "inputs": {"scale": )" +
           number(u) + R"(, "maxNewtonIterations": 40,
            "bodies": [{"from": "bone.outBody"}, {"from": "beam.outBody"}], "attachments": [{"from": "tie.outAttachment"}])" +
           solver_inputs + "}}" + extra;
}

solver::Points points(Session& s, double frame, std::size_t body = 1) {
    return *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[body].points;
}

} // namespace

TEST_CASE("a beam sags under gravity, follows its bone and reports how it converged", "[nodes]") {
    Session s(beam(1));
    const solver::Points rest = *s.get<nodes::Mesh>("mesh", "outMesh").points;
    CHECK(largest_difference(points(s, 1), rest) < 1e-14);
    const solver::Points now = points(s, 8);
    double tip = 0, held = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        if (rest[i].x() > 0.49) tip = std::min(tip, now[i].y() - rest[i].y());
        if (rest[i].x() < -0.49) held = std::max(held, (now[i] - rest[i] - solver::Vec3(0, 0.05, 0)).norm());
    }
    CHECK(tip < -0.005);
    CHECK(held < 0.004);
    const auto report = s.get<nodes::SolveReport>("solver", "outReport", 8);
    CHECK(report.record.converged);
    CHECK(report.record.inverted == 0);
    CHECK(report.bodies == 2);
    CHECK(report.tets == static_cast<std::int64_t>(s.get<nodes::TetMeshValue>("tets", "outTets").mesh->tets.size()));
    CHECK(report.dofs ==
          3 * static_cast<std::int64_t>(s.get<nodes::TetMeshValue>("tets", "outTets").mesh->vertices.size()));
    CHECK(report.triangles == 12 + 144);
    CHECK(report.attachments == 1);
    CHECK(report.terms ==
          std::vector<std::string>{"StVK", "compressionResistance", "gravity", "inertia", "damping", "attachment"});
    CHECK(s.counter.warnings.empty());
    CHECK(s.counter.steps["solver"] == 8); // the start state and seven steps
}

TEST_CASE("the integrator may be keyed: the scheme of each frame is the one that stands there", "[nodes]") {
    const std::string keys = R"(, "integrator": {"keys": [[1, "QuasiStatic"], [3, "BDF2"], [5, "TR-BDF2"]]})";
    Session keyed(beam(1, keys)), still(beam(1, R"(, "integrator": "QuasiStatic")"));
    CHECK(points(keyed, 2) == points(still, 2));
    CHECK(largest_difference(points(keyed, 4), points(still, 4)) > 1e-5);
    for (const double frame : {3., 4., 5., 6., 7.}) {
        (void)points(keyed, frame);
        CHECK(keyed.get<nodes::SolveReport>("solver", "outReport", frame).record.converged);
    }
    // TR-BDF2 solves twice a step.
    const auto newton = [&](double frame) {
        return keyed.get<nodes::SolveReport>("solver", "outReport", frame).record.newton_iterations;
    };
    CHECK(newton(6) > newton(4));
}

TEST_CASE("TR-BDF2 sees what is keyed at gamma of each sub-step, other schemes read the ends alone", "[nodes]") {
    // At whole frames the bone stands still all the time; at gamma of frame 5 to 6 it is somewhere else.
    const std::string still = R"({"keys": [[1, [-0.625, 0, 0]], [5.2, [-0.625, 0, 0]], [5.5858, [-0.625, Y, 0]],
                                           [5.8, [-0.625, 0, 0]]], "interp": "linear"})";
    const auto keys = [&](const char* y) {
        std::string text = still;
        return text.replace(text.find('Y'), 1, y);
    };
    for (const char* scheme : {"BackwardEuler", "BDF2", "TR-BDF2", "QuasiStatic"}) {
        Session s(beam(1, R"(, "integrator": ")" + std::string(scheme) + "\""));
        s.set("place", "translate", keys("0"));
        const solver::Points before = points(s, 5), after = points(s, 8);
        s.counter.steps.clear();
        s.set("place", "translate", keys("0.02"));
        const bool sees = std::string(scheme) == "TR-BDF2";
        INFO(scheme);
        CHECK(points(s, 5) == before);
        CHECK(s.counter.steps["solver"] == 0);
        CHECK((largest_difference(points(s, 8), after) > 1e-4) == sees);
        CHECK(s.counter.steps["solver"] == (sees ? 3 : 0)); // frames 6 to 8
        CHECK(s.counter.warnings.empty());
    }
}

TEST_CASE("under a bone that is keyed through the graph TR-BDF2 is of second order", "[nodes]") {
    // The bone turns by up to 0.12 rad a frame about a point outside of it, along a smooth curve of two keys.
    const auto tip = [](int substeps) {
        Session s(beam(1, R"(, "integrator": "TR-BDF2", "solverToleranceFactor": 1e-3, "substeps": )" +
                              std::to_string(substeps)));
        s.set("place", "translate", "[-0.625, 0, 0]");
        s.set("place", "rotate", R"({"keys": [[1, [0, 0, 0]], [13, [0, 0, 50]]], "interp": "smooth"})");
        const solver::Points p = points(s, 9);
        CHECK(s.get<nodes::SolveReport>("solver", "outReport", 9).record.converged);
        return p;
    };
    const solver::Points truth = tip(64);
    const double coarse = largest_difference(tip(4), truth), fine = largest_difference(tip(8), truth);
    INFO(coarse << " " << fine);
    CHECK(coarse < 1e-2);
    CHECK(std::log2(coarse / fine) > 1.7);
}

TEST_CASE("bones pass through the solver as they are", "[nodes]") {
    Session s(beam(100));
    CHECK(points(s, 3, 0) == *std::get<nodes::Mesh>(s.get<nodes::Body>("bone", "outBody", 3).values).points);
}

TEST_CASE("the same scene in metres and in centimetres moves alike", "[nodes]") {
    const std::string options = R"(, "substeps": 2)";
    Session metres(beam(1, options)), centimetres(beam(100, options));
    for (double frame : {2.0, 5.0}) {
        const solver::Points a = points(metres, frame);
        solver::Points b = points(centimetres, frame);
        for (solver::Vec3& p : b) p /= 100;
        CHECK(largest_difference(a, b) < 1e-9);
    }
}

TEST_CASE("sub-steps read the bone at their own times", "[nodes]") {
    Session one(beam(1)), four(beam(1, R"(, "substeps": 4)"));
    CHECK(four.get<nodes::SolveReport>("solver", "outReport", 2).record.substeps == 4);
    CHECK(largest_difference(points(one, 4), points(four, 4)) > 1e-6);
}

TEST_CASE("a body in free fall moves by what each sub-step and stage reads of keyed gravity", "[nodes]") {
    // Gravity grows from 0 at frame 2 to 8 m/s^2 at frame 3; a body that falls freely does not deform.
    const auto fall = [](const std::string& inputs) {
        Session s(R"("mesh": {"type": "polyCube"}, "flesh": {"type": "zMaterial"},
            "body": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}},
            "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "body.outBody"}], "massDamping": 0,
                "solverToleranceFactor": 1e-6, "gravity": {"keys": [[1, [0, 0, 0]], [2, [0, 0, 0]], [3, [0, -8, 0]]]}, )" +
                  inputs + "}}");
        const solver::Points rest = points(s, 1, 0), now = points(s, 3, 0);
        CHECK(s.counter.warnings.empty());
        const double y = now[0].y() - rest[0].y();
        for (std::size_t i = 0; i < rest.size(); ++i)
            CHECK((now[i] - rest[i] - solver::Vec3(0, y, 0)).norm() < 1e-9 * std::abs(y));
        return y;
    };
    const double h = 1.0 / 24, q = h / 4;
    // v += h g, x += h v at the end of each step.
    CHECK(fall(R"("integrator": "BackwardEuler")") == Approx(-8 * h * h).epsilon(1e-9));
    // Gravity is 2, 4, 6 and 8 there: 2 (4 1 + 3 2 + 2 3 + 1 4).
    CHECK(fall(R"("integrator": "BackwardEuler", "substeps": 4)") == Approx(-40 * q * q).epsilon(1e-9));
    // TR-BDF2 (Bank et al. 1985): the trapezoidal rule to gamma, where gravity is 8 gamma, then BDF2.
    const double g = 2 - std::sqrt(2.0), half = 0.5 * g * h, v_g = half * 8 * g, x_g = half * v_g;
    const double middle = 1 / (g * (2 - g)), v = middle * v_g + half * 8, x = middle * x_g + half * v;
    CHECK(fall(R"("integrator": "TR-BDF2")") == Approx(-x).epsilon(1e-9));
}

TEST_CASE("stepHalvings says how often a step that fails is halved", "[nodes]") {
    const auto halvings = [](int allowed) {
        Session s(beam(1, R"(, "integrator": "BackwardEuler", "solverToleranceFactor": 1e-9, "stepHalvings": )" +
                              std::to_string(allowed)));
        s.set("solver", "maxNewtonIterations", "1");
        points(s, 3);
        return s.get<nodes::SolveReport>("solver", "outReport", 3).record.halvings;
    };
    CHECK(halvings(0) == 0);
    CHECK(halvings(1) == 1);
    CHECK(halvings(2) == 3); // the step and both of its halves
}

TEST_CASE("the body farthest from balance is counted in the solver's list, disabled ones too", "[nodes]") {
    Session s(beam(1, R"(, "solverToleranceFactor": 1e-9)", R"(, "mesh2": {"type": "polySphere"},
        "off": {"type": "zTissue", "inputs": {"enable": false, "mesh": {"from": "mesh2.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}})"));
    s.set("solver", "maxNewtonIterations", "1");
    s.set("solver", "bodies", R"([{"from": "off.outBody"}, {"from": "bone.outBody"}, {"from": "beam.outBody"}])");
    const auto report = s.get<nodes::SolveReport>("solver", "outReport", 3);
    CHECK(report.worst.residual_body == 2);
    CHECK(report.worst.body == 2);
    REQUIRE_FALSE(s.counter.warnings.empty());
    CHECK(s.counter.warnings[0].message.find("of beam after") != std::string::npos);
}

TEST_CASE("an unconverged frame warns with its residual and goes on", "[nodes]") {
    Session s(beam(1, R"(, "solverToleranceFactor": 1e-12)"));
    s.set("solver", "maxNewtonIterations", "1");
    points(s, 3);
    REQUIRE(s.counter.warnings.size() >= 1);
    for (const engine::Diagnostic& d : s.counter.warnings) {
        CHECK(d.code == "FE301");
        CHECK(d.node == "solver");
        CHECK(d.message.find("residual") != std::string::npos);
        CHECK(d.hint == "Raise maxNewtonIterations or substeps, or accept it with a larger solverToleranceFactor.");
    }
    CHECK_FALSE(s.get<nodes::SolveReport>("solver", "outReport", 3).record.converged);
}

TEST_CASE("where a step does not converge, a bone that has jumped is named", "[nodes]") {
    Session s(beam(1, R"(, "solverToleranceFactor": 1e-12)"));
    s.set("solver", "maxNewtonIterations", "1");
    const auto goes_to = [&](const char* y) {
        s.counter.warnings.clear();
        s.set("place", "translate",
              R"({"keys": [[2, [-0.625, 0, 0]], [3, [-0.625, )" + std::string(y) + R"(, 0]]], "interp": "linear"})");
        points(s, 3);
        REQUIRE_FALSE(s.counter.warnings.empty());
        return s.counter.warnings.back();
    };
    const engine::Diagnostic jumps = goes_to("100");
    CHECK(jumps.code == "FE301");
    CHECK(jumps.message.find("; bone has gone 100 in this frame, 231 times its size") != std::string::npos);
    CHECK(jumps.hint == "Look whether bone is meant to (the unit of its motion, a jump between keys); if it is, raise "
                        "substeps.");
    CHECK(goes_to("0.01").message.find("has gone") == std::string::npos);
}

TEST_CASE("a step that cannot be taken names the body to look at, and a bone that has jumped", "[nodes]") {
    const std::string second = R"(, "mesh2": {"type": "polySphere"},
        "ball": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh2.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}})";
    Session s(beam(1, "", second));
    s.set("solver", "bodies", R"([{"from": "ball.outBody"}, {"from": "bone.outBody"}, {"from": "beam.outBody"}])");
    s.set("place", "translate", R"({"keys": [[2, [-0.625, 0, 0]], [3, [-0.625, 1e12, 0]]], "interp": "linear"})");
    points(s, 2);
    try {
        points(s, 3);
        FAIL("that step can be taken");
    } catch (const engine::SolveFailure& failure) {
        REQUIRE(failure.diagnostics().size() == 1);
        const engine::Diagnostic& d = failure.diagnostics()[0];
        INFO(d.message);
        CHECK(d.code == "FE302");
        CHECK(d.message.starts_with("beam: the "));
        CHECK(d.hint ==
              "Look whether bone is meant to go 1e+12 in this frame, 2.31e+12 times its size (the unit of its "
              "motion, a jump between keys); if it is, raise substeps.");
    }
}

TEST_CASE("QuasiStatic needs every tissue tied to a bone by some chain", "[nodes]") {
    const std::string second = R"(, "mesh2": {"type": "polySphere"},
        "ball": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh2.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "chain": {"type": "zAttachment", "inputs": {"source": {"from": "ball.outBody"}, "target": {"from": "beam.outBody"}, "weights": [1]}})";
    Session s(beam(1, R"(, "integrator": "QuasiStatic")", second));
    points(s, 2);
    CHECK(s.get<nodes::SolveReport>("solver", "outReport", 2).terms ==
          std::vector<std::string>{"StVK", "compressionResistance", "gravity", "attachment"});
    s.set("solver", "bodies", R"([{"from": "bone.outBody"}, {"from": "beam.outBody"}, {"from": "ball.outBody"}])");
    std::string text;
    CHECK(codes([&] { s.pull("solver", "outMeshes", 2); }, &text) == Codes{"FE303"});
    CHECK(text.find("ball floats") != std::string::npos);
    CHECK_THROWS_AS(s.pull("solver", "outMeshes", 2), engine::SolveFailure);
    s.set("solver", "attachments", R"([{"from": "tie.outAttachment"}, {"from": "chain.outAttachment"}])");
    CHECK(codes([&] { s.pull("solver", "outMeshes", 1); }).empty());
    s.set("chain", "stiffness", "0");
    CHECK(codes([&] { s.pull("solver", "outMeshes", 1); }) == Codes{"FE303"});
    s.set("chain", "stiffness", "1000");
    CHECK(codes([&] { s.pull("solver", "outMeshes", 1); }).empty());
    s.set("chain", "envelope", "0");
    CHECK(codes([&] { s.pull("solver", "outMeshes", 1); }) == Codes{"FE303"});
}

TEST_CASE("bodies and attachments that do not fit together are refused by name", "[nodes]") {
    std::string text;
    Session s(beam(1));
    s.set("solver", "bodies", R"([{"from": "beam.outBody"}])");
    CHECK(codes([&] { s.pull("solver", "outMeshes"); }, &text) == Codes{"FE209"});
    CHECK(text.find("the target (bone) of tie is none of") != std::string::npos);
    s.set("solver", "bodies", R"([{"from": "bone.outBody"}, {"from": "beam.outBody"}, {"from": "beam.outBody"}])");
    CHECK(codes([&] { s.pull("solver", "outMeshes"); }, &text) == Codes{"FE213"});
    CHECK(text.find("beam is connected twice") != std::string::npos);
    s.set("solver", "bodies", "[]");
    CHECK(codes([&] { s.pull("solver", "outMeshes"); }) == Codes{"DG021"});
}

TEST_CASE("what is static may not change after the start frame", "[nodes]") {
    std::string text;
    Session s(beam(
        1, "",
        R"(, "grow": {"type": "transform", "inputs": {"mesh": {"from": "mesh.outMesh"}, "scale": {"keys": [[1, [1, 1, 1]], [3, [1, 1, 1]], [4, [2, 1, 1]]]}}})"));
    s.set("beam", "mesh", R"({"from": "grow.outMesh"})");
    CHECK(codes([&] { s.pull("solver", "outMeshes", 3); }).empty());
    CHECK(codes([&] { s.pull("solver", "outMeshes", 4); }, &text) == Codes{"FE211"});
    CHECK(text.find("the rest shape of beam") != std::string::npos);
}

TEST_CASE("disabled bodies are left out together with their attachments", "[nodes]") {
    Session s(beam(1));
    s.set("bone", "enable", "false");
    const auto report = s.get<nodes::SolveReport>("solver", "outReport", 2);
    CHECK(report.bodies == 1);
    CHECK(report.attachments == 0);
    const auto meshes = s.get<nodes::MeshList>("solver", "outMeshes", 2);
    REQUIRE(meshes.meshes.size() == 2);
    // Without its bone the beam falls freely: by g h^2 in one step of backward Euler.
    const solver::Points rest = *s.get<nodes::Mesh>("mesh", "outMesh").points;
    const double fall = (*meshes.meshes[1].points)[0].y() - rest[0].y();
    CHECK(fall == Approx(-9.8 / 24 / 24).epsilon(1e-5));
    s.set("beam", "enable", "false");
    CHECK(*s.get<nodes::MeshList>("solver", "outMeshes", 2).meshes[1].points == rest);
}

TEST_CASE("a solver that is off leaves tissues as modelled and moves bones", "[nodes]") {
    Session s(beam(1, R"(, "enable": false)"));
    CHECK(points(s, 4) == *s.get<nodes::Mesh>("mesh", "outMesh").points);
    CHECK(points(s, 4, 0) == *std::get<nodes::Mesh>(s.get<nodes::Body>("bone", "outBody", 4).values).points);
}

TEST_CASE("two bones of one mesh are told apart by where they stand", "[nodes]") {
    const std::string extra = R"(, "away": {"type": "transform", "inputs": {"translate": [0, 9, 0]}},
        "twin": {"type": "zBone", "inputs": {"mesh": {"from": "box.outMesh"}, "matrix": {"from": "away.outMatrix"}}})";
    Session plain(beam(1)), twins(beam(1, "", extra));
    twins.set("solver", "bodies", R"([{"from": "twin.outBody"}, {"from": "bone.outBody"}, {"from": "beam.outBody"}])");
    CHECK(points(plain, 3, 1) == points(twins, 3, 2));
}

TEST_CASE("what holds on to a bone that the solver does not have is not given another of the same faces", "[nodes]") {
    const std::string extra = R"(, "away": {"type": "transform", "inputs": {"translate": [0, 9, 0]}},
        "twin": {"type": "zBone", "inputs": {"mesh": {"from": "box.outMesh"}, "matrix": {"from": "away.outMatrix"}}},
        "hold": {"type": "zHold", "inputs": {"tissue": {"from": "beam.outBody"}, "bone": {"from": "twin.outBody"}}})";
    std::string text;
    Session s(beam(1, "", extra));
    s.set("solver", "bodies", R"([{"from": "twin.outBody"}, {"from": "beam.outBody"}])");
    CHECK(codes([&] { s.pull("solver", "outMeshes"); }, &text) == Codes{"FE209"});
    CHECK(text.find("the target (bone) of tie is none of") != std::string::npos);
    // Nor is it taken for one of the same faces that is switched off.
    s.set("twin", "enable", "false");
    CHECK(codes([&] { s.pull("solver", "outMeshes"); }) == Codes{"FE209"});
    Session held(beam(1, "", extra));
    held.set("solver", "forces", R"([{"from": "hold.outForce"}])");
    CHECK(codes([&] { held.pull("solver", "outMeshes"); }, &text) == Codes{"FE209"});
    CHECK(text.find("the bone (twin) of hold is none of") != std::string::npos);
    Session blown(beam(
        1, "",
        R"(, "wind": {"type": "uniformField", "inputs": {"bodies": [{"from": "beam.outBody"}, {"from": "rag.outBody"}]}},
        "rag": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh2.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "mesh2": {"type": "polySphere"})"));
    blown.set("solver", "forces", R"([{"from": "wind.outForce"}])");
    CHECK(codes([&] { blown.pull("solver", "outMeshes"); }, &text) == Codes{"FE209"});
    CHECK(text.find("the body (rag) of wind is none of") != std::string::npos);
}

TEST_CASE("two bones that are alike at the start may part later, whichever is held on to", "[nodes]") {
    // The twin of the bone stands where that starts, and stays there.
    const std::string twin = R"(, "stay": {"type": "transform", "inputs": {"translate": [-0.625, 0, 0]}},
        "twin": {"type": "zBone", "inputs": {"mesh": {"from": "box.outMesh"}, "matrix": {"from": "stay.outMatrix"}}})";
    for (const char* scheme : {R"(, "substeps": 3)", R"(, "integrator": "TR-BDF2")"})
        for (const char* target : {"bone", "twin"})
            for (const bool twin_first : {true, false}) {
                INFO(scheme << " held by " << target << (twin_first ? ", twin first" : ", bone first"));
                Session plain(beam(1, scheme, twin)), both(beam(1, scheme, twin));
                const std::string held = R"({"from": ")" + std::string(target) + R"(.outBody"})";
                plain.set("tie", "target", held);
                plain.set("solver", "bodies", "[" + held + R"(, {"from": "beam.outBody"}])");
                both.set("tie", "target", held);
                both.set("solver", "bodies",
                         twin_first
                             ? R"([{"from": "twin.outBody"}, {"from": "bone.outBody"}, {"from": "beam.outBody"}])"
                             : R"([{"from": "bone.outBody"}, {"from": "twin.outBody"}, {"from": "beam.outBody"}])");
                for (const double frame : {1.0, 2.0, 6.0}) CHECK(points(plain, frame, 1) == points(both, frame, 2));
                CHECK(both.counter.warnings.empty());
            }
    // One node twice is one body, and two tissues that are alike in all cannot be told apart.
    Session s(beam(1, "", twin));
    std::string text;
    s.set("solver", "bodies", R"([{"from": "bone.outBody"}, {"from": "bone.outBody"}, {"from": "beam.outBody"}])");
    CHECK(codes([&] { s.pull("solver", "outMeshes"); }, &text) == Codes{"FE213"});
    CHECK(text.find("bone is connected twice") != std::string::npos);
}

TEST_CASE("a motion that parts late costs no frame before it", "[nodes]") {
    const std::string twin = R"(, "stay": {"type": "transform", "inputs": {"translate": [-0.625, 0, 0]}},
        "twin": {"type": "zBone", "inputs": {"mesh": {"from": "box.outMesh"}, "matrix": {"from": "stay.outMatrix"}}})";
    Session s(beam(1, "", twin));
    s.set("place", "translate", R"([-0.625, 0, 0])");
    s.set("solver", "bodies", R"([{"from": "twin.outBody"}, {"from": "bone.outBody"}, {"from": "beam.outBody"}])");
    points(s, 6, 2);
    CHECK(s.counter.steps["solver"] == 6);
    s.set("place", "translate", R"({"keys": [[5, [-0.625, 0, 0]], [6, [-0.625, 0.1, 0]]]})");
    const solver::Points now = points(s, 6, 2);
    CHECK(s.counter.steps["solver"] == 7);
    Session fresh(beam(1));
    fresh.set("place", "translate", R"({"keys": [[5, [-0.625, 0, 0]], [6, [-0.625, 0.1, 0]]]})");
    CHECK(now == points(fresh, 6, 1));
}

TEST_CASE("a bone's matrix sent frame by frame costs one step a frame and gives the bits of the same keys", "[nodes]") {
    for (const char* scheme : {"", R"(, "substeps": 3)", R"(, "integrator": "TR-BDF2", "substeps": 2)"}) {
        INFO(scheme);
        Session keyed(beam(1, scheme)), live(beam(1, scheme));
        live.set("bone", "matrix", "[1,0,0,-0.625, 0,1,0,0, 0,0,1,0, 0,0,0,1]");
        for (int frame = 1; frame <= 6; ++frame) {
            const auto matrix = keyed.get<engine::Matrix4>("place", "outMatrix", frame);
            live.graph = engine::Edit(live.graph)
                             .set_input({"bone", "matrix"}, frame, engine::Value::of<engine::Matrix4>(matrix))
                             .commit()
                             .graph;
            CHECK(points(live, frame) == points(keyed, frame));
            CHECK(live.counter.steps["solver"] == frame); // the start state, then one a frame
        }
        for (int frame = 1; frame <= 6; ++frame) CHECK(points(live, frame, 0) == points(keyed, frame, 0));
        CHECK(live.counter.steps["solver"] == 6);
    }
}

TEST_CASE("a zSolver starts where the timing does and runs at its rate", "[nodes]") {
    Session s(beam(1)), slow(beam(1, R"(, "framesPerSecond": 12)"));
    const auto at_timing = [](Session& session, engine::Timing t) {
        session.graph = engine::Edit(session.graph).set_timing(t).commit().graph;
    };
    at_timing(s, {12, 1, 20});
    CHECK(points(s, 5) == points(slow, 5));
    Session late(beam(1));
    at_timing(late, {24, 3, 20});
    points(late, 4);
    CHECK(late.counter.steps["solver"] == 2);
}

TEST_CASE("tets behind a transform that stands still are made once", "[nodes]") {
    const auto computes = [](const std::string& inputs) {
        Session s(beam(
            1, "", R"(, "still": {"type": "transform", "inputs": {"mesh": {"from": "mesh.outMesh"})" + inputs + "}}"));
        s.set("tets", "mesh", R"({"from": "still.outMesh"})");
        s.set("beam", "mesh", R"({"from": "still.outMesh"})");
        s.set("end", "mesh", R"({"from": "still.outMesh"})");
        points(s, 5);
        return std::pair(s.counter.computes["still"], s.counter.computes["tets"]);
    };
    CHECK(computes(R"(, "rotate": [0, 0, 0.1])") == std::pair(1, 1));
    CHECK(computes(R"(, "rotate": {"keys": [[1, [0, 0, 0.1]], [9, [0, 0, 0.1]]]})") == std::pair(1, 1));
    // A recorded motion that stands still: the transform must look, what is behind it need not run.
    const Folder folder;
    const std::string path = folder.write("still.json", R"({"frames": [{"frame": 1, "bones":
        {"b": [1,0,0,0, 0,1,0,0.125, 0,0,1,0, 0,0,0,1]}}]})");
    CHECK(computes(R"(, "trackName": "b", "track": ")" + path + "\"") == std::pair(5, 1));
}

TEST_CASE("the report's places are those of its numbers", "[nodes]") {
    for (const auto& [element, units] : {std::pair{"linear", 1.0}, {"quadratic", 1.0}, {"linear", 100.0}}) {
        INFO(element << " " << units);
        Session s(beam(units));
        s.set("tets", "element", "\"" + std::string(element) + "\"");
        const auto report = s.get<nodes::SolveReport>("solver", "outReport", 4);
        const nodes::WorstPlaces& worst = report.worst;
        CHECK((worst.body == 1 && worst.tet >= 0 && worst.tet < report.tets));
        CHECK(worst.j == Approx(report.record.min_j).epsilon(1e-12));
        const auto solved = s.get<nodes::Solved>("solver", "outSolved", 4);
        const auto& tissue = *std::get<0>(solved.rests[1]->data);
        solver::Vec3 middle = solver::Vec3::Zero();
        for (const int corner : tissue.tets.tets[static_cast<std::size_t>(worst.tet)])
            middle += 0.25 * solved.positions[1][static_cast<std::size_t>(corner)];
        CHECK((middle - solver::Vec3(worst.tet_place[0], worst.tet_place[1], worst.tet_place[2])).norm() <
              1e-12 * units);
        CHECK((worst.attachment == 0 && worst.source_body == 1));
        double stretch = 0;
        for (const solver::Measured& m : report.record.measured)
            if (m.what->name == "max_stretch_m") stretch = m.value;
        CHECK(stretch > 0);
        CHECK(worst.stretch == Approx(stretch).epsilon(1e-9));
        // The tied end is that at -x; the vertex is the nearest of the mesh.
        const solver::Points now = points(s, 4);
        const solver::Vec3 place(worst.stretch_place[0], worst.stretch_place[1], worst.stretch_place[2]);
        CHECK(place.x() == Approx(-0.5 * units).epsilon(0.1));
        REQUIRE((worst.vertex >= 0 && worst.vertex < static_cast<int>(now.size())));
        for (const solver::Vec3& p : now)
            CHECK((now[static_cast<std::size_t>(worst.vertex)] - place).norm() <= (p - place).norm());
    }
}

TEST_CASE("a simulation gives the same bits with one thread, two threads and without any kept scratch", "[nodes]") {
    Session one(beam(1), 1), two(beam(1), 2), forgetful(beam(1), 1);
    const engine::Digest expected = one.pull("solver", "outMeshes", 6).digest();
    CHECK(two.pull("solver", "outMeshes", 6).digest() == expected);
    for (double frame = 1; frame <= 6; ++frame) {
        forgetful.pull("solver", "outMeshes", frame);
        forgetful.evaluator.drop_scratch();
    }
    CHECK(forgetful.pull("solver", "outMeshes", 6).digest() == expected);
}

TEST_CASE("a saved simulation goes on bit for bit", "[nodes]") {
    Session first(beam(1)), second(beam(1));
    const engine::Digest expected = first.pull("solver", "outMeshes", 6).digest();
    for (double frame : {1.0, 3.0, 5.0}) {
        const std::vector<std::byte> bytes = first.evaluator.save_state({first.graph, {"solver", "outMeshes"}, frame});
        Session resumed(beam(1));
        resumed.evaluator.load_state({resumed.graph, {"solver", "outMeshes"}, frame}, bytes);
        CHECK(resumed.pull("solver", "outMeshes", 6).digest() == expected);
        CHECK(resumed.counter.steps["solver"] == static_cast<int>(6 - frame));
    }
}

TEST_CASE("a stop reaches into the solve and keeps the finished frames", "[nodes]") {
    /// Asks for a stop as soon as a frame's solve says that it is under way.
    struct Stopper : Counter {
        std::stop_source source;
        double at_frame = 0;
        void progress(const std::string&, double, std::string_view what) override {
            if (what == "solving" && steps["solver"] == at_frame) source.request_stop();
        }
    };
    Stopper stopper;
    stopper.at_frame = 3; // the start state and two steps are done
    engine::Evaluator evaluator({}, 1, &stopper);
    const auto g = graph(beam(1));
    CHECK_THROWS_AS(evaluator.pull({g, {"solver", "outMeshes"}, 6, stopper.source.get_token()}), engine::Cancelled);
    CHECK(stopper.steps["solver"] == 3);
    CHECK(stopper.warnings.empty());
    const engine::Digest resumed = evaluator.pull({g, {"solver", "outMeshes"}, 6}).digest();
    CHECK(stopper.steps["solver"] == 6);
    CHECK(resumed == Session(beam(1)).pull("solver", "outMeshes", 6).digest());
}

TEST_CASE("an edit keyed at a later frame leaves earlier frames alone", "[nodes]") {
    Session s(beam(1));
    points(s, 6);
    CHECK(s.counter.steps["solver"] == 6);
    s.set("flesh", "youngsModulus", R"({"keys": [[1, 200000], [5, 200000], [6, 100000]]})");
    points(s, 5);
    CHECK(s.counter.steps["solver"] == 6);
    points(s, 6);
    CHECK(s.counter.steps["solver"] == 7);
}

TEST_CASE("before its start frame a simulation stands as modelled, wherever the start is", "[nodes]") {
    Session s(beam(1, R"(, "startFrame": 3)"));
    const solver::Points rest = *s.get<nodes::Mesh>("mesh", "outMesh").points;
    CHECK(largest_difference(points(s, -4), rest) < 1e-14);
    CHECK(largest_difference(points(s, 3), rest) < 1e-14);
    CHECK(s.counter.steps["solver"] == 1);
    CHECK(largest_difference(points(s, 4), rest) > 1e-4);
}

TEST_CASE("bones alone need no solve", "[nodes]") {
    Session s(beam(1));
    s.set("solver", "bodies", R"([{"from": "bone.outBody"}])");
    s.set("solver", "attachments", "[]");
    CHECK(s.get<nodes::MeshList>("solver", "outMeshes", 3).meshes.size() == 1);
    CHECK(s.get<nodes::SolveReport>("solver", "outReport", 3).dofs == 0);
}
