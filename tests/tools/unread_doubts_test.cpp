// What check doubts of materials, paint and muscles: values that nothing reads, layers that are nowhere, muscles that
// never pull, sheets that are none.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/doubting.h"

using namespace sinew::test;
using nlohmann::json;

TEST_CASE("check doubts values of a material that its bodies do not read", "[tools]") {
    CHECK(said_of(ball(), {"flesh.tensileStiffness=100"}) ==
          "FE327 flesh.tensileStiffness: only tissue is made of it (ball), which does not read tensileStiffness | a "
          "tissue goes by youngsModulus, poissonsRatio, massDensity, volumeConservation\n");
    json graph = ball();
    graph["nodes"]["skin"] = {
        {"type", "zCloth"},
        {"inputs", {{"mesh", {{"from", "ballMesh.outMesh"}}}, {"materials", {{{"from", "weave.outMaterial"}}}}}}};
    graph["nodes"]["weave"] = {{"type", "zMaterial"}, {"inputs", {{"youngsModulus", 20000}}}};
    const std::string said = said_of(graph);
    CHECK(said.find("FE327 weave.youngsModulus: only cloth is made of it (skin), which does not read youngsModulus | a "
                    "cloth goes by tensileStiffness, shearStiffness, bendStiffness, clothMassDensity\n") !=
          std::string::npos);
    graph["nodes"]["ball"]["inputs"]["materials"] = {{{"from", "weave.outMaterial"}}}; // of both
    CHECK(said_of(graph).find("FE327") == std::string::npos);
}

TEST_CASE("check doubts values that another attribute of their node switches off", "[tools]") {
    CHECK(said_of(ball(), {"ball.transverseAnisotropy=3"}) ==
          "FE342 ball.transverseAnisotropy: does nothing while material is StVK | set material to Anisotropic, or take "
          "transverseAnisotropy out\n");
    CHECK(said_of(ball(), {"ball.transverseAnisotropy=1"}).empty()); // as if it were not there
    CHECK(said_of(ball(), {"ball.compressionResistance=5000"}).empty());
    CHECK(said_of(ball(), {"ball.compressionResistance=5000", "ball.material=Corotational"}) ==
          "FE342 ball.compressionResistance: does nothing while material is Corotational | set material to StVK or "
          "NeoHookean, or take compressionResistance out\n");
    // The plate lies in the ball.
    const std::vector<std::string> contact{"solver.collisionDetection=true", "plate.collisions=false"};
    const auto with_contact = [&](std::vector<std::string> settings) {
        settings.insert(settings.end(), contact.begin(), contact.end());
        return said_of(ball(), settings);
    };
    CHECK(with_contact({"ball.contactFriction=0.5", "ball.contactSliding=false"}) ==
          "FE342 ball.contactFriction: does nothing while contactSliding is off | set contactSliding to true, or take "
          "contactFriction out\n");
    CHECK(with_contact({"ball.contactFriction=0.5"}).empty());
    json graph = ball();
    graph["nodes"]["fibre"] = {
        {"type", "zFiber"},
        {"inputs", {{"direction", {0, 1, 0}}, {"strength", 60000}, {"excitation", 1}, {"muscleGrowthScale", 3}}}};
    graph["nodes"]["ball"]["inputs"]["fibers"] = {{{"from", "fibre.outFiber"}}};
    CHECK(said_of(graph) == "FE342 fibre.muscleGrowthScale: does nothing while enableMuscleGrowth is off | set "
                            "enableMuscleGrowth to true, or take muscleGrowthScale out\n");
    CHECK(said_of(graph, {"fibre.enableMuscleGrowth=true"}).empty());
    CHECK(said_of(graph, {R"(fibre.enableMuscleGrowth={"keys": [[1, false], [12, true]]})"}).empty());
    CHECK(said_of(graph, {"fibre.enableMuscleGrowth=true", "fibre.strength=0"}) ==
          "FE342 fibre.excitation: does nothing while strength is 0 | give it a strength: muscles have 100 to 300 kPa, "
          "or take excitation out\n");
}

TEST_CASE("check doubts damping in a scheme that knows no velocities", "[tools]") {
    const std::vector<std::string> damped = {"solver.massDamping=1",     "solver.stiffnessDamping=0.01",
                                             "solver.contactDamping=10", "ball.inertialDamping=0.5",
                                             "grip.damping=3",           "solver.collisionDetection=true",
                                             "plate.collisions=false"};
    CHECK(said_of(ball(), damped) == "");
    std::vector<std::string> at_rest = damped;
    at_rest.push_back(R"(solver.integrator="QuasiStatic")");
    const std::string said = said_of(ball(), at_rest);
    for (const char* attribute : {"massDamping", "stiffnessDamping", "contactDamping"})
        CHECK(said.find(std::string("FE342 solver.") + attribute +
                        ": does nothing while integrator is QuasiStatic | choose another integrator, or take " +
                        attribute + " out\n") != std::string::npos);
    for (const char* plug : {"ball.inertialDamping", "grip.damping"})
        CHECK(said.find(std::string("FE342 ") + plug +
                        ": does nothing while the integrator of solver is QuasiStatic, which knows no velocities | "
                        "choose another integrator, or take ") != std::string::npos);
    CHECK(std::count(said.begin(), said.end(), '\n') == 5);
    CHECK(said_of(ball(), {R"(solver.integrator="QuasiStatic")", "solver.massDamping=0"}) == "");
    // What another solver reads does something; and what none does is told once.
    json graph = ball();
    for (const char* copy : {"rest", "alsoAtRest"}) {
        graph["nodes"][copy] = graph["nodes"]["solver"];
        graph["nodes"][copy]["inputs"]["integrator"] = "QuasiStatic";
    }
    CHECK(said_of(graph, {"ball.inertialDamping=0.5", "grip.damping=3"}) == "");
    const std::string none =
        said_of(graph, {"ball.inertialDamping=0.5", "grip.damping=3", R"(solver.integrator="QuasiStatic")"});
    CHECK(std::count(none.begin(), none.end(), '\n') == 2);
}

TEST_CASE("check doubts what is said of contact where there is none", "[tools]") {
    const auto off = [](const std::string& plug, const std::string& what) {
        return "FE342 " + plug + ": does nothing while " + what + " is off | set collisionDetection to true, or take " +
               plug.substr(plug.find('.') + 1) + " out\n";
    };
    CHECK(said_of(ball(), {"ball.contactFriction=0.5"}) == off("ball.contactFriction", "collisionDetection of solver"));
    CHECK(said_of(ball(), {"plate.collisionSets=\"1\""}) == off("plate.collisionSets", "collisionDetection of solver"));
    CHECK(said_of(ball(), {"ball.selfCollisions=true"}) == off("ball.selfCollisions", "collisionDetection of solver"));
    CHECK(said_of(ball(), {"solver.maxContactLength=0.1"}) == off("solver.maxContactLength", "collisionDetection"));
    CHECK(said_of(ball(), {"ball.contactStiffness=1e6", "plate.contactSliding=true"}).empty()); // as without it
    // Off at all of its keys is off; on at one of them is not.
    CHECK(said_of(ball(),
                  {"ball.contactFriction=0.5", R"(solver.collisionDetection={"keys": [[1, false], [3, false]]})"}) ==
          off("ball.contactFriction", "collisionDetection of solver"));
    CHECK(said_of(ball(), {"ball.contactFriction=0.5", "plate.collisions=false",
                           R"(solver.collisionDetection={"keys": [[1, false], [3, true]]})"})
              .empty());
    // What another solver reads does something.
    json graph = ball();
    graph["nodes"]["other"] = graph["nodes"]["solver"];
    graph["nodes"]["other"]["inputs"]["collisionDetection"] = true;
    CHECK(said_of(graph, {"ball.contactFriction=0.5", "plate.collisions=false"}).empty());
}

TEST_CASE("check doubts attributes of another rule of weights, and of a recorded motion that is not there", "[tools]") {
    CHECK(said_of(ball(), {"top.radius=3"}) ==
          "FE342 top.radius: does nothing while mode is ramp | set mode to sphere, or take radius out\n");
    CHECK(said_of(ball(), {"top.smooth=true", "top.value=1", "top.radius=1"}).empty()); // read, or as without it
    json graph = ball();
    graph["nodes"]["top"]["inputs"] = {{"mesh", {{"from", "ballMesh.outMesh"}}},
                                       {"mode", "sphere"},
                                       {"center", {0, 10, 0}},
                                       {"radius", 4},
                                       {"start", 5},
                                       {"otherMesh", {{"from", "plateMesh.outMesh"}}}};
    CHECK(said_of(graph) ==
          "FE342 top.otherMesh: does nothing while mode is sphere | set mode to near, or take otherMesh out\n"
          "FE342 top.start: does nothing while mode is sphere | set mode to ramp, or take start out\n");
    CHECK(said_of(ball(), {"platePlace.trackName=\"plate\""}) ==
          "FE342 platePlace.trackName: does nothing while track names no file | name the motion file in track, or take "
          "trackName out\n");
}

TEST_CASE("check doubts a pressure on the mesh of a part that no solver has", "[tools]") {
    json graph = ball();
    graph["nodes"]["core"] = {
        {"type", "zSubtissue"},
        {"inputs", {{"mesh", {{"from", "coreMesh.outMesh"}}}, {"materials", {{{"from", "inner.outMaterial"}}}}}}};
    graph["nodes"]["coreMesh"] = {{"type", "polySphere"}, {"inputs", {{"radius", 1}}}};
    graph["nodes"]["inner"] = {{"type", "zMaterial"}, {"inputs", {{"pressure", 20000}}}};
    graph["nodes"]["ball"]["inputs"]["subtissues"] = {{{"from", "core.outBody"}}};
    CHECK(said_of(graph) == "FE342 inner.pressure: does nothing on the mesh of core, which is not among the solver's "
                            "bodies | connect core.outBody to zSolver.bodies beside its tissue\n");
    CHECK(said_of(graph, {"inner.pressure=0"}).empty());
    graph["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", "core.outBody"}});
    CHECK(said_of(graph).find("FE342") == std::string::npos);
}

TEST_CASE("check doubts layers and fibres that are painted nowhere", "[tools]") {
    json graph = ball();
    graph["nodes"]["stiff"] = {{"type", "zMaterial"},
                               {"inputs", {{"youngsModulus", 1e6}, {"weights", {{"from", "cap.outWeights"}}}}}};
    graph["nodes"]["cap"] = {
        {"type", "weights"},
        {"inputs",
         {{"mesh", {{"from", "ballMesh.outMesh"}}}, {"mode", "ramp"}, {"axis", "y"}, {"start", 80}, {"end", 100}}}};
    graph["nodes"]["ball"]["inputs"]["materials"].push_back({{"from", "stiff.outMaterial"}});
    CHECK(said_of(graph) ==
          "FE328 stiff.weights: is nowhere: all numbers of cap are 0 at the first frame | paint where it is to be, or "
          "take it out of the graph\n");
    CHECK(said_of(graph, {"cap.start=8", "cap.end=9"}).empty());
    // The first layer covers all, whatever its weights say; numbers in the file are looked at as maps are.
    std::swap(graph["nodes"]["ball"]["inputs"]["materials"][0], graph["nodes"]["ball"]["inputs"]["materials"][1]);
    CHECK(said_of(graph).empty());
    graph["nodes"]["flesh"]["inputs"]["weights"] = std::vector<double>(134, 0);
    CHECK(said_of(graph).starts_with("FE328 flesh.weights: is nowhere: all numbers of weights are 0"));
}

TEST_CASE("ends of fibres that are painted nowhere are named", "[tools]") {
    json graph = ball();
    const auto paint = [](double start, double end) {
        return json{{"type", "weights"},
                    {"inputs",
                     {{"mesh", {{"from", "ballMesh.outMesh"}}},
                      {"mode", "ramp"},
                      {"axis", "y"},
                      {"start", start},
                      {"end", end}}}};
    };
    graph["nodes"]["above"] = paint(8, 9), graph["nodes"]["below"] = paint(80, 90);
    graph["nodes"]["ends"] = {{"type", "endPoints"},
                              {"inputs",
                               {{"mesh", {{"from", "ballMesh.outMesh"}}},
                                {"source", {{"from", "above.outWeights"}}},
                                {"sink", {{"from", "below.outWeights"}}}}}};
    graph["nodes"]["fibre"] = {{"type", "zFiber"},
                               {"inputs", {{"endPoints", {{"from", "ends.outEndPoints"}}}, {"excitation", 0.5}}}};
    graph["nodes"]["ball"]["inputs"]["fibers"] = json::array({{{"from", "fibre.outFiber"}}});
    const std::string said = said_of(graph, {}, 1);
    CHECK(said.find("FE335 ends.sink: no number of below is above 0.5, so the fibres have no sink | ") !=
          std::string::npos);
    CHECK(said.find("ends.source") == std::string::npos);
    CHECK(said.find("FE205 ball.fibers: the fibres of fibre have no sink") != std::string::npos);
}

TEST_CASE("check doubts scenes whose muscles never pull", "[tools]") {
    json graph = ball();
    graph["nodes"]["fibre"] = {{"type", "zFiber"}, {"inputs", {{"direction", {0, 1, 0}}}}};
    graph["nodes"]["ball"]["inputs"]["fibers"] = json::array({{{"from", "fibre.outFiber"}}});
    CHECK(said_of(graph) ==
          "FE329 fibre.excitation: its muscle never pulls: it has no excitation and no line of action | key excitation "
          "from 0 to 1, or connect a zLineOfAction; \"strength\": 0 says that fibres are a direction alone\n");
    CHECK(said_of(graph, {"fibre.excitation=0.5"}).empty());
    CHECK(said_of(graph, {"fibre.strength=0"}).empty());
    CHECK(said_of(graph, {"fibre.enableMuscleGrowth=true", "fibre.muscleGrowthScale=2"}).empty());
    CHECK(said_of(graph, {"ball.material=Anisotropic", "ball.transverseAnisotropy=0.05"}).empty());
    // A muscle of two metres is in another unit; flesh as long need not be.
    const std::vector<std::string> large{"ballMesh.radius=120",
                                         "tets.tetSize=80",
                                         "top.start=100",
                                         "top.end=110",
                                         "platePlace.translate=[0, 120, 0]",
                                         "plateMesh.width=150",
                                         "plateMesh.depth=150",
                                         "fibre.excitation=0.5"};
    CHECK(said_of(graph, large) ==
          "FE261 solver.scale: ball is 2.4 m long: 240 scene units, 100 a metre | if it is modelled "
          "in millimetres, write \"scale\": 1000, which makes it 24 cm\n");
    graph["nodes"]["ball"]["inputs"].erase("fibers");
    CHECK(said_of(graph, large).empty());
}

TEST_CASE("check doubts sheets that are thick, heavy or fall apart", "[tools]") {
    const TemporaryFolder folder;
    json graph = json::parse(R"({"format": "sinew 1", "nodes": {
      "plane": {"type": "polyPlane", "inputs": {"width": 20, "height": 20}},
      "weave": {"type": "zMaterial"},
      "sheet": {"type": "zCloth", "inputs": {"mesh": {"from": "plane.outMesh"}, "materials": [{"from": "weave.outMaterial"}]}},
      "hold": {"type": "zHold", "inputs": {"tissue": {"from": "sheet.outBody"}, "weights": {"from": "rim.outWeights"}}},
      "rim": {"type": "weights", "inputs": {"mesh": {"from": "plane.outMesh"}, "mode": "ramp", "start": 8, "end": 9}},
      "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "sheet.outBody"}], "forces": [{"from": "hold.outForce"}]}}
    }})");
    CHECK(said_of(graph).empty());
    CHECK(said_of(graph, {"sheet.thickness=0.1"}) ==
          "FE337 sheet.thickness: 100 mm is 50 % of its length of 200 mm | thickness is in metres, whatever the "
          "scene's scale: 0.001 is a millimetre\n");
    // Contact would have all of it in reach of all of it.
    const std::string too_thick =
        all_said_of(graph, {"sheet.thickness=0.11", "solver.collisionDetection=true", "sheet.selfCollisions=true"}, 1);
    CHECK(too_thick.find("FE298 solver.bodies: sheet: a cloth that is 0.2 m long cannot be 0.11 m thick | Write "
                         "zCloth.thickness in metres") != std::string::npos);
    // Where it meets nothing it may be as thick as it likes.
    CHECK(said_of(graph, {"sheet.thickness=0.11", "solver.collisionDetection=true"}).starts_with("FE337"));
    CHECK(said_of(graph, {"weave.clothMassDensity=1060"}) ==
          "FE336 weave.clothMassDensity: 1060 kg/m^2 is heavier than any cloth; cotton has 0.2 | it is mass by area: a "
          "sheet of skin 2 mm thick has 2.2\n");
    json windy = graph;
    windy["nodes"]["wind"] = {{"type", "airField"}};
    windy["nodes"]["solver"]["inputs"]["forces"].push_back({{"from", "wind.outForce"}});
    CHECK(
        said_of(windy, {"weave.clothMassDensity=0.3"}) ==
        "FE338 wind.magnitude: 1000 pushes sheet by 340 times its weight: on a cloth it is a force per area [N/m^2] | "
        "list in its bodies what it is meant for, and give sheet a field of its own: 2.9 is its weight\n");
    CHECK(said_of(windy, {"weave.clothMassDensity=0.3", "wind.magnitude=500"}).empty());
    const auto is_doubted = [&](const std::string& setting) {
        return said_of(windy, {"weave.clothMassDensity=0.3", setting}).starts_with("FE338 wind.magnitude: ");
    };
    CHECK(is_doubted(R"(wind.magnitude={"keys": [[1, 0], [9, -1000]]})"));
    CHECK_FALSE(is_doubted("wind.useMaxDistance=true")); // it may be elsewhere
    CHECK_FALSE(is_doubted("wind.attenuation=2"));
    CHECK_FALSE(is_doubted("weave.clothMassDensity=2"));
    windy["nodes"]["wind"]["inputs"]["bodies"] = json::array({{{"from", "sheet.outBody"}}});
    CHECK(said_of(windy, {"weave.clothMassDensity=0.3"}).find("| give sheet a field of its own: 2.9 is its weight") !=
          std::string::npos);
    windy["nodes"]["wind"] = {{"type", "newtonField"}}; // whose magnitude is an acceleration's or another thing
    CHECK(said_of(windy, {"weave.clothMassDensity=0.3"}).empty());
    write_text(folder / "loose.obj", "v 0 0 0\nv 10 0 0\nv 0 0 10\nv 10 0 10\nv 10 0 0\nv 0 0 10\nf 1 3 2\nf 4 5 6\n");
    graph["nodes"]["plane"] = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "loose.obj").string()}}}};
    CHECK(
        said_of(graph).find("FE321 sheet.mesh: its mesh falls into 2 parts that nothing joins, with 2 vertices at the "
                            "places of others (4, 5)") != std::string::npos);
}
