// What check says of values that are in their unit and that nobody means.
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
