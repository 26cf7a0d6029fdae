// What check says of values that are in their unit and that nobody means, and of tets too large.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/doubting.h"

using namespace sinew::test;
using nlohmann::json;

TEST_CASE("check doubts gravity that points up, flesh heavier than metal, and rest scales of another order",
          "[tools]") {
    CHECK(said_of(ball(), {"solver.gravity=[0, 9.8, 0]"}) ==
          "FE322 solver.gravity: points along +y: where y is up, whatever is free goes up | what falls along y has [0, "
          "-9.8, 0]\n");
    CHECK(said_of(ball(), {"solver.gravity=[0, 0, 9.81]"}) ==
          "FE322 solver.gravity: points along +z: where z is up, whatever is free goes up | what falls along z has [0, "
          "0, -9.8]\n");
    for (const char* meant : {"[0, -9.8, 0]", "[9.8, 0, 0]", "[0, 1, 0]", "[3, 9, 0]", "[0, 0, 0]"}) // wind, a push
        CHECK(said_of(ball(), {"solver.gravity=" + std::string(meant)}).empty());
    CHECK(said_of(ball(), {"flesh.massDensity=1e6"}) ==
          "FE323 flesh.massDensity: 1000000 kg/m^3 is heavier than any metal; water has 1000, flesh 1060 | massDensity "
          "is in kg/m^3, whatever the scene's scale: 1060\n");
    CHECK(said_of(ball(), {"flesh.massDensity=19300"}).empty()); // gold
    CHECK(said_of(ball(), {"flesh.restScale=20"}) ==
          "FE344 flesh.restScale: 20 makes it rest at 20 times its length | it is a factor of "
          "lengths: 0.8 is a fifth shorter; for a scene in other units there is zSolver.scale\n");
    CHECK(said_of(ball(), {"flesh.restScale=0.05"}).starts_with("FE344 flesh.restScale: 0.05 makes it rest at 0.05 "));
    CHECK(said_of(ball(), {"flesh.restScale=2"}).empty());
}

TEST_CASE("check doubts tets far larger than what they fill is thick", "[tools]") {
    json graph = ball();
    graph["nodes"]["ballMesh"] = {{"type", "polyCube"}, // a plate of 2 cm
                                  {"inputs", {{"width", 40}, {"height", 20}, {"depth", 2}, {"subdivisionsHeight", 4}}}};
    const std::string said = said_of(graph, {"tets.tetSize=10"});
    CHECK(said.starts_with("FE262 tets.tetSize: "));
    CHECK(
        said.find("of the surface of ball belongs to parts about 2 thick, less than a quarter of the tets there (10) | "
                  "choose a tetSize of about 2,") != std::string::npos);
    CHECK(said_of(graph, {"tets.tetSize=2"}).empty());
    graph["nodes"]["ballMesh"]["inputs"]["depth"] = 6;
    CHECK(said_of(graph, {"tets.tetSize=8"}).empty());
    // One and a half times as large as it is thick: a third as stiff it would be right. Quadratic tets bend, and what
    // is pulled need not.
    CHECK(said_of(graph, {"tets.tetSize=12"})
              .find("about 6 thick, less than two thirds of the tets there (12) | choose "
                    "a tetSize of about 6, or set element to quadratic: linear") != std::string::npos);
    CHECK(said_of(graph, {"tets.tetSize=12", "tets.element=\"quadratic\""}).empty());
    CHECK(said_of(graph, {"tets.tetSize=12", "flesh.youngsModulus=1.2 MPa"}).empty());
    CHECK(said_of(graph, {"tets.tetSize=17", "flesh.youngsModulus=1.2 MPa"}).empty());
    CHECK(said_of(graph, {"tets.tetSize=20"}).find("about 6 thick, less than a third of") != std::string::npos);
    // A ball of 20 in tets of 30: no part of it is thin.
    CHECK(
        said_of(ball(), {"tets.tetSize=30"}) ==
        "FE262 tets.tetSize: ball is 20 long and its tets are 30, so it cannot bend | choose a tetSize of about 2.5\n");
    CHECK(said_of(ball(), {"tets.tetSize=12"}).empty());
}

TEST_CASE("check says how much flesh a pancake gains by the tets that it lies in", "[tools]") {
    json graph = ball();
    graph["nodes"]["ballMesh"] = {{"type", "polyCylinder"},
                                  {"inputs", {{"radius", 10}, {"height", 0.02}, {"subdivisionsAxis", 100}}}};
    graph["nodes"]["tets"]["inputs"]["tetSize"] = 1.5;
    graph["nodes"]["top"]["inputs"]["axis"] = "x";
    graph["nodes"]["platePlace"]["inputs"]["translate"] = {10, 0, 0};
    const std::string said = said_of(graph);
    INFO(said);
    // By `sinew eval tets.outTets`: 6.67 of solid where 6.28 are enclosed.
    CHECK(said.find("; they count as 6.3 % more flesh than the mesh encloses | choose a tetSize") != std::string::npos);
    // What is advised is not refused: 20 long, .02 thick.
    CHECK(said.find("choose a tetSize of about 0.02 and a maxResolution of 1050, or") != std::string::npos);
    CHECK(said_of(graph, {"tets.maxResolution=1100"}).find("about 0.02, or") != std::string::npos);
    CHECK(said_of(graph, {"tets.weights=0.5", "tets.surfaceRefinement=2", "tets.maxResolution=1100"})
              .find("and a maxResolution of 4200, or") != std::string::npos);
}

TEST_CASE("check doubts odd values at any of their keys", "[tools]") {
    const auto keyed = [](const char* node, const char* input, const char* keys) {
        json graph = ball();
        graph["nodes"][node]["inputs"][input] = {{"keys", json::parse(keys)}};
        return said_of(graph);
    };
    CHECK(keyed("flesh", "youngsModulus", "[[1, 12000], [3, 12]]")
              .starts_with("FE263 flesh.youngsModulus: 12 Pa is softer than any flesh"));
    CHECK(keyed("flesh", "youngsModulus", "[[1, 12000], [3, 9000]]").empty());
    CHECK(keyed("flesh", "massDensity", "[[1, 1060], [3, 1.06]]")
              .starts_with("FE323 flesh.massDensity: 1.06 kg/m^3 is lighter than any flesh"));
    CHECK(keyed("solver", "gravity", "[[1, [0, -9.8, 0]], [3, [0, -980, 0]]]")
              .starts_with("FE322 solver.gravity: 980 m/s^2 is 100 times the earth's"));
}

TEST_CASE("keys of one value are doubted as the value is, and as little", "[tools]") {
    const std::string falls = "FE260 solver.bodies: ball falls";
    CHECK(said_of(ball(), {"grip.envelope=0"}).starts_with(falls));
    CHECK(said_of(ball(), {R"(grip.envelope={"keys": [[1, 0], [3, 0]]})"}).starts_with(falls));
    CHECK(said_of(ball(), {R"(grip.stiffness={"keys": [[1, 0], [3, 0]]})"}).starts_with(falls));
    CHECK(said_of(ball(), {R"(grip.envelope={"keys": [[1, 0], [3, 1]]})"}).empty());
    CHECK(said_of(ball(), {"grip.envelope=0", R"(solver.gravity={"keys": [[1, [0, 0, 0]], [3, [0, 0, 0]]]})"}).empty());
    // What is soft at all times, and what is soft before it holds.
    CHECK(said_of(ball(), {R"(grip.stiffness={"keys": [[1, 1], [3, 2]]})"})
              .starts_with("FE326 grip.stiffness: 2 N/m^3 holds nothing: "));
    CHECK(said_of(ball(), {R"(grip.stiffness={"keys": [[1, 1], [3, 1e8]]})"}).empty());
    json graph = ball();
    graph["nodes"]["fibre"] = json::parse(R"({"type": "zFiber", "inputs": {"direction": [0, 1, 0], "strength": 60000,
        "excitation": {"keys": [[1, 0], [3, 0]]}}})");
    graph["nodes"]["ball"]["inputs"]["fibers"] = {{{"from", "fibre.outFiber"}}};
    CHECK(said_of(graph).starts_with("FE329 fibre.excitation: its muscle never pulls"));
    CHECK(said_of(graph, {R"(fibre.excitation={"keys": [[1, 0], [3, 1]]})"}).empty());
    // Between two keys of 0 it rises and falls by its tangents.
    CHECK(said_of(graph, {R"(fibre.excitation={"interp": "smooth",
        "keys": [[1, 0, {"out": 0.5}], [5, 0, {"in": -0.5}]]})"})
              .empty());
    CHECK(said_of(graph, {R"(fibre.excitation={"interp": "smooth", "keys": [[1, 0, {"out": 0}], [5, 0, {"in": 0}]]})"})
              .starts_with("FE329 fibre.excitation: its muscle never pulls"));
}

TEST_CASE("the scale that is proposed for a body in another unit cures it, however far off it is", "[tools]") {
    const TemporaryFolder folder;
    json graph = ball();
    graph["nodes"]["plateMesh"] = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "bone.obj").string()}}}};
    const auto proposed = [&](double size) {
        std::ostringstream text;
        text << "v 0 0 0\nv " << size << " 0 0\nv 0 " << size << " 0\nv 0 0 " << size
             << "\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
        write_text(folder / "bone.obj", text.str());
        const std::string said = said_of(graph), before = "transform with scale ";
        const std::size_t at = said.find(before);
        REQUIRE(at != std::string::npos);
        const std::size_t begin = at + before.size();
        const std::string scale = said.substr(begin, said.find(' ', begin) - begin);
        CHECK(said_of(graph, {"platePlace.scale=[" + scale + ", " + scale + ", " + scale + "]"}).find("FE320") ==
              std::string::npos);
        return scale + (said.find("no two usual units are so far apart") != std::string::npos ? " odd" : "");
    };
    CHECK(proposed(0.3) == "100");
    CHECK(proposed(5000) == "0.01");
    CHECK(proposed(1e6) == "0.001");
    CHECK(proposed(1e7) == "1e-06 odd");
    CHECK(proposed(1e40) == "1e-39 odd");
}

TEST_CASE("check doubts flesh that is stiffer than bone", "[tools]") {
    CHECK(
        said_of(ball(), {"flesh.youngsModulus=1e13"}) ==
        "FE263 flesh.youngsModulus: 1e+13 Pa is stiffer than any tissue; bone has 14 GPa, a tendon 1 GPa, a muscle 12 "
        "kPa | youngsModulus is in pascals: a muscle has 12000; what hardly gives at all is better a zBone\n");
    CHECK(said_of(ball(), {R"(flesh.youngsModulus={"keys": [[1, 12000], [3, 1e12]]})"}).empty()); // diamond, by name
    CHECK(said_of(ball(), {R"(flesh.youngsModulus={"keys": [[1, 12000], [3, 4e10]]})"})
              .starts_with("FE263 flesh.youngsModulus: 4e+10 Pa is stiffer"));
    CHECK(said_of(ball(), {"flesh.youngsModulus=2e10"}).empty());
}

TEST_CASE("check doubts a body of kilometres whatever made it", "[tools]") {
    CHECK(
        said_of(ball(), {"plateMesh.width=2e5"}) ==
        "FE320 solver.bodies: plate is 2 km long: 200000 scene units, 100 a metre | give it a size in scene units that "
        "suits the other bodies; where it is in another unit, scale it by a transform\n");
    CHECK(said_of(ball(), {"plateMesh.width=9e4"}).empty()); // a runway
    // A scale that makes all of them giants is told alone.
    CHECK(said_of(ball(), {"plateMesh.width=2000", "solver.scale=1"}).starts_with("FE261 solver.scale: ball is 20 m"));
    CHECK(said_of(ball(), {"plateMesh.width=2000", "solver.scale=1"}).find("FE320") == std::string::npos);
}

TEST_CASE("check doubts gravity that points up by keys or with fields", "[tools]") {
    json graph = ball();
    json& gravity = graph["nodes"]["solver"]["inputs"]["gravity"];
    gravity = json::parse(R"({"keys": [[1, [0, 9.8, 0]], [20, [0, -9.8, 0]]]})");
    CHECK(said_of(graph).starts_with("FE322 solver.gravity: points along +y: "));
    gravity = json::parse(R"({"keys": [[1, [0, -9.8, 0]], [20, [0, 9.8, 0]]]})"); // a scene that is turned over
    CHECK(said_of(graph).empty());
    graph["nodes"]["pull"] = {{"type", "gravityField"}, {"inputs", {{"direction", {0, 2, 0}}}}};
    graph["nodes"]["solver"]["inputs"]["forces"].push_back({{"from", "pull.outForce"}});
    const auto said = [&](double y, double magnitude) {
        gravity = {0, y, 0};
        graph["nodes"]["pull"]["inputs"]["magnitude"] = magnitude;
        return said_of(graph);
    };
    CHECK(said(-9.8, 9.8).find("FE322") == std::string::npos); // it takes the weight away
    CHECK(
        said(0, 9.8).starts_with("FE322 pull.direction: points along +y: where y is up, whatever is free goes up | "));
    CHECK(said(-9.8, 19.6).starts_with("FE322 pull.direction: with it the sum of gravity points along +y: "));
    graph["nodes"]["pull"]["inputs"]["direction"] = {0, -1, 0};
    CHECK(said(0, -9.8).starts_with("FE322 pull.magnitude: points along +y: "));
    CHECK(said(0, 9.8).find("FE322") == std::string::npos);
}

TEST_CASE("check doubts an attachment whose weights leave nothing of its stiffness", "[tools]") {
    // The ramp ends so far away that what is painted is a trace: 2 of 1e60 at the top.
    CHECK(said_of(ball(), {"top.end=1e60"})
              .starts_with("FE326 grip.weights: it holds nothing: weights and envelope are 2e-60 at most, which leaves "
                           "2e-52 N/m^3 of its stiffness | "));
    // Of the stiffness 1e8 a ten-thousandth is a soft tie.
    CHECK(said_of(ball(), {"top.end=20000"}).find("FE326") == std::string::npos);
    CHECK(said_of(ball(), {"top.end=20000", "grip.stiffness=1e6"}).starts_with("FE326 grip.weights: "));
    CHECK(said_of(ball(), {"top.end=20000", "grip.envelope=0.001"}).starts_with("FE326 grip.weights: "));
}

TEST_CASE("check tells once of a whole scene that falls", "[tools]") {
    json graph = ball();
    graph["nodes"]["solver"]["inputs"].erase("attachments");
    const auto add = [&](int number) {
        const std::string name = "ball" + std::to_string(number);
        graph["nodes"][name + "Place"] = {
            {"type", "transform"},
            {"inputs", {{"mesh", {{"from", "ballMesh.outMesh"}}}, {"translate", {40.0 * number, 0, 0}}}}};
        graph["nodes"][name] = graph["nodes"]["ball"];
        graph["nodes"][name]["inputs"].erase("tets");
        graph["nodes"][name]["inputs"]["mesh"]["from"] = name + "Place.outMesh";
        graph["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", name + ".outBody"}});
    };
    const auto falls = [&] {
        const std::string said = said_of(graph);
        std::string out;
        for (std::size_t at = said.find("FE260 "); at != std::string::npos; at = said.find("FE260 ", at + 1))
            out += said.substr(at, said.find(':', said.find(": ", at) + 2) - at) + "\n";
        return out;
    };
    const std::string begin = "FE260 solver.bodies: ";
    add(1), add(2);
    CHECK(falls() == begin + "ball falls\n" + begin + "ball1 falls\n" + begin + "ball2 falls\n");
    add(3);
    CHECK(falls() == begin + "ball, ball1, ball2 and 1 other fall\n");
    add(4);
    CHECK(falls() == begin + "ball, ball1, ball2 and 2 others fall\n");
    CHECK(said_of(graph).find(
              "fall: no chain of attachments ties them to a bone, and nothing holds them | attach each") !=
          std::string::npos);
}

TEST_CASE("check doubts a scene so far from the origin that files of 32 bits lose its shape", "[tools]") {
    json graph = ball();
    graph["nodes"]["away"] = json::parse(R"({"type": "transform", "inputs": {"mesh": {"from": "ballMesh.outMesh"},
        "translate": [1e7, 0, 0]}})");
    for (const char* node : {"tets", "ball", "top"}) graph["nodes"][node]["inputs"]["mesh"]["from"] = "away.outMesh";
    const std::vector<std::string> there{"platePlace.translate=[1e7, 10, 0]"};
    CHECK(said_of(graph, there) ==
          "FE345 solver.bodies: the scene lies 1e+07 scene units from the origin, 290000 times its size: files and "
          "pictures hold places in 32 bits, here to 0.6 scene units | model it near the origin, and move what comes "
          "out; or write --format obj, which holds all digits\n");
    CHECK(said_of(graph, {"platePlace.translate=[1e4, 10, 0]", "away.translate=[1e4, 0, 0]"}).empty());
}
