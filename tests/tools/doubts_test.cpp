// What check doubts: each mistake made once, and the cure that it names.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/doubting.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <set>
#include <sstream>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

TEST_CASE("check doubts nothing of a sound graph", "[tools]") { CHECK(all_said_of(ball()).empty()); }

TEST_CASE("check doubts nothing of the graphs that ship", "[tools]") {
    for (const char* folder : {"graphs/learn", "graphs/demos", "graphs/scenes", "graphs/bench"})
        for (const auto& entry : fs::directory_iterator(fs::path(SINEW_SOURCE_DIR) / folder)) {
            if (entry.path().extension() != ".json") continue;
            INFO(entry.path());
            const Said said = run_program({"check", entry.path().string(), "--json", "--no-cache"});
            CHECK(said.code == 0);
            const auto lines = said.lines(); // one: that it has been checked
            CHECK(lines.size() == 1);
            CHECK(lines.back().at("warnings") == 0);
        }
}

TEST_CASE("check doubts sizes that no flesh has and names the scale that would give it one", "[tools]") {
    CHECK(said_of(ball(), {"solver.scale=1"}) ==
          "FE261 solver.scale: ball is 20 m long: 20 scene units, 1 a metre | if it is modelled in centimetres, write "
          "\"scale\": 100, which makes it 20 cm; if in millimetres, 1000, which makes it 2 cm\n");
    CHECK(said_of(ball(), {"solver.scale=5000"}) ==
          "FE261 solver.scale: ball is 4 mm long: 20 scene units, 5000 a metre | if it is modelled in centimetres, "
          "write \"scale\": 100, which makes it 20 cm; if in millimetres, 1000, which makes it 2 cm\n");
    // 2 scene units cannot be centimetres of what flesh is but just so, nor millimetres.
    CHECK(said_of(ball(), {"ballMesh.radius=1", "tets.tetSize=0.8", "top.start=0.8", "top.end=0.9", "solver.scale=1000",
                           "platePlace.translate=[0, 1, 0]"})
              .find("write \"scale\": 100, which makes it 2 cm; if in metres, 1, which makes it 2 m\n") !=
          std::string::npos);
}

TEST_CASE("check doubts flesh of pascals", "[tools]") {
    CHECK(said_of(ball(), {"flesh.youngsModulus=12"}) ==
          "FE263 flesh.youngsModulus: 12 Pa is softer than any flesh; brain has 500 Pa, a muscle 12 kPa | if "
          "kilopascals are meant, write \"12 kPa\"\n");
    CHECK(said_of(ball(), {"flesh.youngsModulus=gelatin"}).empty()); // asked for by name
}

TEST_CASE("check doubts attachments of whole bodies and names what to paint", "[tools]") {
    json graph = ball();
    graph["nodes"]["grip"]["inputs"].erase("weights");
    CHECK(said_of(graph) == "FE264 grip.weights: ties the whole surface of ball | paint where it holds on: a node "
                            "weights with the mesh of ball, for example with mode near\n");
    // Half as stiff is still everywhere; the least place without is a part.
    CHECK(said_of(graph, {"grip.weights=[0.5]"}).starts_with("FE264 grip.weights: ties the whole surface of ball"));
    // So is nearly all of it: the height of a sphere is as its area, here 19 of 20 parts.
    json most = ball();
    CHECK(said_of(most, {"top.start=-9", "top.end=-8.9"}).find("% of the surface of ball") != std::string::npos);
    CHECK(said_of(most, {"top.start=-5", "top.end=-4.9"}).empty());
    // However weakly it is painted.
    CHECK(said_of(most, {"top.start=-9.5", "top.end=12"}).find("% of the surface of ball") != std::string::npos);
    // A bone within flesh is held all around.
    graph["nodes"]["grip"]["inputs"]["source"] = {{"from", "plate.outBody"}};
    graph["nodes"]["grip"]["inputs"]["target"] = {{"from", "ball.outBody"}};
    CHECK(said_of(graph, {"grip.maxDistance=100"}).find("FE264") == std::string::npos);
}

TEST_CASE("a goal that draws all of a body is not doubted", "[tools]") {
    json graph = ball();
    json& nodes = graph["nodes"];
    nodes["model"] = json::parse(R"({"type": "zBone", "inputs": {"mesh": {"from": "ballMesh.outMesh"}}})");
    nodes["draw"] = json::parse(R"({"type": "zGoalAttachment", "inputs": {"source": {"from": "ball.outBody"},
        "target": {"from": "model.outBody"}}})");
    nodes["solver"]["inputs"]["bodies"].push_back({{"from", "model.outBody"}});
    nodes["solver"]["inputs"]["attachments"].push_back({{"from", "draw.outAttachment"}});
    CHECK(said_of(graph).empty());
    nodes["draw"]["type"] = "zAttachment";
    CHECK(said_of(graph).starts_with("FE264 draw.weights: ties the whole surface of ball"));
}

TEST_CASE("a cloth that clings to flesh everywhere is not doubted, to a bone it is", "[tools]") {
    json graph = ball();
    json& nodes = graph["nodes"];
    nodes["skin"] = json::parse(R"({"type": "zCloth", "inputs": {"mesh": {"from": "ballMesh.outMesh"},
        "materials": [{"from": "cotton.outMaterial"}]}})");
    nodes["cotton"] = json::parse(R"({"type": "zMaterial", "inputs": {"tensileStiffness": 500, "shearStiffness": 50,
        "bendStiffness": 1e-5, "clothMassDensity": 0.2}})");
    nodes["cling"] = json::parse(R"({"type": "zAttachment", "inputs": {"source": {"from": "skin.outBody"},
        "target": {"from": "ball.outBody"}}})");
    nodes["solver"]["inputs"]["bodies"].push_back({{"from", "skin.outBody"}});
    nodes["solver"]["inputs"]["attachments"].push_back({{"from", "cling.outAttachment"}});
    CHECK(said_of(graph).find("FE264") == std::string::npos);
    nodes["cling"]["inputs"]["target"] = {{"from", "plate.outBody"}};
    CHECK(said_of(graph, {"cling.maxDistance=100"}).find("FE264 cling.weights: ties the whole surface of skin") !=
          std::string::npos);
}

TEST_CASE("check doubts tissues that fall", "[tools]") {
    json graph = ball();
    graph["nodes"]["solver"]["inputs"].erase("attachments");
    const std::string falls = "FE260 solver.bodies: ball falls: no chain of attachments ties it to a bone, and nothing "
                              "holds it | attach it to a bone, hold a part of it by zHold, or switch gravity off: "
                              "[0, 0, 0]\n";
    CHECK(said_of(graph) == falls);
    CHECK(said_of(graph, {"solver.gravity=[0, 0, 0]"}).empty());
    // What ties it is there and does nothing, at any frame.
    const std::string idle = "; attachments without stiffness or envelope tie nothing: grip";
    CHECK(said_of(ball(), {"grip.envelope=0"}).find("FE260 solver.bodies: ball falls") == 0);
    // What its keys leave so throughout the timing is so.
    json timed = ball();
    timed["timing"] = {{"start", 1}, {"end", 12}};
    for (const char* so : {R"(grip.envelope={"keys": [[1, 0], [90, 1]], "interp": "step"})",
                           R"(plate.enable={"keys": [[1, false], [90, true]]})"}) {
        INFO(so);
        CHECK(said_of(timed, {so}).find("FE260 solver.bodies: ball falls") == 0);
        CHECK(said_of(ball(), {so}).find("FE260") == std::string::npos); // nobody says for how long that is
    }
    CHECK(said_of(timed, {R"(grip.envelope={"keys": [[1, 0], [90, 1]]})"}).find("FE260") == std::string::npos);
    CHECK(said_of(timed, {R"(plate.enable={"keys": [[1, false], [12, true]]})"}).find("FE260") == std::string::npos);
    // Two bones of one mesh in one place, which part later: either holds it.
    json twins = ball();
    twins["nodes"]["twin"] = twins["nodes"]["plate"];
    twins["nodes"]["twin"]["inputs"]["matrix"] = {{"from", "twinPlace.outMatrix"}};
    twins["nodes"]["twinPlace"] = twins["nodes"]["platePlace"];
    twins["nodes"]["twinPlace"]["inputs"]["translate"] =
        json::parse(R"({"keys": [[1, [0, 10, 0]], [9, [0, 10, 0]], [24, [0, 60, 0]]]})");
    twins["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", "twin.outBody"}});
    CHECK(said_of(twins).find("FE260") == std::string::npos);
    CHECK(said_of(ball(), {"grip.envelope=0"}).find(idle) != std::string::npos);
    CHECK(said_of(ball(), {"grip.stiffness=0"}).find(idle) != std::string::npos);
    CHECK(said_of(ball(), {R"(grip.envelope={"keys": [[1, 0], [5, 1]]})"}).empty());
    CHECK(said_of(ball(), {"plate.enable=false"}) == falls);
    CHECK(said_of(ball(), {R"(plate.enable={"keys": [[1, false], [5, true]]})"}).empty());
    CHECK(said_of(graph, {"solver.integrator=QuasiStatic"}, 1).starts_with("FE303 solver.bodies"));
    // Where bodies collide the plate may catch it, if they do so with each other.
    CHECK(said_of(graph, {"solver.collisionDetection=true"}).empty());
    const std::string past = "FE260 solver.bodies: ball falls: no chain of attachments ties it to a bone, and nothing "
                             "holds it or could catch it | ";
    CHECK(said_of(graph, {"solver.collisionDetection=true", R"(ball.collisionSets="1")", R"(plate.collisionSets="2")"})
              .find(past) != std::string::npos);
    const auto falls_past = [&](const std::string& setting) {
        return said_of(graph, {"solver.collisionDetection=true", setting}).find(past) != std::string::npos;
    };
    CHECK(falls_past("plate.collisions=false"));
    CHECK(falls_past("ball.contactStiffness=0"));
    CHECK_FALSE(falls_past(R"(plate.collisions={"keys": [[1, false], [3, true]]})"));
    CHECK_FALSE(falls_past(R"(ball.contactStiffness={"keys": [[1, 0], [3, 1e7]]})"));
    CHECK(said_of(graph, {R"(solver.collisionDetection={"keys": [[1, false], [3, true]]})"}).empty());
    graph["nodes"]["hold"] = {
        {"type", "zHold"},
        {"inputs", {{"tissue", {{"from", "ball.outBody"}}}, {"weights", {{"from", "top.outWeights"}}}}}};
    graph["nodes"]["solver"]["inputs"]["forces"] = json::array({{{"from", "hold.outForce"}}});
    CHECK(said_of(graph).empty());
    // Tied to what is tied is held, to what falls is not.
    json pair = ball();
    pair["nodes"]["second"] = pair["nodes"]["ball"];
    pair["nodes"]["secondFlesh"] = {{"type", "zMaterial"}, {"inputs", {{"youngsModulus", 30000}}}};
    pair["nodes"]["second"]["inputs"]["materials"][0]["from"] = "secondFlesh.outMaterial";
    pair["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", "second.outBody"}});
    const std::string said = said_of(pair); // and lies where the first does
    CHECK(said.starts_with("FE341 second.mesh: begins exactly where ball does"));
    CHECK(said.find("\nFE260 solver.bodies: second falls") != std::string::npos);
    pair["nodes"]["glue"] = pair["nodes"]["grip"];
    pair["nodes"]["glue"]["inputs"]["source"]["from"] = "second.outBody";
    pair["nodes"]["glue"]["inputs"]["target"]["from"] = "ball.outBody";
    pair["nodes"]["solver"]["inputs"]["attachments"].push_back({{"from", "glue.outAttachment"}});
    CHECK(said_of(pair).empty());
    // The other way round it ties as well.
    pair["nodes"]["glue"]["inputs"]["source"]["from"] = "ball.outBody";
    pair["nodes"]["glue"]["inputs"]["target"]["from"] = "second.outBody";
    CHECK(said_of(pair).empty());
}

TEST_CASE("check doubts scales that mirror", "[tools]") {
    CHECK(said_of(ball(), {"platePlace.scale=[-1, 1, 1]"}) ==
          "FE265 platePlace.scale: the scale mirrors, which turns what is moved inside out: its faces look inwards | "
          "mirror the mesh where it is modelled and turn its faces, or scale by positive numbers and rotate\n");
    CHECK(said_of(ball(), {"platePlace.scale=[-1, -1, 1]"}).empty()); // half a turn
    const std::string keyed = R"(platePlace.scale={"keys": [[1, [1, 1, -1]], [2, [1, 1, -1]]]})";
    CHECK(said_of(ball(), {keyed}).starts_with("FE265 platePlace.scale: the scale mirrors"));
    // Only later: a body that is turned inside out on its way.
    const std::string later = R"(platePlace.scale={"keys": [[1, [1, 1, 1]], [12, [1, 1, 0.5]], [24, [1, 1, -1]]]})";
    CHECK(said_of(ball(), {later}).starts_with("FE265 platePlace.scale: the scale at frame 24 mirrors, "));
    const std::string grows = R"(platePlace.scale={"keys": [[1, [1, 1, 1]], [24, [2, 2, 2]]]})";
    CHECK(said_of(ball(), {grows}).empty());
}

TEST_CASE("check finds a tissue's mesh that moves, at the frame at which a run would end", "[tools]") {
    json graph = ball();
    graph["timing"] = {{"start", 1}, {"end", 24}};
    graph["nodes"]["way"] = {{"type", "transform"}, {"inputs", {{"mesh", {{"from", "ballMesh.outMesh"}}}}}};
    graph["nodes"]["ball"]["inputs"]["mesh"] = {{"from", "way.outMesh"}};
    CHECK(said_of(graph).empty());
    // There and back again.
    const std::string keys =
        R"(way.translate={"keys": [[1, [0, 0, 0]], [5, [0, 0, 0]], [12, [0, 1, 0]], [24, [0, 0, 0]]]})";
    const std::string said = said_of(graph, {keys}, 1);
    CHECK(said.find("FE211 solver.bodies: the rest shape of ball is not that of the start frame | ") !=
          std::string::npos);
    CHECK(said.find("FE211 ball.mesh: its mesh is another one at frame 12.5, and the run ends where the rest shape "
                    "changes | ") != std::string::npos);
    CHECK(said_of(graph, {R"(way.translate={"keys": [[1, [0, 0, 0]], [2, [0, 1, 0]]]})"}, 1)
              .find("FE211 ball.mesh: its mesh is another one at frame 2, ") != std::string::npos);
    // A run doubts it before it comes to that.
    const TemporaryFolder folder;
    const Said run =
        run_program({"run", write_graph(folder, graph), "--no-cache", "--json", "--frames", "1", "--set", keys});
    CHECK(run.code == 0);
    CHECK(run.out.find("its mesh is another one at frame 12.5, and the run ends where the rest shape changes") !=
          std::string::npos);
}

TEST_CASE("check doubts matrices that mirror where they come in, and once", "[tools]") {
    const std::string mirror = "[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]", turn = "[-1,0,0,0, 0,-1,0,0, 0,0,1,0, 0,0,0,1]";
    const std::string said = ": the matrix mirrors, which turns what is moved inside out: its faces look inwards | "
                             "mirror the mesh where it is modelled and turn its faces, or scale by positive numbers "
                             "and rotate\n";
    CHECK(said_of(ball(), {"plate.matrix=" + mirror}).starts_with("FE265 plate.matrix" + said));
    CHECK(said_of(ball(), {"plate.matrix=" + turn}).find("FE265") == std::string::npos);
    CHECK(said_of(ball(), {"platePlace.offsetParentMatrix=" + mirror}) == "FE265 platePlace.offsetParentMatrix" + said);
    // Mirrored twice is not mirrored.
    CHECK(said_of(ball(), {"platePlace.offsetParentMatrix=" + mirror, "platePlace.scale=[1, -1, 1]"}).empty());
    // What goes along with a transform above it is not told again.
    json graph = ball();
    graph["nodes"]["above"] = {{"type", "transform"}, {"inputs", {{"scale", {1, -1, 1}}}}};
    graph["nodes"]["platePlace"]["inputs"]["offsetParentMatrix"] = {{"from", "above.outMatrix"}};
    graph["nodes"]["platePlace"]["inputs"]["translate"] = {0, -10, 0};
    CHECK(said_of(graph).starts_with("FE265 above.scale: the scale mirrors"));
    CHECK(said_of(graph).find("platePlace") == std::string::npos);
}

TEST_CASE("scales and matrices that make everything flat are refused with what is right", "[tools]") {
    const std::string right = " | Scale along each axis by a number other than 0; 1 leaves the size alone.\n";
    const std::string flat = ": the matrix makes everything flat: what it moves has no volume left" + right;
    CHECK(said_of(ball(), {"platePlace.scale=[1, 0, 1]"}, 1) ==
          "FE332 platePlace.scale: the scale along y is 0, which makes everything flat: what it moves has no volume "
          "left" +
              right);
    CHECK(said_of(ball(), {"plate.matrix=[0,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]"}, 1) == "FE332 plate.matrix" + flat);
    // Two axes that become one.
    CHECK(said_of(ball(), {"platePlace.offsetParentMatrix=[1,1,0,0, 1,1,0,0, 0,0,1,0, 0,0,0,1]"}, 1) ==
          "FE332 platePlace.offsetParentMatrix" + flat);
    // Small is not flat; the bone is then merely small.
    CHECK(said_of(ball(), {"platePlace.scale=[1e-3, 1e-3, 1e-3]", "grip.maxDistance=100"}).find("FE332") ==
          std::string::npos);
    CHECK(said_of(ball(), {"solver.scale=0"}, 1) == "DG013 solver.scale: 0 is outside [1e-12, 1e+12] | Scene units per "
                                                    "metre: 100 reads the scene as centimetres, 1 as "
                                                    "metres\n");
}

TEST_CASE("check doubts holds of whole tissues and names what to paint", "[tools]") {
    json graph = ball();
    graph["nodes"]["hold"] = {{"type", "zHold"}, {"inputs", {{"tissue", {{"from", "ball.outBody"}}}}}};
    graph["nodes"]["solver"]["inputs"]["forces"] = json::array({{{"from", "hold.outForce"}}});
    const std::string said = "FE331 hold.weights: holds the whole of ball, so nothing of it moves or deforms by itself "
                             "| paint what is to be held: a node weights with the mesh of ball, for example with mode "
                             "near; what is to move as a whole is a zBone\n";
    CHECK(said_of(graph) == said);
    CHECK(said_of(graph, {"hold.weights=[0.5]"}) == said);
    CHECK(said_of(graph, {"hold.enable=false"}).empty());
    graph["nodes"]["hold"]["inputs"]["weights"] = {{"from", "top.outWeights"}};
    CHECK(said_of(graph).empty());
    CHECK(said_of(graph, {"top.start=-12", "top.end=-11"}).find("FE331 hold.weights") != std::string::npos);
}

TEST_CASE("check doubts nodes that nothing reads and names what could", "[tools]") {
    json graph = ball();
    graph["nodes"]["solver"]["inputs"]["attachments"] = json::array();
    CHECK(all_said_of(graph, {"solver.gravity=[0, 0, 0]"}) ==
          "FE330 grip.: nothing reads it, so it does nothing, nor does top | connect it to solver.attachments, or take "
          "it out of the graph\n");
    // A node alone, and one that only reads what is used.
    graph = ball();
    graph["nodes"]["fat"] = {{"type", "zMaterial"}, {"inputs", {{"youngsModulus", "2 kPa"}}}};
    graph["nodes"]["second"] = graph["nodes"]["top"];
    CHECK(
        all_said_of(graph) ==
        "FE330 fat.: it is connected to nothing, so it does nothing | connect it to ball.materials, or take it out of "
        "the graph\n"
        "FE330 second.: nothing reads it, so it does nothing | connect it to where it is to act, or take it out of the "
        "graph\n");
    // Of many some are told.
    json many = ball();
    for (int i = 0; i < 25; ++i) many["nodes"]["spare" + std::to_string(i)] = {{"type", "zMaterial"}};
    const std::string told = all_said_of(many);
    CHECK(std::count(told.begin(), told.end(), '\n') == 20);
    CHECK(told.find("does nothing; so it is with 5 more nodes | ") != std::string::npos);
    // Where nothing is simulated, any end may be what is asked for.
    for (const char* name : {"solver", "grip", "second"}) graph["nodes"].erase(name);
    CHECK(all_said_of(graph).empty());
}

TEST_CASE("check doubts nothing that reads what a solver gives, that makes a file, or that an included graph brings",
          "[tools]") {
    json graph = ball();
    // The result carries a picture of the ball's rest shape, which nothing else reads.
    graph["nodes"]["rest"] = {{"type", "polySphere"}, {"inputs", {{"radius", 9}}}};
    graph["nodes"]["carried"] = {{"type", "zEmbedder"},
                                 {"inputs",
                                  {{"solved", {{"from", "solver.outSolved"}}},
                                   {"body", {{"from", "ball.outBody"}}},
                                   {"meshes", {{{"from", "rest.outMesh"}}}}}}};
    graph["nodes"]["picture"] = {{"type", "meshWriter"}, {"inputs", {{"mesh", {{"from", "rest.outMesh"}}}}}};
    const std::string said = all_said_of(graph);
    INFO(said);
    CHECK(said.find("FE330") == std::string::npos);
    const TemporaryFolder folder;
    write_text(folder / "part.json", R"({"format": "sinew 1", "nodes": {"stone": {"type": "zMaterial"}}})");
    json top = ball();
    top["includes"] = {{"part", {{"file", "part.json"}}}};
    const Said checked = run_program({"check", write_graph(folder, top), "--no-cache"});
    CHECK(checked.code == 0);
    CHECK(checked.out.find(": right, ") != std::string::npos);
}

TEST_CASE("run doubts frames outside of the graph's timing", "[tools]") {
    const TemporaryFolder folder;
    json graph = ball();
    const auto said = [&](const std::string& frames) {
        return run_program({"run", write_graph(folder, graph), "--no-cache", "--quiet", "--frames", frames}).err;
    };
    CHECK(said("1-3").empty()); // whoever writes no timing says nothing of how long the shot is
    graph["timing"] = {{"start", 2}, {"end", 4}};
    CHECK(said("2-4").empty());
    CHECK(said("1,3,5-6") ==
          "warning [FE333] frames 1 and 5-6 lie outside of the graph's timing, 2 to 4: what is keyed and "
          "recorded may not be meant for them\n  hint: run --frames 2-4, or change timing.start and "
          "timing.end in the graph\n");
    CHECK(said("5").starts_with("warning [FE333] frame 5 lies outside of the graph's timing, 2 to 4"));
    const Said shot = run_program({"snapshot", write_graph(folder, graph), "--no-cache", "--frames", "5", "--output",
                                   (folder.path() / "shot.png").string()});
    CHECK(shot.code == 0);
    CHECK(shot.err.starts_with(
        "warning [FE333] frame 5 lies outside of the graph's timing, 2 to 4: what is keyed and recorded may "
        "not be meant for it\n  hint: snapshot --frames 2-4, or change timing.start and timing.end in the "
        "graph\n"));
}

TEST_CASE("check names the bone that is attached to but none of the bodies", "[tools]") {
    json graph = ball();
    graph["nodes"]["solver"]["inputs"]["bodies"].erase(0);
    const std::string said = said_of(graph, {}, 1);
    CHECK(said == "FE209 solver.attachments: the target (plate) of grip is none of this solver's bodies | Connect to "
                  "zSolver.bodies too: plate.\n");
    // Other bodies than those that are tied.
    graph["nodes"]["other"] = graph["nodes"]["plate"];
    graph["nodes"]["other"]["inputs"]["mesh"]["from"] = "ballMesh.outMesh";
    graph["nodes"]["solver"]["inputs"]["bodies"] = json::array({{{"from", "other.outBody"}}});
    CHECK(said_of(graph, {}, 1) == "FE209 solver.attachments: the source (ball) and the target (plate) of grip are "
                                   "none of this solver's bodies | Connect to zSolver.bodies too: ball, plate.\n");
}

TEST_CASE("a node of an unknown type is an error of check beside all others", "[tools]") {
    json graph = ball();
    graph["nodes"]["odd"] = {{"type", "zTisue"}};
    CHECK(said_of(graph, {}, 1) == "DG010 odd.: this program does not know the type \"zTisue\" | did you mean "
                                   "\"zTissue\"?\n");
    graph["nodes"]["flesh"]["inputs"]["youngsModulus"] = -1;
    const std::string both = said_of(graph, {}, 1);
    CHECK(both.find("DG010 odd.") != std::string::npos);
    CHECK(both.find("DG013 flesh.youngsModulus") != std::string::npos);
}

TEST_CASE("run says what check doubts and puts it into the report", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = write_graph(folder, ball()), report = (folder / "report.json").string();
    const std::vector<std::string> settings{"--set", "solver.scale=1",         "--set", "grip.envelope=0",
                                            "--set", "flesh.youngsModulus=12", "--set", "tets.tetSize=100"};
    const auto codes_of = [&](std::vector<std::string> words) {
        words.insert(words.end(), settings.begin(), settings.end());
        const Said said = run_program(words);
        CHECK(said.code == 0);
        std::set<std::string> out;
        for (const json& d : said.lines())
            if (d.at("event") == "diagnostic") out.insert(d.at("code").get<std::string>());
        return out;
    };
    const auto checked = codes_of({"check", file, "--json", "--no-cache"});
    CHECK(checked == std::set<std::string>{"FE260", "FE261", "FE262", "FE263"});
    CHECK(codes_of({"run", file, "--json", "--no-cache", "--frames", "1", "--report", report}) == checked);
    std::set<std::string> reported;
    const json written = json::parse(read_text(report));
    for (const json& d : written.at("warnings")) reported.insert(d.at("code").get<std::string>());
    CHECK(reported == checked);
    // Nothing is said of what is not pulled.
    json aside = ball();
    aside["nodes"]["odd"] = {{"type", "zMaterial"}, {"inputs", {{"youngsModulus", 12}}}};
    const std::string beside = write_graph(folder, aside, "beside.json");
    CHECK(run_program({"run", beside, "--no-cache", "--frames", "1", "--quiet"}).err.empty());
    CHECK(run_program({"check", beside, "--no-cache"}).err.find("FE263") != std::string::npos);
}

TEST_CASE("check and run refuse types that they do not know and say so once", "[tools]") {
    const TemporaryFolder folder;
    json unused = ball(), needed = ball(), beside = ball();
    unused["nodes"]["odd"] = {{"type", "zTisue"}};
    needed["nodes"]["flesh"]["type"] = "zMaterail";
    beside["nodes"]["flesh"]["type"] = "zMaterail";
    beside["nodes"]["solver"]["inputs"]["scale"] = "large";
    const auto severities = [&](const char* command, const json& graph) {
        const Said said = run_program({command, write_graph(folder, graph), "--json", "--no-cache"});
        CHECK(said.code == 1);
        std::string out;
        for (const json& d : said.lines())
            if (d.at("event") == "diagnostic")
                out += d.at("severity").get<std::string>() + " " + d.at("code").get<std::string>() + "; ";
        return out;
    };
    for (const char* command : {"check", "run"}) {
        INFO(command);
        CHECK(severities(command, unused) == "error DG010; ");
        CHECK(severities(command, needed) == "error DG010; ");
        CHECK(severities(command, beside) == "error DG016; error DG010; ");
    }
}

TEST_CASE("check doubts bodies whose files are in another unit than the others", "[tools]") {
    const TemporaryFolder folder;
    // A bone of 10 scene units, modelled in metres beside a ball in centimetres.
    const auto written = [&](double size) {
        std::string text;
        for (const char* corner : {"0 0 0", "1 0 0", "0 1 0", "0 0 1"}) {
            text += "v";
            std::istringstream in(corner);
            for (double v; in >> v;) text += " " + std::to_string(size * v);
            text += "\n";
        }
        write_text(folder / "bone.obj", text + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    };
    json graph = ball();
    graph["nodes"]["plateMesh"] = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "bone.obj").string()}}}};
    graph["nodes"]["grip"]["inputs"]["maxDistance"] = 1000;
    written(0.1);
    const std::string small = said_of(graph);
    CHECK(
        small.find("FE320 solver.bodies: plate is 0.1 scene units long, the other bodies 20 scene units: smaller by a "
                   "factor of about 200 | if they are modelled in different units, put a transform with scale 100 "
                   "between the file and plate") != std::string::npos);
    written(10000);
    CHECK(said_of(graph).find("FE320 solver.bodies: plate is 10000 scene units long, the other bodies 20 scene units: "
                              "larger by a factor of about 500 | if they are modelled in different units, put a "
                              "transform with scale 0.001 between the file and plate") != std::string::npos);
    CHECK(said_of(graph, {"platePlace.scale=[0.001, 0.001, 0.001]"}).find("FE320") == std::string::npos);
    written(10);
    CHECK(said_of(graph).find("FE320") == std::string::npos);
    // Of the one that is odd no scale for all is proposed.
    json odd = ball();
    odd["nodes"]["ballMesh"] = graph["nodes"]["plateMesh"];
    written(10000);
    const std::string large = said_of(odd, {"tets.tetSize=4000"});
    CHECK(large.find("FE320 solver.bodies: ball is 10000 scene units long") != std::string::npos);
    CHECK(large.find("FE261") == std::string::npos);
    // What a node makes is as large as the graph says.
    CHECK(said_of(ball(), {"plateMesh.width=5000"}).find("FE320") == std::string::npos);
}

TEST_CASE("a unit that is doubted is told beside the errors that come of it", "[tools]") {
    const TemporaryFolder folder;
    write_text(folder / "box.obj", "v 0 0 0\nv 0.02 0 0\nv 0 0.02 0\nv 0 0 0.02\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    json graph = ball();
    graph["nodes"]["ballMesh"] = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "box.obj").string()}}}};
    const std::string said = said_of(graph, {"tets.tetSize=0.01"}, 1);
    CHECK(said.find("FE212 grip.weights") != std::string::npos);
    CHECK(said.find("FE320 solver.bodies: ball is 0.02 scene units long, the other bodies 10 scene units: smaller by a "
                    "factor of about 500") != std::string::npos);
}

TEST_CASE("check doubts tissues with faces that are turned or doubled", "[tools]") {
    const TemporaryFolder folder;
    const std::string corners = "v -5 -5 -5\nv 5 -5 -5\nv 5 5 -5\nv -5 5 -5\nv -5 -5 5\nv 5 -5 5\nv 5 5 5\nv -5 5 5\n",
                      box = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n";
    json graph = ball();
    graph["nodes"]["ballMesh"] = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "box.obj").string()}}}};
    graph["nodes"]["top"]["inputs"]["start"] = 4, graph["nodes"]["top"]["inputs"]["end"] = 4.5;
    const auto said = [&](const std::string& last) {
        write_text(folder / "box.obj", corners + box + last);
        return said_of(graph);
    };
    CHECK(said("f 4 1 5 8\n").find("FE321") == std::string::npos);
    CHECK(said("f 8 5 1 4\n")
              .find("FE321 ball.mesh: some faces of its mesh look the other way than their neighbours: 4 "
                    "edges between opposite sides") != std::string::npos);
    CHECK(said("f 4 1 5 8\nf 4 1 5 8\n").find("FE321 ball.mesh: its mesh has 2 repeated triangles") !=
          std::string::npos);
}

TEST_CASE("check doubts meshes that are inside out", "[tools]") {
    const TemporaryFolder folder;
    write_text(folder / "box.obj",
               "v -5 -5 -5\nv 5 -5 -5\nv 5 5 -5\nv -5 5 -5\nv -5 -5 5\nv 5 -5 5\nv 5 5 5\nv -5 5 5\n"
               "f 2 3 4 1\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n");
    json graph = ball();
    const json file = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "box.obj").string()}}}};
    graph["nodes"]["plateMesh"] = file; // a bone: contact goes by its normals
    graph["nodes"]["grip"]["inputs"]["maxDistance"] = 100;
    CHECK(said_of(graph) == "FE321 plate.mesh: all faces of its mesh look inwards | turn them where it is modelled; "
                            "pressure, contact and drawing go by the side that a face shows\n");
    graph = ball();
    graph["nodes"]["ballMesh"] = file;
    graph["nodes"]["top"]["inputs"]["start"] = 4, graph["nodes"]["top"]["inputs"]["end"] = 4.5;
    CHECK(said_of(graph).find("FE321 ball.mesh: all faces of its mesh look inwards") != std::string::npos);
}

TEST_CASE("check tells how far paint and attachments reach where a mesh may be in another unit", "[tools]") {
    json graph = ball(); // near, without innerDistance and outerDistance: 0.5 and 2
    graph["nodes"]["top"]["inputs"] = {
        {"mesh", {{"from", "ballMesh.outMesh"}}}, {"mode", "near"}, {"otherMesh", {{"from", "plateMesh.outMesh"}}}};
    // The plate lies where it is modelled: around the centre of a ball ten times too large.
    const std::string near = said_of(graph, {"ballMesh.radius=100", "tets.tetSize=80"}, 1);
    CHECK(near.find("FE325 top.outerDistance: nothing of ballMesh is within 2 of plateMesh, so nothing is painted: its "
                    "nearest point is ") != std::string::npos);
    CHECK(near.find(" away (ballMesh is 200 long, plateMesh 10) | widen outerDistance, or, if one of them is modelled "
                    "in another unit, scale it by a transform\n") != std::string::npos);
    CHECK(near.find("FE212 grip.weights") != std::string::npos);
    // What the rule paints counts, and not what is made of it; without points there is nothing to measure.
    CHECK(said_of(graph, {"top.outerDistance=20", "top.offset=-1"}, 1).find("FE325") == std::string::npos);
    graph["nodes"]["none"] = {{"type", "transform"}};
    graph["nodes"]["top"]["inputs"]["otherMesh"]["from"] = "none.outMesh";
    CHECK(said_of(graph, {}, 1).find("FE212 grip.weights") != std::string::npos);
    graph["nodes"]["top"]["inputs"] = {
        {"mesh", {{"from", "ballMesh.outMesh"}}}, {"mode", "sphere"}, {"center", {0, 30, 0}}, {"radius", 2}};
    CHECK(said_of(graph, {}, 1)
              .find("FE325 top.radius: nothing of ballMesh is in the sphere, so nothing is painted: its "
                    "nearest point is 20 from the centre (ballMesh is 20 long) | ") != std::string::npos);
    // A ramp that was written for a ball ten times as large.
    CHECK(
        said_of(ball(), {"top.start=80", "top.end=90"}, 1)
            .find("FE325 top.start: nothing of ballMesh lies where it rises from 0 at y = 80 to 1 at 90, so nothing is "
                  "painted: ballMesh reaches from -10 to 10 | choose start and end within that; they are in scene "
                  "units. If ballMesh is modelled in another unit, scale it by a transform\n") != std::string::npos);
    // Painted by height, the top of the large ball is 90 and more from the plate of 10.
    const std::vector<std::string> large{"ballMesh.radius=100", "tets.tetSize=80", "top.start=80", "top.end=90"};
    CHECK(said_of(ball(), large) ==
          "FE242 solver.attachments: grip: it reaches 88.42 far, while its target is 10 long (ball is 200 long, plate "
          "10) | Check that it ties what it should; paint the part of the target that is meant as targetWeights; if "
          "one of the two is in another unit, scale it by a transform.\n");
    // A bone is as large as its matrix makes it.
    CHECK(said_of(ball(), {"plateMesh.width=0.1", "plateMesh.height=0.01", "plateMesh.depth=0.1",
                           "platePlace.scale=[100, 100, 100]"})
              .empty());
    CHECK(said_of(ball(), {"platePlace.translate=[0, 60, 0]"})
              .starts_with("FE242 solver.attachments: grip: it reaches 52.19 far, while the painted part of its source "
                           "is 20.21 large | Check that it ties what it should; paint the part of the target that is "
                           "meant as targetWeights.\n"));
}

TEST_CASE("check doubts values in another unit than the attribute's", "[tools]") {
    CHECK(said_of(ball(), {"solver.gravity=[0, -980, 0]"}) ==
          "FE322 solver.gravity: 980 m/s^2 is 100 times the earth's | gravity is in m/s^2, whatever the scene's scale: "
          "[0, -9.8, 0]\n");
    CHECK(said_of(ball(), {"solver.gravity=[0, -98, 0]"}).empty()); // a centrifuge
    CHECK(
        said_of(ball(), {"flesh.massDensity=1.06"}) ==
        "FE323 flesh.massDensity: 1.06 kg/m^3 is lighter than any flesh; water has 1000, a lung 250 | if grams a cubic "
        "centimetre are meant, write \"1.06 g/cm^3\"\n");
    CHECK(said_of(ball(), {"flesh.massDensity=1.06 g/cm^3"}).empty());
    json graph = ball();
    graph["nodes"]["fibre"] = {{"type", "zFiber"},
                               {"inputs", {{"direction", {0, 1, 0}}, {"strength", 60}, {"excitation", 1}}}};
    graph["nodes"]["ball"]["inputs"]["fibers"] = json::array({{{"from", "fibre.outFiber"}}});
    CHECK(said_of(graph).starts_with("FE324 fibre.strength: 60 Pa hardly pulls; muscles have 100 to 300 kPa | if "
                                     "kilopascals are meant, write \"60 kPa\"\n"));
    CHECK(said_of(graph, {"fibre.strength=0"}).find("FE324") == std::string::npos);
    CHECK(said_of(ball(), {"solver.gravity=[0, -1e8, 0]"})
              .starts_with("FE322 solver.gravity: 1e+08 m/s^2 is 1e+07 times the earth's | "));
    CHECK(said_of(ball(), {"grip.stiffness=1"}) ==
          "FE326 grip.stiffness: 1 N/m^3 holds nothing: the weight of a sheet of flesh 1 cm thick stretches it by 98 m "
          "| it is a force per area and length, not a factor: tendons take 1e8 to 1e10, soft ties 1e5\n");
    CHECK(said_of(ball(), {"grip.stiffness=0"}).find("FE326") == std::string::npos); // released
    CHECK(said_of(ball(), {"grip.stiffness=1", "grip.attachmentMode=none"}).find("FE326") == std::string::npos);
}

TEST_CASE("vertices outside of tets are told with the reason", "[tools]") {
    const TemporaryFolder folder;
    const std::string box = "v -5 -5 -5\nv 5 -5 -5\nv 5 5 -5\nv -5 5 -5\nv -5 -5 5\nv 5 -5 5\nv 5 5 5\nv -5 5 5\n"
                            "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    json graph = ball();
    graph["nodes"]["ballMesh"] = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "box.obj").string()}}}};
    graph["nodes"]["top"]["inputs"]["start"] = 4, graph["nodes"]["top"]["inputs"]["end"] = 4.5;
    write_text(folder / "box.obj", box + "v 50 0 0\n");
    std::string said = said_of(graph);
    CHECK(said.find("; 1 of them belong to no face | Nothing shows them;") != std::string::npos);
    write_text(folder / "box.obj", box + "v 50 0 0\nf 2 3 9\n");
    graph["nodes"]["box"] = {{"type", "polyCube"}, {"inputs", {{"width", 10}, {"height", 10}, {"depth", 10}}}};
    graph["nodes"]["tets"]["inputs"]["mesh"]["from"] = "box.outMesh";
    said = said_of(graph);
    CHECK(said.find("; 1 of them are at open edges") != std::string::npos);
    CHECK(said.find("| Remove faces that stick out") != std::string::npos);
}
