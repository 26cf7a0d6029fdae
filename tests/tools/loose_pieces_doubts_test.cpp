// What check says of bodies that fall into pieces, of which some are held and some are not.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/doubting.h"

using namespace sinew;
using namespace sinew::test;
using nlohmann::json;

namespace {

/// The ball's mesh is two cubes, one held by the plate above it and one beside it, 40 away.
json two_cubes() {
    json graph = ball();
    json& nodes = graph["nodes"];
    const auto cube = [](double x, int first) {
        std::string points, corners;
        for (const double z : {-5.0, 5.0})
            for (const double y : {-5.0, 5.0})
                for (const double dx : {-5.0, 5.0})
                    points += (points.empty() ? "" : ", ") + std::to_string(x + dx) + ", " + std::to_string(y + 5) +
                              ", " + std::to_string(z);
        for (const auto& face : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                                 std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
            for (const int v : face) corners += (corners.empty() ? "" : ", ") + std::to_string(v + first);
        return std::pair(points, corners);
    };
    const auto [near_points, near_corners] = cube(0, 0);
    const auto [far_points, far_corners] = cube(40, 8);
    nodes["ballMesh"] = {{"type", "hostMesh"},
                         {"inputs",
                          {{"points", json::parse("[" + near_points + ", " + far_points + "]")},
                           {"faceSizes", json::parse("[4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4]")},
                           {"faceVertices", json::parse("[" + near_corners + ", " + far_corners + "]")}}}};
    nodes["tets"]["inputs"]["tetSize"] = 5;
    nodes["top"] = {
        {"type", "weights"},
        {"inputs",
         {{"mesh", {{"from", "ballMesh.outMesh"}}}, {"mode", "sphere"}, {"center", {0, 10, 0}}, {"radius", 8}}}};
    return graph;
}

const std::string falls = "FE260 solver.bodies: a piece of ball falls, 10 long, around (40, 5, 0): no chain of "
                          "attachments ties it to a bone, and nothing holds it";

} // namespace

TEST_CASE("check doubts a piece of a tissue that nothing holds, with its place", "[tools]") {
    CHECK(said_of(two_cubes()).find(falls + " | attach it as well, or hold it by zHold; or take it out of the mesh") !=
          std::string::npos);
    CHECK(said_of(two_cubes(), {"solver.gravity=[0, 0, 0]"}).find("FE260") == std::string::npos);
    // Painted as well: held.
    CHECK(said_of(two_cubes(), {"top.center=[20, 10, 0]", "top.radius=30"}).find("FE260") == std::string::npos);
    // Tets that reach from one to the other tie them.
    CHECK(said_of(two_cubes(), {"tets.tetSize=45"}).find("FE260") == std::string::npos);
    // Neither held: the body falls as a whole.
    CHECK(said_of(two_cubes(), {"grip.envelope=0"}).find("FE260 solver.bodies: ball falls: ") != std::string::npos);
}

TEST_CASE("a piece that another body or a hold takes is not doubted, one that it does not take is", "[tools]") {
    // The attachment the other way round: the plate's vertices hold on to the nearest piece.
    json turned = two_cubes();
    turned["nodes"]["grip"]["inputs"] = {{"source", {{"from", "plate.outBody"}}},
                                         {"target", {{"from", "ball.outBody"}}}};
    CHECK(said_of(turned).find(falls) != std::string::npos);
    json graph = two_cubes();
    json& nodes = graph["nodes"];
    nodes["hold"] = json::parse(R"({"type": "zHold", "inputs": {"tissue": {"from": "ball.outBody"},
        "weights": {"from": "side.outWeights"}}})");
    nodes["side"] = json::parse(R"({"type": "weights", "inputs": {"mesh": {"from": "ballMesh.outMesh"},
        "mode": "sphere", "center": [40, 10, 0], "radius": 8}})");
    nodes["solver"]["inputs"]["forces"] = json::array({{{"from", "hold.outForce"}}});
    CHECK(said_of(graph).find("FE260") == std::string::npos);
    CHECK(said_of(graph, {"side.center=[0, 10, 0]"}).find(falls) != std::string::npos);
    // What it could fall on may catch it.
    CHECK(said_of(two_cubes(), {"solver.collisionDetection=true"}).find("FE260") == std::string::npos);
}
