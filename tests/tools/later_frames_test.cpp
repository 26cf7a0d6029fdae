// What check finds wrong at later frames, and that a run then ends for the same.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/doubting.h"

#include <catch2/catch.hpp>

using namespace sinew::test;
using nlohmann::json;

namespace {

/// The ball, for twelve frames.
json twelve_frames() {
    json graph = ball();
    graph["timing"] = {{"fps", 24}, {"start", 1}, {"end", 12}};
    return graph;
}

json held() {
    json graph = twelve_frames();
    graph["nodes"]["place"] = json::parse(R"({"type": "transform", "inputs": {}})");
    graph["nodes"]["hold"] = json::parse(R"({"type": "zHold", "inputs": {"tissue": {"from": "ball.outBody"},
        "weights": {"from": "top.outWeights"}, "matrix": {"from": "place.outMatrix"}}})");
    graph["nodes"]["solver"]["inputs"]["forces"] = json::parse(R"([{"from": "hold.outForce"}])");
    return graph;
}

struct Refusal {
    std::string code, plug;
    double frame = 0;
    bool operator==(const Refusal&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Refusal& r) {
    return out << r.code << " " << r.plug << " at frame " << r.frame;
}

std::vector<Refusal> refused_by(const std::string& command, const json& graph, const std::vector<std::string>& settings,
                                int code) {
    const TemporaryFolder folder;
    std::vector<std::string> words{command, write_graph(folder, graph), "--json", "--no-cache"};
    for (const std::string& s : settings) words.insert(words.end(), {"--set", s});
    const Said said = run_program(words);
    CHECK(said.code == code);
    std::vector<Refusal> out;
    for (const json& d : said.lines())
        if (d.at("event") == "diagnostic" && d.at("severity") == "error")
            out.push_back({d.at("code"), d.value("node", "") + "." + d.value("attribute", ""), d.value("frame", 0.0)});
    return out;
}

void check_refused(const json& graph, const std::vector<std::string>& settings, const Refusal& wanted, int code = 1) {
    CAPTURE(settings, wanted);
    CHECK(refused_by("check", graph, settings, 1) == std::vector{wanted});
    CHECK(refused_by("run", graph, settings, code) == std::vector{wanted});
}

std::string keyed(const std::string& plug, const std::string& first, const std::string& fifth) {
    return plug + R"(={"keys": [[1, )" + first + "], [4, " + first + "], [5, " + fifth + "]]}";
}

} // namespace

TEST_CASE("check finds at later frames what a run would be refused for there", "[tools]") {
    CHECK(refused_by("check", twelve_frames(), {}, 0).empty());
    check_refused(held(), {keyed("place.scale", "[1, 1, 1]", "[1, 2, 1]")}, {"FE250", "hold.matrix", 5});
    check_refused(held(), {R"(solver.scale={"keys": [[1, 100], [5, 110]]})"}, {"FE292", "solver.scale", 2});
    json placed = twelve_frames();
    placed["nodes"]["space"] = json::parse(R"({"type": "transform", "inputs": {}})");
    placed["nodes"]["solver"]["inputs"]["matrix"] = {{"from", "space.outMatrix"}};
    check_refused(placed, {keyed("space.scale", "[1, 1, 1]", "[1, 2, 1]")}, {"FE291", "solver.matrix", 5});
    check_refused(twelve_frames(), {"flesh.restScale=0.5", keyed("ball.restScaleEnvelope", "1", "500")},
                  {"FE247", "ball.restScaleEnvelope", 5});
    check_refused(twelve_frames(),
                  {R"(solver.integrator="QuasiStatic")", keyed("grip.attachmentMode", R"("fixed")", R"("none")")},
                  {"FE303", "solver.bodies", 5}, 3);
    json followed = held();
    followed["nodes"]["hold"]["inputs"].erase("matrix");
    followed["nodes"]["hold"]["inputs"]["bone"] = {{"from", "plate.outBody"}};
    check_refused(followed, {keyed("platePlace.scale", "[1, 1, 1]", "[1, 2, 1]")}, {"FE250", "solver.forces", 5});
}

TEST_CASE("check finds at later frames what only the solver's terms refuse", "[tools]") {
    const Said said = run_program({"check", SINEW_SOURCE_DIR "/graphs/learn/23_rest_shape.json", "--json", "--no-cache",
                                   "--set", R"(bent.targetWeight={"keys": [[1, 0], [7, 0], [8, 1e4]]})"});
    CHECK(said.code == 1);
    REQUIRE(said.lines().size() == 1);
    CHECK(said.lines()[0].at("code") == "FE247");
    CHECK(said.lines()[0].at("frame") == 8);
    CHECK(said.lines()[0].at("message").get<std::string>().starts_with("bar: the rest shapes together stretch"));
}

TEST_CASE("check looks ahead from where the solver starts, and not behind where it ends", "[tools]") {
    const std::string late = R"(place.scale={"keys": [[1, [1, 1, 1]], [12, [1, 1, 1]], [13, [1, 2, 1]]]})";
    CHECK(refused_by("check", held(), {late}, 0).empty());
    CHECK(refused_by("run", held(), {late}, 0).empty());
    const std::string before =
        R"(place.scale={"keys": [[-8, [1, 1, 1]], [-7, [2, 2, 2]], [-6, [1, 1, 1]], [1, [1, 1, 1]]]})";
    CHECK(refused_by("check", held(), {before}, 0).empty());
    CHECK(refused_by("check", held(), {before, "solver.startFrame=-8"}, 1) ==
          std::vector<Refusal>{{"FE250", "hold.matrix", -7}});
    // Between frames as well, where sub-steps read.
    const std::string between =
        R"(place.scale={"keys": [[1, [1, 1, 1]], [4, [1, 1, 1]], [4.5, [1, 2, 1]], [5, [1, 1, 1]]]})";
    CHECK(refused_by("check", held(), {between}, 0).empty());
    check_refused(held(), {between, "solver.substeps=2"}, {"FE250", "hold.matrix", 4.5});
}

TEST_CASE("check looks ahead at contact that comes and goes as a run does", "[tools]") {
    json graph = twelve_frames();
    const json cube = json::parse(R"([-5,9,-5, 5,9,-5, 5,10,-5, -5,10,-5, -5,9,5, 5,9,5, 5,10,5, -5,10,5])");
    json mirrored = cube;
    for (std::size_t i = 0; i < mirrored.size(); i += 3) mirrored[i] = -mirrored[i].get<double>();
    json turns = {{"keys", {{1, cube}, {2, cube}, {3, mirrored}}}, {"interp", "step"}};
    graph["nodes"]["plateMesh"] = {
        {"type", "hostMesh"},
        {"inputs",
         {{"points", turns}, {"faceSizes", {4, 4, 4, 4, 4, 4}}, {"faceVertices", {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1,
                                                                                  2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7}}}}};
    graph["nodes"]["plate"]["inputs"].erase("matrix");
    // Where it came on again the surface has another side than at the start, and no contact that could mind.
    const std::string again = R"(solver.collisionDetection={"keys": [[1, true], [2, false], [6, true]]})";
    CHECK(refused_by("run", graph, {again}, 0).empty());
    CHECK(refused_by("check", graph, {again}, 0).empty());
    // Once it is on, it does mind.
    json later = graph;
    later["nodes"]["plateMesh"]["inputs"]["points"]["keys"] = {{1, cube}, {7, cube}, {8, mirrored}};
    check_refused(later, {R"(solver.collisionDetection={"keys": [[1, false], [4, true]]})"},
                  {"FE211", "solver.bodies", 8});
}

TEST_CASE("check looks at frames of keys in long runs, and names the first that is refused", "[tools]") {
    json graph = held();
    graph["timing"]["end"] = 1001;
    const auto refused = [&](const std::string& keys) {
        return refused_by("check", graph, {"place.scale={\"keys\": [[1, [1, 1, 1]], " + keys + "]}"}, 1);
    };
    CHECK(refused("[101, [1, 1, 1]], [102, [1, 2, 1]], [103, [1, 1, 1]]") ==
          std::vector<Refusal>{{"FE250", "hold.matrix", 102}}); // alone
    CHECK(refused("[100, [1, 1, 1]], [900, [1, 2, 1]]") == std::vector<Refusal>{{"FE250", "hold.matrix", 101}});
    // A recorded motion has no keys: what is wrong within is found at frames in between.
    const TemporaryFolder folder;
    json samples = json::array();
    for (int frame = 1; frame <= 1001; ++frame) {
        const double wide = frame >= 500 && frame < 600 ? 2 : 1;
        samples.push_back(
            {{"frame", frame}, {"bones", {{"ulna", {wide, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}}});
    }
    write_text(folder / "track.json", json{{"frames", samples}}.dump());
    graph["nodes"]["place"]["inputs"] = {{"track", (folder / "track.json").string()}, {"trackName", "ulna"}};
    CHECK(refused_by("check", graph, {}, 1) == std::vector<Refusal>{{"FE250", "hold.matrix", 500}});
}
