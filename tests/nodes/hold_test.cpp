// zHold, initial velocities and given fibre directions from end to end: graphs, units, diagnostics, references.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "solver/terms/hold/hold.h"

#include <Eigen/SVD>

using namespace bench;

namespace {

/// A block of 10 x 4 x 4 cm and 1000 kg/m^3 in tets whose surface is its mesh, held at -x. `tets` "linear" or
/// "quadratic" by zTet.
std::string block(const std::string& hold, const std::string& solver_inputs, const std::string& extra = "") {
    return R"("mesh": {"type": "polyCube", "inputs": {"width": 10, "height": 4, "depth": 4, "subdivisionsWidth": 4, "subdivisionsHeight": 2, "subdivisionsDepth": 2}},
        "fit": {"type": "zDelaunayTetMesh", "inputs": {"mesh": {"from": "mesh.outMesh"}}},
        "tets": {"type": "zTet", "inputs": {"tets": {"from": "fit.outTets"}, "element": "quadratic"}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e5, "massDensity": 1000}},
        "beam": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "end": {"type": "weights", "inputs": {"mesh": {"from": "mesh.outMesh"}, "mode": "ramp", "start": -4.9, "end": -5}},
        "spin": {"type": "transform", "inputs": {"rotatePivot": [-5, 0, 0], "rotate": {"keys": [[1, [0, 0, 30]], [5, [0, 0, 390]]]}}},
        "hold": {"type": "zHold", "inputs": {"tissue": {"from": "beam.outBody"}, "weights": {"from": "end.outWeights"})" +
           hold + R"(}},
        "solver": {"type": "zSolver", "inputs": {"maxNewtonIterations": 60, "bodies": [{"from": "beam.outBody"})" +
           solver_inputs + R"(], "forces": [{"from": "hold.outForce"}])" + extra + "}}";
}

double measured(const nodes::SolveReport& r, std::string_view name, int part = 0) {
    for (const solver::Measured& m : r.record.measured)
        if (m.what->term == "hold" && m.what->name == name && (m.part == part || m.part < 0)) return m.value;
    return NAN;
}

} // namespace

TEST_CASE("zHold holds the painted end, and the report says with which force and moment", "[nodes]") {
    Session s(block(R"(, "momentPoint": [-5, 0, 0])", "", R"(, "integrator": "QuasiStatic", "gravity": [0, -10, 0])"));
    const solver::Points rest = *s.get<nodes::Mesh>("mesh", "outMesh").points;
    const solver::Points now = *s.get<nodes::MeshList>("solver", "outMeshes", 2).meshes[0].points;
    double tip = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        if (rest[i].x() < -4.99) CHECK((now[i] - rest[i]).norm() < 1e-12);
        tip = std::min(tip, now[i].y() - rest[i].y());
    }
    CHECK(tip < -0.1);
    const auto report = s.get<nodes::SolveReport>("solver", "outReport", 2);
    const double weight = 0.1 * 0.04 * 0.04 * 1000 * 10;
    CHECK(report.record.converged);
    CHECK(measured(report, "force_y_N") == Approx(weight).epsilon(1e-5));
    CHECK(measured(report, "reaction_N") == Approx(weight).epsilon(1e-5));
    // The weight pulls some 5 cm away from the held end, a little less as the beam bends.
    CHECK(measured(report, "moment_z_Nm") > 0.98 * 0.05 * weight);
    CHECK(measured(report, "moment_z_Nm") < 0.05 * weight);
    CHECK(std::find(report.terms.begin(), report.terms.end(), "hold") != report.terms.end());
    CHECK(s.counter.warnings.empty());
}

TEST_CASE("a held part goes where its transform goes, from where it is modelled", "[nodes]") {
    for (const char* scheme : {"QuasiStatic", "BackwardEuler", "TR-BDF2"}) {
        Session s(block(R"(, "matrix": {"from": "spin.outMatrix"})", "",
                        std::string(R"(, "gravity": [0, 0, 0], "integrator": ")") + scheme + "\""));
        const solver::Points rest = *s.get<nodes::Mesh>("mesh", "outMesh").points;
        for (const int frame : {2, 3, 5}) {
            const solver::Points now = *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[0].points;
            // 90 degrees a frame, whatever the angle at the start frame is.
            const Eigen::AngleAxisd turn((frame - 1) * M_PI / 2, solver::Vec3::UnitZ());
            const solver::Vec3 pivot(-5, 0, 0);
            for (std::size_t i = 0; i < rest.size(); ++i) {
                const solver::Vec3 goal = pivot + turn * (rest[i] - pivot);
                INFO(scheme << ", frame " << frame);
                if (rest[i].x() < -4.99) CHECK((now[i] - goal).norm() < 1e-9);
                if (std::string(scheme) == "QuasiStatic") CHECK((now[i] - goal).norm() < 1e-7);
            }
            const auto report = s.get<nodes::SolveReport>("solver", "outReport", frame);
            CHECK(report.record.converged);
            CHECK(report.record.inverted == 0);
        }
        CHECK(s.counter.warnings.empty());
    }
}

TEST_CASE("a held part follows a bone, which may be moved by its mesh too, and refuses one that bends", "[nodes]") {
    const std::string by_matrix = R"("plate": {"type": "polyCube", "inputs": {"width": 2, "height": 6, "depth": 6}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "plate.outMesh"}, "matrix": {"from": "spin.outMatrix"}}}, )";
    const std::string by_mesh = R"("plate": {"type": "polyCube", "inputs": {"width": 2, "height": 6, "depth": 6}},
        "moved": {"type": "transform", "inputs": {"mesh": {"from": "plate.outMesh"}, "offsetParentMatrix": {"from": "spin.outMatrix"}}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "moved.outMesh"}}}, )";
    const std::string wire = R"(, "bone": {"from": "bone.outBody"})", with_bone = R"(, {"from": "bone.outBody"})";
    Session matrix(by_matrix + block(wire, with_bone)), mesh(by_mesh + block(wire, with_bone)),
        direct(block(R"(, "matrix": {"from": "spin.outMatrix"})", ""));
    const auto at = [](Session& s) { return *s.get<nodes::MeshList>("solver", "outMeshes", 4).meshes[0].points; };
    CHECK(largest_difference(at(matrix), at(direct)) < 1e-3);
    CHECK(largest_difference(at(mesh), at(direct)) < 1e-3);

    std::string text;
    Session bends(R"("plate": {"type": "polyCube", "inputs": {"width": 2, "height": 6, "depth": 6}},
        "grow": {"type": "transform", "inputs": {"scale": {"keys": [[1, [1, 1, 1]], [4, [1, 1.3, 1]]]}}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "plate.outMesh"}, "matrix": {"from": "grow.outMatrix"}}}, )" +
                  block(wire, with_bone));
    CHECK(codes([&] { bends.pull("solver", "outMeshes", 4); }, &text) == Codes{"FE250"});
    CHECK(text.find("solver.forces: hold: bone: the bone changes its shape") != std::string::npos);

    // A bone that is switched off takes its hold along: QuasiStatic then finds the tissue afloat.
    Session off(by_matrix + block(wire, with_bone, R"(, "integrator": "QuasiStatic")"));
    CHECK(codes([&] { off.pull("solver", "outMeshes", 2); }).empty());
    off.set("bone", "enable", "false");
    CHECK(codes([&] { off.pull("solver", "outMeshes", 2); }) == Codes{"FE303"});
}

TEST_CASE("holds that cannot be are refused by name", "[nodes]") {
    std::string text;
    const auto refused = [&](const std::string& hold, const std::string& more = "") {
        return codes(block(hold, "", "") + more, "hold", "outForce", &text);
    };
    CHECK(refused(R"(, "matrix": [1,0,0,0, 0,2,0,0, 0,0,1,0, 0,0,0,1])") == Codes{"FE250"});
    CHECK(text.find("hold.matrix") != std::string::npos);
    CHECK(refused(R"(, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])") == Codes{"FE250"});
    CHECK(text.find("mirrors") != std::string::npos);
    CHECK(refused(R"(, "bone": {"from": "beam.outBody"})") == Codes{"FE218"});
    CHECK(refused(R"(, "weightsOn": "faces")") == Codes{"FE204"});
    CHECK(text.find("Set weightsOn to vertices.") != std::string::npos);
    Session s(block("", ""));
    s.set("hold", "weights", "[0]");
    CHECK(codes([&] { s.pull("hold", "outForce"); }, &text) == Codes{"FE212"});
    s.set("hold", "weights", "[1, 0, 1]");
    CHECK(codes([&] { s.pull("hold", "outForce"); }, &text) == Codes{"FE204"});
    // The same end held twice.
    s.set("hold", "weights", R"({"from": "end.outWeights"})");
    Session twice(block("", "", "").substr(0, block("", "", "").rfind("\"forces\"")) +
                  R"("forces": [{"from": "hold.outForce"}, {"from": "again.outForce"}]}},
                  "again": {"type": "zHold", "inputs": {"tissue": {"from": "beam.outBody"}, "weights": {"from": "end.outWeights"}, "momentPoint": [0, 1, 0]}})");
    CHECK(codes([&] { twice.pull("solver", "outMeshes", 2); }, &text) == Codes{"FE251"});
    CHECK(text.find("solver.forces: again: beam: two holds") != std::string::npos);
}

TEST_CASE("a hold of faces takes their points, and keyed motion builds no scene anew", "[nodes]") {
    Session s(block(R"(, "matrix": {"from": "spin.outMatrix"}, "weightsOn": "faces")", ""));
    const auto mesh = s.get<nodes::Mesh>("mesh", "outMesh");
    std::string faces;
    std::size_t corner = 0, painted = 0;
    for (const int size : mesh.topology->face_sizes) {
        bool left = true;
        for (int i = 0; i < size; ++i)
            left &= (*mesh.points)[std::size_t(mesh.topology->face_vertices[corner++])].x() < -4.99;
        faces += (faces.empty() ? "[" : ", ") + std::string(left ? "1" : "0");
        painted += left;
    }
    CHECK(painted == 4);
    s.set("hold", "weights", faces + "]");
    const auto force = s.get<nodes::Force>("hold", "outForce");
    const auto& part = static_cast<const solver::HoldRest&>(*force.rest).part;
    CHECK(std::count(part.triangles.begin(), part.triangles.end(), 1) == 8);
    CHECK(std::count(part.vertices.begin(), part.vertices.end(), 1) == 9);
    Session by_vertices(block(R"(, "matrix": {"from": "spin.outMatrix"})", ""));
    CHECK(*s.get<nodes::MeshList>("solver", "outMeshes", 3).meshes[0].points ==
          *by_vertices.get<nodes::MeshList>("solver", "outMeshes", 3).meshes[0].points);
}

TEST_CASE("initial velocities arrive in any unit, and only at the start", "[nodes]") {
    // Catalogue 6: 2 m/s upwards, one second; backward Euler falls g t dt / 2 too far.
    const std::string tissue = R"(, "initialVelocity": [0, 2, 0])";
    const auto body = [](const std::string& motion, const std::string& inputs) {
        return R"("mesh": {"type": "polyCube", "inputs": {"width": 3, "height": 2, "depth": 2}},
            "flesh": {"type": "zMaterial"},
            "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": 1.2}},
            "box": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"},
                    "materials": [{"from": "flesh.outMaterial"}])" +
               motion + R"(}}, "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "box.outBody"}])" + inputs +
               "}}";
    };
    for (const auto& [scheme, height] :
         {std::pair{"BackwardEuler", -3.109375}, {"BDF2", -2.917773437}, {"TR-BDF2", -2.905}}) {
        Session s(body(tissue, std::string(R"(, "gravity": [0, -9.81, 0], "integrator": ")") + scheme + "\""));
        const double rest = (*s.get<nodes::Mesh>("mesh", "outMesh").points)[0].y();
        const double now = (*s.get<nodes::MeshList>("solver", "outMeshes", 25).meshes[0].points)[0].y();
        INFO(scheme);
        CHECK((now - rest) / 100 == Approx(height).epsilon(1e-6));
    }
    // 90 degrees a second about y, in degrees: the momentum of the turn is there in the first state.
    Session s(body(R"(, "initialAngularVelocity": {"value": [0, 90, 0], "unit": "deg/s"})",
                   R"(, "gravity": [0, 0, 0], "integrator": "TR-BDF2", "stiffnessDamping": 0)"));
    const solver::Points rest = *s.get<nodes::Mesh>("mesh", "outMesh").points;
    const solver::Points now = *s.get<nodes::MeshList>("solver", "outMeshes", 25).meshes[0].points;
    const Eigen::AngleAxisd turn(M_PI / 2, solver::Vec3::UnitY());
    for (std::size_t i = 0; i < rest.size(); ++i) CHECK((now[i] - turn * rest[i]).norm() < 0.02);
}

TEST_CASE("an initial velocity that a body never gets is told", "[nodes]") {
    const auto told = [](const std::string& tissue, const std::string& solver) {
        Session s(R"("mesh": {"type": "polyCube", "inputs": {"width": 3, "height": 2, "depth": 2}},
            "flesh": {"type": "zMaterial"},
            "tets": {"type": "zTet", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tetSize": 1.2}},
            "hold": {"type": "zHold", "inputs": {"tissue": {"from": "box.outBody"}}},
            "box": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"},
                    "materials": [{"from": "flesh.outMaterial"}])" +
                  tissue + R"(}}, "solver": {"type": "zSolver", "inputs": {"forces": [{"from": "hold.outForce"}],
                    "bodies": [{"from": "box.outBody"}])" +
                  solver + "}}");
        s.pull("solver", "outMeshes", 2);
        std::string out;
        for (const engine::Diagnostic& d : s.counter.warnings) out += d.code + " " + d.message + "\n";
        return out;
    };
    const std::string falls = R"(, "initialVelocity": [0, -1, 0])", turns = R"(, "initialAngularVelocity": [0, 1, 0])",
                      late = R"(, "enable": {"keys": [[1, false], [3, true]]})",
                      at_once = R"(, "enable": {"keys": [[1, false], [2, true]]})",
                      early = R"(, "enable": {"keys": [[1, true], [3, false]]})", still = R"("QuasiStatic")";
    const auto scheme = [](const std::string& first, const std::string& later) {
        return R"(, "integrator": {"keys": [[1, )" + first + "], [2, " + later + "]]}";
    };
    CHECK(told(falls + late, "") ==
          "FE339 box.initialVelocity is lost: the body is off in the first step, and comes on at rest\n");
    CHECK(told(turns, scheme(R"("BDF2")", still)) ==
          "FE339 box.initialAngularVelocity is lost: QuasiStatic, in the first step, knows no velocities\n");
    CHECK(told(falls + turns, R"(, "integrator": "QuasiStatic")") ==
          "FE339 box.initialVelocity and .initialAngularVelocity are lost: QuasiStatic, in the first step, knows no "
          "velocities\n");
    for (const std::string& fine : {falls + early, falls + at_once, late, falls + turns}) CHECK(told(fine, "") == "");
    CHECK(told(falls, scheme(still, R"("BDF2")")) == "");
}

TEST_CASE("fibres may be given by a vector, a list or a file, and then need no end points", "[nodes]") {
    const Folder folder;
    const auto muscle = [](const std::string& fibre, const std::string& law = "StVK") {
        return R"("mesh": {"type": "polyCube", "inputs": {"width": 4, "height": 2, "depth": 2}},
            "flesh": {"type": "zMaterial"}, "tets": {"type": "zDelaunayTetMesh", "inputs": {"mesh": {"from": "mesh.outMesh"}}},
            "fibre": {"type": "zFiber", "inputs": {"excitation": 1)" +
               fibre + R"(}},
            "t": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"}, "material": ")" +
               law + R"(", "materials": [{"from": "flesh.outMaterial"}], "fibers": [{"from": "fibre.outFiber"}]}})";
    };
    const auto rest_of = [](Session& s) {
        return *std::get<std::shared_ptr<const solver::TissueRest>>(s.get<nodes::Body>("t", "outBody").rest->data);
    };
    Session vector(muscle(R"(, "direction": [0, 0, 30])", "Anisotropic"));
    const solver::TissueRest all = rest_of(vector);
    const std::size_t count = all.tets.tets.size();
    CHECK(all.fibers[0].directions == solver::Points(count, solver::Vec3::UnitZ()));
    CHECK(all.stiff_directions == all.fibers[0].directions);

    std::string list, nested;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string d = i == 0 ? "0, 0, 0" : i == 1 ? "3e-200, 0, 4e-200" : "0, 0, " + std::to_string(i);
        list += (i ? ", " : "") + d, nested += (i ? ", [" : "[") + d + "]";
    }
    Session listed(muscle(R"(, "directions": [)" + list + "]"));
    const solver::Points given = rest_of(listed).fibers[0].directions;
    CHECK(given[0] == solver::Vec3::Zero());
    CHECK((given[1] - solver::Vec3(0.6, 0, 0.8)).norm() < 1e-15);
    CHECK(given[2] == solver::Vec3::UnitZ());
    const std::string file = folder.write("d.json", R"({"biceps": {"directions": [)" + nested + "]}}");
    Session filed(muscle(R"(, "directionsFile": ")" + file + R"(", "directionsKey": "/biceps/directions")"));
    CHECK(rest_of(filed).fibers[0].directions == given);
    CHECK(filed.counter.warnings.empty());

    std::string text;
    const auto refused = [&](const std::string& fibre) { return codes(muscle(fibre), "t", "outBody", &text); };
    CHECK(refused(R"(, "directions": [1, 0, 0, 0, 1, 0])") == Codes{"FE227"});
    CHECK(text.find("2 fibre directions for " + std::to_string(count) + " tets") != std::string::npos);
    CHECK(text.find("t.fibers") != std::string::npos);
    CHECK(refused(R"(, "directions": [1, 0, 0, 0])") == Codes{"FE227"});
    CHECK(text.find("fibre.directions") != std::string::npos);
    CHECK(refused(R"(, "directions": [0, 0, 0])") == Codes{"FE212"});
    CHECK(refused(R"(, "directions": [1, 0, 0], "direction": [1, 0, 0])") == Codes{"DG110"});
    CHECK(refused(R"(, "direction": [1, 0, 0], "endPoints": [0, 1])") == Codes{"DG110"});
    CHECK(refused(R"(, "direction": [1, 0, 0], "directionsKey": "/biceps")") == Codes{"DG110"});
    CHECK(text.find("fibre.directionsKey") != std::string::npos);
    CHECK(refused(R"(, "directionsFile": ")" + folder.write("inf.json", "[1e999, 0, 0]") + "\"") == Codes{"IO403"});
    CHECK(text.find("json.exception") == std::string::npos);
    const std::string words = "[1, 0, \"" + std::string(5000, 'x') + "\"]";
    CHECK(refused(R"(, "directionsFile": ")" + folder.write("words.json", words) + "\"") == Codes{"IO403"});
    CHECK(text.size() < 400);
    CHECK(text.find("which is not a number") != std::string::npos);
    CHECK(refused(R"(, "directionsFile": ")" + folder.write("none.json", "[]") + "\"") == Codes{"FE227"});
    CHECK(text.find("fibre.directionsFile: the list of directions is empty") != std::string::npos);
    CHECK(refused("") == Codes{"FE205"});
}

TEST_CASE("a free muscle of given direction contracts to the length that theory gives", "[nodes]") {
    // Catalogue 8: E = 12 kPa, nu = 0.45, strength 12 kPa, limit 0.5, along a direction that no axis of the mesh has.
    const solver::Vec3 a = solver::Vec3(1, 2, 2) / 3;
    for (const auto& [law, length, width] :
         {std::tuple{"StVK", 0.6823278, 1.11377}, {"LogNeoHookean", 0.7809176, 1.11625}}) {
        Session s(
            R"("mesh": {"type": "polySphere", "inputs": {"radius": 3, "subdivisionsAxis": 12, "subdivisionsHeight": 8}},
            "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 12000, "poissonsRatio": 0.45}},
            "tets": {"type": "zDelaunayTetMesh", "inputs": {"mesh": {"from": "mesh.outMesh"}}},
            "fibre": {"type": "zFiber", "inputs": {"direction": [1, 2, 2], "strength": 12000, "contractionLimit": 0.5, "excitation": 1}},
            "t": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"}, "tets": {"from": "tets.outTets"},
                  "compressionResistance": 0, "material": ")" +
            std::string(law) + R"(",
                  "materials": [{"from": "flesh.outMaterial"}], "fibers": [{"from": "fibre.outFiber"}]}},
            "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "t.outBody"}], "gravity": [0, 0, 0],
                       "framesPerSecond": 0.5, "maxNewtonIterations": 60}})");
        const solver::Points rest = *s.get<nodes::Mesh>("mesh", "outMesh").points;
        const solver::Points now = *s.get<nodes::MeshList>("solver", "outMeshes", 12).meshes[0].points;
        INFO(law);
        // The same stretch everywhere; nothing keeps the ball from turning.
        const auto count = static_cast<Eigen::Index>(rest.size());
        Eigen::MatrixXd before(3, count), after(3, count);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            before.col(Eigen::Index(i)) = rest[i] - rest[0];
            after.col(Eigen::Index(i)) = now[i] - now[0];
        }
        const solver::Mat3 f = (after * before.transpose()) * (before * before.transpose()).inverse();
        CHECK((f * before - after).norm() < 1e-6 * before.norm());
        const Eigen::JacobiSVD<solver::Mat3> stretch(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
        CHECK(stretch.singularValues()[0] == Approx(width).epsilon(1e-5));
        CHECK(stretch.singularValues()[1] == Approx(width).epsilon(1e-5));
        CHECK(stretch.singularValues()[2] == Approx(length).epsilon(1e-6));
        CHECK(std::abs(stretch.matrixV().col(2).dot(a)) == Approx(1).epsilon(1e-9));
    }
}
