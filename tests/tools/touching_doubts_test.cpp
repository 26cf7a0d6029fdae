// What check doubts of bodies that contact cannot keep apart.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/doubting.h"

#include <catch2/catch.hpp>

using namespace sinew::test;
using nlohmann::json;

namespace {

/// The ball of `ball()`, let go above a plane of 60 x 60.
json ball_over_plane() {
    json graph = ball();
    json& nodes = graph["nodes"];
    for (const char* gone : {"grip", "top", "plate", "plateMesh", "platePlace"}) nodes.erase(gone);
    nodes["floorMesh"] = json::parse(R"({"type": "polyPlane", "inputs": {"width": 60, "height": 60,
        "subdivisionsWidth": 3, "subdivisionsHeight": 3}})");
    nodes["floorPlace"] = json::parse(R"({"type": "transform", "inputs": {"translate": [0, -12, 0]}})");
    nodes["floor"] = json::parse(R"({"type": "zBone", "inputs": {"mesh": {"from": "floorMesh.outMesh"},
        "matrix": {"from": "floorPlace.outMatrix"}}})");
    nodes["solver"]["inputs"] = json::parse(R"({"bodies": [{"from": "floor.outBody"}, {"from": "ball.outBody"}],
        "scale": 100, "collisionDetection": true})");
    return graph;
}

} // namespace

TEST_CASE("check doubts an open floor through whose points a body falls", "[tools]") {
    // Its edges are 20 long along the sides, two of three.
    const std::string falls =
        "FE340 floor.mesh: bounds no solid, so it stops ball by its points alone, and those lie 20 apart where ball is "
        "20 wide | close it, as by a polyCube in place of a plane, or test more of its points: "
        "solver.collisionSubdivision true, collisionPointSpacing 0.02 m\n";
    CHECK(said_of(ball_over_plane()) == falls);
    CHECK(said_of(ball_over_plane(), {"floorMesh.subdivisionsWidth=12", "floorMesh.subdivisionsHeight=12"}).empty());
    CHECK(
        said_of(ball_over_plane(), {"solver.collisionSubdivision=true", "solver.collisionPointSpacing=0.02"}).empty());
    json closed = ball_over_plane();
    closed["nodes"]["floorMesh"] =
        json::parse(R"({"type": "polyCube", "inputs": {"width": 60, "height": 2, "depth": 60}})");
    CHECK(said_of(closed).empty());
}

TEST_CASE("check doubts bodies that collide and begin deep within each other", "[tools]") {
    json graph = ball_over_plane();
    json& nodes = graph["nodes"];
    nodes["floorMesh"] = json::parse(R"({"type": "polySphere", "inputs": {"radius": 4, "subdivisionsAxis": 12,
        "subdivisionsHeight": 12}})");
    const std::string inside = "FE341 floor.mesh: begins with 100 % of its points inside ball, up to ";
    // Its centre 4 below the ball's: its lowest points are 2 from the ball's skin, its highest 10.
    CHECK(said_of(graph, {"floorPlace.translate=[0, -4, 0]"}).starts_with(inside));
    CHECK(said_of(graph, {"floorPlace.translate=[0, -13, 0]"}).empty()); // grazes
    // Less than a third of its points, but a quarter of its breadth and more: 2.4 of 8.
    CHECK(said_of(graph, {"floorPlace.translate=[0, -11.5, 0]"}).starts_with("FE341 floor.mesh: begins with 2"));
    // What is attached to it belongs there, and what does not collide may lie where it will.
    CHECK(said_of(graph, {"floorPlace.translate=[0, -4, 0]", "solver.collisionDetection=false"}).find("FE341") ==
          std::string::npos);
    nodes["near"] = json::parse(R"({"type": "weights", "inputs": {"mesh": {"from": "ballMesh.outMesh"}, "mode": "ramp",
        "axis": "y", "start": -8, "end": -9}})");
    nodes["tie"] = json::parse(R"({"type": "zAttachment", "inputs": {"source": {"from": "ball.outBody"},
        "target": {"from": "floor.outBody"}, "weights": {"from": "near.outWeights"}}})");
    nodes["solver"]["inputs"]["attachments"] = json::parse(R"([{"from": "tie.outAttachment"}])");
    CHECK(said_of(graph, {"floorPlace.translate=[0, -4, 0]"}).find("FE341") == std::string::npos);
}

TEST_CASE("check doubts boxes that were copied onto each other, corner in face", "[tools]") {
    json graph = ball();
    json& nodes = graph["nodes"];
    nodes["boxMesh"] = json::parse(R"({"type": "polyCube", "inputs": {"width": 10, "height": 10, "depth": 10}})");
    for (const std::string name : {"one", "two"}) {
        nodes[name + "Place"] =
            json::parse(R"({"type": "transform", "inputs": {"mesh": {"from": "boxMesh.outMesh"}}})");
        nodes[name] = json::parse(R"({"type": "zTissue", "inputs": {"materials": [{"from": "flesh.outMaterial"}]}})");
        nodes[name]["inputs"]["mesh"]["from"] = name + "Place.outMesh";
        nodes["solver"]["inputs"]["bodies"].push_back({{"from", name + ".outBody"}});
    }
    nodes["solver"]["inputs"]["collisionDetection"] = true;
    const auto beside = [&](const std::string& x) {
        const std::string said =
            said_of(graph, {"onePlace.translate=[40, 0, 0]", "twoPlace.translate=[" + x + ", 0, 0]"});
        const std::size_t place = said.find("FE341");
        return place == std::string::npos ? std::string() : said.substr(place, said.find(" | ", place) - place);
    };
    const std::string push = ", and contact is to push it out";
    CHECK(beside("40.001") == "FE341 two.mesh: begins with 100 % of its points inside one" + push);
    CHECK(beside("41") == "FE341 two.mesh: begins with 50 % of its points inside one" + push);
    CHECK(beside("50").empty()); // face on face
    CHECK(beside("60").empty());
    // Of many the first few are told one by one: of five in one place there are ten pairs.
    json many = graph;
    for (const std::string name : {"three", "four", "five"}) {
        many["nodes"][name + "Place"] = many["nodes"]["twoPlace"];
        many["nodes"][name] = many["nodes"]["two"];
        many["nodes"][name]["inputs"]["mesh"]["from"] = name + "Place.outMesh";
        many["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", name + ".outBody"}});
    }
    const std::string said = said_of(many, {"onePlace.translate=[40, 0, 0]", "twoPlace.translate=[40.001, 0, 0]",
                                            "threePlace.translate=[40.002, 0, 0]", "fourPlace.translate=[40.003, 0, 0]",
                                            "fivePlace.translate=[40.004, 0, 0]"});
    std::size_t told = 0;
    for (std::size_t place = said.find("FE341 "); place != std::string::npos; place = said.find("FE341 ", place + 1))
        ++told;
    CHECK(told == 6);
    CHECK(said.find("FE341 solver.bodies: 5 other pairs of bodies begin inside each other, too | ") !=
          std::string::npos);
    // A plate thinner than a hundredth of its breadth that lies on a box is not in it.
    nodes["two"]["inputs"]["mesh"]["from"] = "platesPlace.outMesh";
    nodes["thinMesh"] = json::parse(R"({"type": "polyCube", "inputs": {"width": 9, "height": 0.05, "depth": 9}})");
    nodes["platesPlace"] = json::parse(R"({"type": "transform", "inputs": {"mesh": {"from": "thinMesh.outMesh"},
        "translate": [40, 5.026, 0]}})");
    CHECK(beside("0").empty());
}

TEST_CASE("check doubts a tissue in the very place of another, with contact or without", "[tools]") {
    json graph = ball();
    json& nodes = graph["nodes"];
    nodes["soft"] = json::parse(R"({"type": "zMaterial", "inputs": {"youngsModulus": 10000}})");
    nodes["twin"] = nodes["ball"];
    nodes["twin"]["inputs"]["materials"][0]["from"] = "soft.outMaterial";
    nodes["grip2"] = nodes["grip"];
    nodes["grip2"]["inputs"]["source"]["from"] = "twin.outBody";
    nodes["solver"]["inputs"]["bodies"].push_back({{"from", "twin.outBody"}});
    nodes["solver"]["inputs"]["attachments"].push_back({{"from", "grip2.outAttachment"}});
    const std::string same =
        "FE341 twin.mesh: begins exactly where ball does: every point is the same | move one of the two, or give it "
        "the file that it was to have; or, if they belong together, attach them to each other\n";
    CHECK(said_of(graph, {"solver.collisionDetection=false"}) == same);
    CHECK(said_of(graph, {"solver.collisionDetection=true"}) == same);
    nodes["tie"] = json::parse(R"({"type": "zAttachment", "inputs": {"source": {"from": "twin.outBody"},
        "target": {"from": "ball.outBody"}, "weights": {"from": "top.outWeights"}}})");
    nodes["solver"]["inputs"]["attachments"].push_back({{"from", "tie.outAttachment"}});
    CHECK(said_of(graph).find("FE341") == std::string::npos);
}

TEST_CASE("check doubts a limit of Newton iterations that cloth runs into where it touches", "[tools]") {
    json graph = ball();
    json& nodes = graph["nodes"];
    nodes["sheetMesh"] = json::parse(R"({"type": "polyPlane", "inputs": {"width": 30, "height": 30}})");
    nodes["sheetPlace"] = json::parse(R"({"type": "transform", "inputs": {"mesh": {"from": "sheetMesh.outMesh"},
        "translate": [0, 14, 0]}})");
    nodes["weave"] = json::parse(R"({"type": "zMaterial"})");
    nodes["sheet"] = json::parse(R"({"type": "zCloth", "inputs": {"mesh": {"from": "sheetPlace.outMesh"},
        "materials": [{"from": "weave.outMaterial"}]}})");
    nodes["solver"]["inputs"]["bodies"].push_back({{"from", "sheet.outBody"}});
    nodes["solver"]["inputs"]["collisionDetection"] = true;
    nodes["solver"]["inputs"]["gravity"] = {0, 0, 0}; // nothing catches the sheet where it touches nothing
    const auto said_where = [](const std::string& other) {
        return "FE343 solver.maxNewtonIterations: 10 are too few where sheet touches " + other +
               ": a step of cloth that touches or folds takes 20 to 60 | write 60: it is a limit, and costs nothing "
               "where fewer do\n";
    };
    CHECK(said_of(graph) == said_where("plate"));
    CHECK(said_of(graph, {"plate.collisions=false"}) == said_where("ball"));
    CHECK(said_of(graph, {"sheet.collisions=false"}).empty());
    CHECK(said_of(graph, {"sheet.collisionSets=\"1\""}).starts_with("FE256 solver.bodies: sheet.collisionSets is"));
    CHECK(said_of(graph, {"sheet.collisionSets=\"1\"", "sheet.selfCollisions=true"}) == said_where("itself"));
    CHECK(said_of(graph, {"solver.maxNewtonIterations=19"}).starts_with("FE343 solver.maxNewtonIterations: 19 are"));
    CHECK(said_of(graph, {"solver.maxNewtonIterations=20"}).empty());
    CHECK(said_of(graph, {"solver.collisionDetection=false"}).empty());
}

TEST_CASE("check doubts tets that tie parts of a tissue which only lie near to each other", "[tools]") {
    // A spring, 4 from turn to turn; along it 60. Of a coarse mesh no normal hits the next turn.
    json graph = ball();
    graph["nodes"]["ballMesh"] =
        json::parse(R"({"type": "polyHelix", "inputs": {"coils": 2.5, "height": 30, "width": 20,
        "radius": 4, "subdivisionsAxis": 8, "subdivisionsCoil": 24}})");
    CHECK(
        said_of(graph, {"tets.tetSize=4"}) ==
        "FE262 tets.tetSize: 30 % of the surface of ball lies about 5 from another part of it, less than one and a "
        "half of the tets there (4), which tie the two together | choose a tetSize of at most 2.5, or refine there by "
        "weights and surfaceRefinement\n");
    CHECK(said_of(graph, {"tets.tetSize=2.5"}) == "");
    CHECK(said_of(graph, {"tets.tetSize=4", "ballMesh.coils=1"}) == "");
    // Folds, 6 wide and as deep: the sides of one are near, and hang together at its bottom.
    const TemporaryFolder folder;
    std::string points, faces;
    const auto face = [&](const std::array<int, 4>& corners) {
        faces += "f";
        for (const int c : corners) faces += " " + std::to_string(c);
        faces += "\n";
    };
    for (int k = 0; k <= 20; ++k) {
        for (const double y : {k % 2 ? -6.0 : 0.0, -16.0})
            for (const double z : {0.0, 30.0})
                points += "v " + std::to_string(3 * k - 30) + " " + std::to_string(y + 10) + " " +
                          std::to_string(z - 15) + "\n";
        const int a = 4 * k; // top, its other end, below, its other end
        if (k == 0) face({a + 1, a + 3, a + 4, a + 2});
        if (k == 20) face({a + 1, a + 2, a + 4, a + 3});
        if (k == 20) break;
        face({a + 1, a + 2, a + 6, a + 5}), face({a + 3, a + 7, a + 8, a + 4});
        face({a + 1, a + 5, a + 7, a + 3}), face({a + 2, a + 4, a + 8, a + 6});
    }
    write_text(folder / "folds.obj", points + faces);
    graph["nodes"]["ballMesh"] = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "folds.obj").string()}}}};
    CHECK(said_of(graph, {"tets.tetSize=4"}).find("FE262") == std::string::npos);
}
