// One thing that is connected twice would act twice, which nobody means.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/doubting.h"

using namespace sinew::test;
using nlohmann::json;

TEST_CASE("an attachment that is connected twice is refused", "[tools]") {
    json graph = ball();
    graph["nodes"]["solver"]["inputs"]["attachments"].push_back({{"from", "grip.outAttachment"}});
    CHECK(said_of(graph, {}, 1) == "FE213 solver.attachments: grip is connected twice, so it would pull twice | Remove "
                                   "one of the two connections.\n");
}

TEST_CASE("what adds up is refused where it is connected twice", "[tools]") {
    json graph = ball();
    graph["nodes"]["fibre"] = {{"type", "zFiber"},
                               {"inputs", {{"direction", {0, 1, 0}}, {"strength", 60000}, {"excitation", 1}}}};
    const json one = {{"from", "fibre.outFiber"}};
    graph["nodes"]["ball"]["inputs"]["fibers"] = {one, one};
    CHECK(said_of(graph, {}, 1) ==
          "FE213 ball.fibers: fibre is connected twice, so it would pull twice | Remove one of the two connections.\n");
    graph = ball();
    graph["nodes"]["rest"] = {{"type", "zRestShape"},
                              {"inputs", {{"target", {{"from", "ballMesh.outMesh"}}}, {"targetWeight", 0.5}}}};
    const json shape = {{"from", "rest.outRestShape"}};
    graph["nodes"]["ball"]["inputs"]["restShapes"] = {shape, shape};
    CHECK(said_of(graph, {}, 1) ==
          "FE213 ball.restShapes: rest is connected twice, so it would count twice | Remove one of the two "
          "connections.\n");
    graph = ball();
    graph["nodes"]["wind"] = {{"type", "uniformField"}, {"inputs", {{"direction", {1, 0, 0}}, {"magnitude", 5}}}};
    const json force = {{"from", "wind.outForce"}};
    graph["nodes"]["solver"]["inputs"]["forces"] = {force, force};
    CHECK(said_of(graph, {}, 1) ==
          "FE213 solver.forces: wind is connected twice, so it would act twice | Remove one of the two connections.\n");
}
