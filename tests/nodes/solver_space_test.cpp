// The space that a simulation runs in, bodies that come and go, and the run-up: all that zSolver says of a whole scene.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "nodes/contacts.h"
#include "nodes/marks.h"
#include "nodes/matrices.h"

#include <cmath>

using namespace bench;

namespace {

/// A beam of 0.6 m tied to a bone that swings; bone and, where it is asked for, the solver ride on `ride`, which moves
/// and turns and, by `grows`, scales.
std::string beam(const std::string& solver, bool rides, bool grows = false, const std::string& more = "") {
    const std::string scale = grows ? R"(, "scale": {"keys": [[1, [1, 1, 1]], [6, [1.6, 1.6, 1.6]]]})" : "";
    const std::string on = rides ? R"(, "offsetParentMatrix": {"from": "ride.outMatrix"})" : "";
    return R"("ride": {"type": "transform", "inputs": {"translate": {"keys": [[1, [0, 0, 0]], [6, [3, -1, 2]]], "interp": "smooth"},
            "rotate": {"keys": [[1, [0, 0, 0]], [6, [20, 70, -40]]], "interp": "smooth"})" +
           scale + R"(}},
        "mesh": {"type": "polyCube", "inputs": {"width": 0.6, "height": 0.2, "depth": 0.2, "subdivisionsWidth": 4}},
        "box": {"type": "polyCube", "inputs": {"width": 0.2, "height": 0.2, "depth": 0.2}},
        "place": {"type": "transform", "inputs": {"translate": {"keys": [[1, [-0.4, 0, 0]], [4, [-0.4, 0.05, 0]]]})" +
           on + R"(}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "box.outMesh"}, "matrix": {"from": "place.outMatrix"}}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 5e4}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": 0.2}},
        "beam": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "end": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "start": -0.29, "end": -0.3}},
        "tie": {"type": "zAttachment", "inputs": {"source": {"from": "beam.outBody"}, "target": {"from": "bone.outBody"}, "weights": {"from": "end.outWeights"}}},
        "solver": {"type": "zSolver", "inputs": {"maxNewtonIterations": 60, "scale": 1,
            "bodies": [{"from": "bone.outBody"}, {"from": "beam.outBody"}], "attachments": [{"from": "tie.outAttachment"}])" +
           solver + "}}" + more;
}

solver::Points points(Session& s, double frame, std::size_t body = 1) {
    return *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[body].points;
}

/// Where the ride brings points.
solver::Points carried(Session& s, solver::Points p, double frame) {
    const engine::Matrix4 m = s.get<engine::Matrix4>("ride", "outMatrix", frame);
    for (auto& q : p) {
        const solver::Vec3 x = q;
        for (int r = 0; r < 3; ++r) {
            const auto row = static_cast<std::size_t>(4 * r);
            q[r] = m[row] * x[0] + m[row + 1] * x[1] + m[row + 2] * x[2] + m[row + 3];
        }
    }
    return p;
}

const char* const on_ride = R"(, "matrix": {"from": "ride.outMatrix"})";

} // namespace

TEST_CASE("a solver and its bones that move together change nothing inside, whatever the scheme", "[nodes]") {
    for (const char* scheme : {"BackwardEuler", "BDF2", "TR-BDF2", "QuasiStatic"})
        for (const bool grows : {false, true}) {
            const std::string options = R"(, "substeps": 2, "integrator": ")" + std::string(scheme) + "\"";
            Session still(beam(options, false, grows)), riding(beam(options + on_ride, true, grows));
            INFO(scheme << (grows ? ", scaled too" : ""));
            for (const double frame : {1., 2., 6.})
                CHECK(largest_difference(carried(still, points(still, frame), frame), points(riding, frame)) < 1e-9);
            CHECK(largest_difference(points(still, 6), points(riding, 6)) > 1);
            // Without the solver the ride is felt.
            Session left(beam(options, true, grows));
            CHECK(largest_difference(points(left, 6), points(riding, 6)) > 1e-3);
            CHECK(riding.counter.warnings.empty());
        }
}

TEST_CASE("translate, rotate and scale of the solver do what a matrix does", "[nodes]") {
    Session matrix(beam(on_ride, true)),
        keyed(beam(R"(, "translate": {"keys": [[1, [0, 0, 0]], [6, [3, -1, 2]]], "interp": "smooth"},
                      "rotate": {"keys": [[1, [0, 0, 0]], [6, [20, 70, -40]]], "interp": "smooth"})",
                   true));
    CHECK(largest_difference(points(matrix, 6), points(keyed, 6)) < 1e-12);
    // Bones that grow about the origin with the solver's scale.
    Session grown(beam("", true, true));
    grown.set("ride", "translate", "[0, 0, 0]"), grown.set("ride", "rotate", "[0, 0, 0]");
    grown.set("solver", "scale", R"({"keys": [[1, 1], [6, 1.6]]})");
    Session plain(beam("", false));
    solver::Points wanted = points(plain, 6);
    for (auto& p : wanted) p *= 1.6;
    CHECK(largest_difference(points(grown, 6), wanted) < 1e-9);
}

TEST_CASE("a solver that stands elsewhere from the start on is no other one", "[nodes]") {
    Session plain(beam("", false)), away(beam(R"(, "translate": [5, 6, 7], "rotate": [10, 20, 30])", false));
    CHECK(points(plain, 5) == points(away, 5));
}

TEST_CASE("what is held by a matrix, solved tets, marks and places go along with the solver's space", "[nodes]") {
    const std::string hold =
        R"(, "grip": {"type": "transform", "inputs": {"rotate": {"keys": [[1, [0, 0, 0]], [6, [0, 30, 0]]]})";
    const std::string held =
        R"(, "part": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "start": 0.2, "end": 0.3}},
        "hold": {"type": "zHold", "inputs": {"tissue": {"from": "beam.outBody"}, "weights": {"from": "part.outWeights"}, "matrix": {"from": "grip.outMatrix"}}})";
    const std::string uses = R"(, "forces": [{"from": "hold.outForce"}])";
    Session still(beam(uses, false, false, hold + "}}" + held)),
        riding(
            beam(uses + on_ride, true, false, hold + R"(, "offsetParentMatrix": {"from": "ride.outMatrix"}}})" + held));
    CHECK(largest_difference(carried(still, points(still, 6), 6), points(riding, 6)) < 1e-9);
    const auto tets = [](Session& s) { return s.get<nodes::Solved>("solver", "outSolved", 6).positions[1]; };
    CHECK(largest_difference(carried(still, tets(still), 6), tets(riding)) < 1e-9);
    const auto a = still.get<nodes::MarkList>("solver", "outMarks", 6),
               b = riding.get<nodes::MarkList>("solver", "outMarks", 6);
    REQUIRE(a.groups.size() == b.groups.size());
    for (std::size_t g = 0; g < a.groups.size(); ++g)
        for (std::size_t i = 0; i < a.groups[g].marks.size(); ++i)
            CHECK(largest_difference(carried(still, {a.groups[g].marks[i].from}, 6), {b.groups[g].marks[i].from}) <
                  1e-9);
    const auto place = [](Session& s) {
        const auto p = s.get<nodes::SolveReport>("solver", "outReport", 6).worst.stretch_place;
        return solver::Points{{p[0], p[1], p[2]}};
    };
    CHECK(largest_difference(carried(still, place(still), 6), place(riding)) < 1e-9);
    std::string text;
    riding.set("ride", "scale", R"({"keys": [[1, [1, 1, 1]], [6, [2, 2, 2]]]})");
    riding.set("grip", "offsetParentMatrix", "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]");
    CHECK(codes([&] { riding.pull("solver", "outMeshes", 3); }, &text) == Codes{"FE292"});
}

TEST_CASE("a solver's matrix that shears, mirrors or flattens is refused", "[nodes]") {
    for (const char* scale : {"[1, 2, 1]", "[-1, -1, -1]"}) {
        Session s(beam(on_ride, false));
        s.set("ride", "scale", scale);
        INFO(scale);
        CHECK(codes([&] { s.pull("solver", "outMeshes", 2); }) == Codes{"FE291"});
    }
    Session flat(beam("", false));
    flat.set("solver", "matrix", "[1,0,0,0, 0,0,0,0, 0,0,1,0, 0,0,0,1]");
    CHECK(codes([&] { flat.pull("solver", "outMeshes", 2); }) == Codes{"FE291"});
}

TEST_CASE("a tissue that is switched off stands still, and starts from rest when it comes on", "[nodes]") {
    Session s(beam("", false));
    s.set("solver", "attachments", "[]");
    s.set("beam", "enable", R"({"keys": [[1, true], [4, false], [6, true]]})");
    const solver::Points third = points(s, 3);
    CHECK(points(s, 5) == third);
    const double fall = points(s, 6)[0].y() - third[0].y();
    CHECK(fall == Approx(-9.8 / 576).epsilon(1e-6)); // backward Euler's first step from rest
    Session late(beam("", false));
    late.set("beam", "enable", R"({"keys": [[1, false], [4, true]]})");
    CHECK(largest_difference(points(late, 3), *late.get<nodes::Mesh>("mesh", "outMesh").points) < 1e-15);
    CHECK(points(late, 3) == points(late, 1));
    CHECK(largest_difference(points(late, 6), points(late, 3)) > 1e-3);
    CHECK(late.get<nodes::SolveReport>("solver", "outReport", 3).bodies == 2);
    // A scheme of two steps has no past to go on from either: it falls as one that begins there.
    for (const char* integrator : {R"(, "integrator": "BDF2")", R"(, "integrator": "TR-BDF2")"}) {
        Session on(beam(integrator, false)), begins(beam(integrator, false));
        for (Session* of : {&on, &begins}) of->set("solver", "attachments", "[]");
        on.set("beam", "enable", R"({"keys": [[1, false], [4, true]]})");
        begins.set("solver", "startFrame", "3");
        CHECK(largest_difference(points(on, 3), points(begins, 3)) < 1e-15);
        CHECK(largest_difference(points(on, 8), points(begins, 8)) < 1e-12);
        CHECK(largest_difference(points(on, 8), points(begins, 3)) > 0.1);
    }
    // Off for good it has no place in the scene.
    Session never(beam("", false));
    never.set("beam", "enable", R"({"keys": [[1, false], [4, false]]})");
    CHECK(never.get<nodes::SolveReport>("solver", "outReport", 3).bodies == 1);
}

TEST_CASE("keys that switch a tissue on later are another scene, keys that change nothing yet are not", "[nodes]") {
    Session s(beam("", false));
    s.set("beam", "enable", "false");
    (void)points(s, 3);
    s.counter.steps.clear();
    s.set("beam", "enable", R"({"keys": [[1, false], [9, false]]})");
    (void)points(s, 3);
    CHECK(s.counter.steps["solver"] == 0);
    s.set("beam", "enable", R"({"keys": [[1, false], [9, true]]})");
    (void)points(s, 3);
    CHECK(s.counter.steps["solver"] == 3);
}

TEST_CASE("a bone that is off at all times is not taken for another of the same faces", "[nodes]") {
    const auto scene = [](const std::string& enable, const std::string& ties) {
        return R"("cube": {"type": "polyCube", "inputs": {"width": 0.2, "height": 0.2, "depth": 0.2}},
        "above": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0, 0.2, 0]}},
        "aside": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0.2, 0.2, 0]}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e5}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "above.outMesh"}, "tetSize": 0.2}},
        "block": {"type": "zTissue", "inputs": {"mesh": {"from": "above.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}}},
        "post": {"type": "zBone", "inputs": {"mesh": {"from": "aside.outMesh"}, "enable": )" +
               enable + R"(}},
        "below": {"type": "zAttachment", "inputs": {"source": {"from": "block.outBody"}, "target": {"from": "bone.outBody"}}},
        "beside": {"type": "zAttachment", "inputs": {"source": {"from": "block.outBody"}, "target": {"from": "post.outBody"}}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "bone.outBody"}, {"from": "post.outBody"}, {"from": "block.outBody"}],
            "attachments": [)" +
               ties + "]}}";
    };
    const std::string below = R"({"from": "below.outAttachment"})", beside = R"({"from": "beside.outAttachment"})";
    Session alone(scene("false", below));
    for (const std::string& ties : {beside + ", " + below, below + ", " + beside}) {
        Session off(scene("false", ties));
        CHECK(points(off, 4, 2) == points(alone, 4, 2));
        CHECK(off.get<nodes::SolveReport>("solver", "outReport", 4).attachments == 1);
    }
    Session on(scene("true", beside + ", " + below));
    CHECK(on.get<nodes::SolveReport>("solver", "outReport", 4).attachments == 2);
}

TEST_CASE("a bone that is switched off lets its attachments go and touches nothing", "[nodes]") {
    Session s(beam(R"(, "integrator": "QuasiStatic")", false));
    (void)points(s, 3);
    s.set("bone", "enable", R"({"keys": [[1, true], [4, false]]})");
    (void)points(s, 3);
    CHECK(codes([&] { (void)points(s, 4); }) == Codes{"FE303"}); // nothing ties the beam any more
    s.set("solver", "integrator", "\"BackwardEuler\"");
    const auto report = [&](double frame) { return s.get<nodes::SolveReport>("solver", "outReport", frame); };
    CHECK(report(3).attachments == 1);
    double lowest = 0;
    for (const auto& p : points(s, 8)) lowest = std::min(lowest, p.y());
    CHECK(lowest < -0.2);
    CHECK(points(s, 8, 0)[0].y() == Approx(-0.1 + 0.05)); // it moves as it is keyed
    // On a bone in contact: a block that lies on it falls once it is off.
    Session ground(R"("cube": {"type": "polyCube", "inputs": {"width": 0.2, "height": 0.2, "depth": 0.2}},
        "above": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0, 0.2, 0]}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e5}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "above.outMesh"}, "tetSize": 0.2}},
        "block": {"type": "zTissue", "inputs": {"mesh": {"from": "above.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}, "enable": {"keys": [[1, true], [5, false]]}}},
        "solver": {"type": "zSolver", "inputs": {"scale": 1, "collisionDetection": true, "bodies": [{"from": "bone.outBody"}, {"from": "block.outBody"}]}})");
    CHECK(points(ground, 4)[0].y() == Approx(0.1).margin(0.02));
    CHECK(points(ground, 10)[0].y() < -0.05);
}

TEST_CASE("runupWeight multiplies the channels that are flagged, and no others", "[nodes]") {
    const std::string keys = R"({"keys": [[1, 0], [5, 1]]})";
    const auto session = [&](const std::string& solver, const std::string& gravity, const std::string& envelope,
                             const std::string& damping, const std::string& excitation) {
        auto s = std::make_unique<Session>(beam(
            R"(, "gravity": )" + gravity + solver, false, false,
            R"(, "ends": {"type": "endPoints", "inputs": {"mesh": {"from": "mesh.outMesh"}, "source": {"from": "end.outWeights"}, "sink": {"from": "other.outWeights"}}},
                 "other": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "start": 0.29, "end": 0.3}},
                 "fibre": {"type": "zFiber", "inputs": {"endPoints": {"from": "ends.outEndPoints"}, "excitation": )" +
                excitation + "}}"));
        s->set("beam", "fibers", R"([{"from": "fibre.outFiber"}])");
        s->set("flesh", "restScale", "0.9"), s->set("flesh", "pressure", "500"),
            s->set("flesh", "surfaceTension", "20");
        for (const char* name : {"restScaleEnvelope", "pressureEnvelope", "surfaceTensionEnvelope"})
            s->set("beam", name, envelope);
        s->set("beam", "inertialDamping", damping);
        return s;
    };
    const std::string down = "[0, -9.8, 0]";
    const auto weighed = session(R"(, "affectInertialDamping": true, "runupWeight": )" + keys, down, "1", "1", "1");
    const auto by_hand = session("", R"({"keys": [[1, [0, 0, 0]], [5, [0, -9.8, 0]]]})", keys, keys, keys);
    CHECK(largest_difference(points(*weighed, 5), points(*by_hand, 5)) < 1e-12);
    const auto full = session("", down, "1", "1", "1");
    CHECK(largest_difference(points(*full, 3), points(*weighed, 3)) > 1e-4);
    const auto unflagged = session(R"(, "affectSolverGravity": false, "affectPressureEnvelope": false,
        "affectSurfaceTensionEnvelope": false, "affectRestScaleEnvelope": false, "affectFiberExcitation": false, "runupWeight": )" +
                                       keys,
                                   down, "1", "1", "1");
    CHECK(points(*unflagged, 5) == points(*full, 5));
}

TEST_CASE("inertialDamping arrives at the solver: a released beam creeps instead of swinging", "[nodes]") {
    Session free(beam("", false)), damped(beam("", false));
    damped.set("beam", "inertialDamping", "1");
    for (Session* s : {&free, &damped}) s->set("solver", "attachments", "[]");
    // Six steps of free fall: 1 + 2 + … + 5 times g h^2, against one of them each.
    CHECK(points(free, 6)[0].y() + 0.1 == Approx(-15 * 9.8 / 576).epsilon(1e-4));
    CHECK(points(damped, 6)[0].y() + 0.1 == Approx(-5 * 9.8 / 576).epsilon(1e-4));
    const auto terms = damped.get<nodes::SolveReport>("solver", "outReport", 3).terms;
    CHECK(std::find(terms.begin(), terms.end(), "inertialDamping") != terms.end());
}
