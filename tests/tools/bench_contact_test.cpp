// `sinew bench contact`: what a row says of a scene, which scenes count as wrong, and that the shipped ones are right.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"
#include "tools/bench/contact.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

using namespace sinew;
using namespace sinew::test;
using Catch::Detail::Approx;
using nlohmann::json;

namespace {

/// A cube of half a metre, z up, in scene units of 0.5 m, that starts `height` scene units above a plate and flies
/// sideways at 0.25 m/s.
json flying(double height) {
    json graph = json::parse(R"({
      "format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 13},
      "nodes": {
        "slab": {"type": "polyCube", "inputs": {"width": 8, "height": 8, "depth": 0.5}},
        "slabPlace": {"type": "transform", "inputs": {"mesh": {"from": "slab.outMesh"}, "translate": [0, 0, -0.25]}},
        "ground": {"type": "zBone", "inputs": {"mesh": {"from": "slabPlace.outMesh"}}},
        "cube": {"type": "polyCube", "inputs": {}},
        "place": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "place.outMesh"}, "tetSize": 0.6}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e6}},
        "block": {"type": "zTissue", "inputs": {
          "mesh": {"from": "place.outMesh"}, "tets": {"from": "tets.outTets"}, "initialVelocity": [0.15, 0.2, 0],
          "materials": [{"from": "flesh.outMaterial"}]}},
        "solver": {"type": "zSolver", "inputs": {
          "bodies": [{"from": "ground.outBody"}, {"from": "block.outBody"}],
          "collisionDetection": true, "maxNewtonIterations": 40, "scale": 2, "gravity": [0, 0, -10]}}
      }})");
    graph["nodes"]["place"]["inputs"]["translate"] = {0, 0, 0.5 + height};
    return graph;
}

/// Two cubes of one scene unit, half a metre, in six tets each; the upper one starts 0.2 above the lower. Free flight.
json two_flying(const TemporaryFolder& folder) {
    std::ofstream(folder / "cube.ele") << "6 4 0\n0 0 1 3 7\n1 0 1 5 7\n2 0 2 3 7\n3 0 2 6 7\n4 0 4 5 7\n5 0 4 6 7\n";
    for (const auto& [name, z] : {std::pair{"lower", 0.0}, std::pair{"upper", 1.2}}) {
        std::ofstream nodes(folder / (std::string(name) + ".node"));
        nodes << "8 3 0 0\n";
        for (int v = 0; v < 8; ++v) nodes << v << ' ' << v % 2 << ' ' << v / 2 % 2 << ' ' << v / 4 + z << '\n';
    }
    json graph = json::parse(R"({
      "format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 5},
      "nodes": {
        "rubber": {"type": "zMaterial", "inputs": {"youngsModulus": 1e7}},
        "solver": {"type": "zSolver", "inputs": {
          "bodies": [], "collisionDetection": true, "scale": 2, "gravity": [0, 0, -10]}}
      }})");
    for (const char* name : {"lower", "upper"}) {
        const std::string tets = std::string(name) + "Tets";
        graph["nodes"][tets] = {{"type", "tetMeshFile"},
                                {"inputs", {{"file", std::string(name) + ".node"}, {"elementFile", "cube.ele"}}}};
        graph["nodes"][name] = {{"type", "zTissue"},
                                {"inputs",
                                 {{"mesh", {{"from", tets + ".outMesh"}}},
                                  {"tets", {{"from", tets + ".outTets"}}},
                                  {"materials", {{{"from", "rubber.outMaterial"}}}}}}};
        graph["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", std::string(name) + ".outBody"}});
    }
    return graph;
}

json rows_of(const Said& said) { return said.lines().at(0).at("rows"); }

} // namespace

TEST_CASE("bench contact: drift of what should stay is its way across in metres, and known scenes alone have it",
          "[tools][contact]") {
    const TemporaryFolder folder;
    write_graph(folder, flying(8), "a_tilt_6k.json");
    write_graph(folder, flying(8), "elsewhere.json");
    std::ofstream(folder / "notes.txt") << "no graph";
    const Said said = run_program({"bench", "contact", folder.path().string(), "--quick", "--json"});
    INFO(said.err);
    REQUIRE(said.code == 0);
    const json rows = rows_of(said);
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].at("scene") == "a_tilt_6k");
    CHECK(rows[0].at("frames") == 4);
    CHECK(rows[0].at("drift_m").get<double>() == Approx(0.25 * 4 / 24).epsilon(1e-9)); // free flight
    CHECK(rows[0].at("centre_m") == rows[0].at("drift_m"));
    CHECK(rows[0].at("peer_s_median") == 0.016);
    CHECK(rows[0].at("peer_newton") == 1.7);
    CHECK(rows[0].at("ratio").is_null()); // nothing to scale by in a quick run
    CHECK(rows[0].at("cantilever_s").is_null());
    CHECK(rows[0].at("contacts") == 0);
    CHECK(rows[0].at("min_J").get<double>() == Approx(1));
    CHECK(rows[1].at("scene") == "elsewhere");
    CHECK(rows[1].at("drift_m").is_null());
    CHECK(rows[1].at("peer_s_median").is_null());
    for (const json& row : rows) {
        CHECK(row.at("tets").get<int>() > 0);
        CHECK(row.at("unknowns").get<int>() > 0);
        CHECK(row.at("s_per_frame_longest").get<double>() >= row.at("s_per_frame_median").get<double>());
        CHECK(row.at("ended") == "");
        CHECK(row.at("fallen").empty());
    }
    const Said table = run_program({"bench", "contact", folder.path().string(), "--steps", "1", "--only", "else"});
    CHECK(table.code == 0);
    CHECK(table.out.find("elsewhere") != std::string::npos);
    CHECK(table.out.find("a_tilt_6k") == std::string::npos);
    CHECK(table.err.find("cantilever") == std::string::npos); // nothing that it would scale
}

TEST_CASE("bench contact: drift of what stands on another is measured where it stands", "[tools][contact]") {
    const TemporaryFolder folder;
    json graph = two_flying(folder);
    graph["nodes"]["lower"]["inputs"]["initialVelocity"] = {0.3, 0.4, 0};
    graph["nodes"]["upper"]["inputs"]["initialVelocity"] = {0.3 + 0.12, 0.4, 0};
    graph["nodes"]["upper"]["inputs"]["initialAngularVelocity"] = {1, 0, 0};
    const Said said =
        run_program({"bench", "contact", write_graph(folder, graph, "b_stack_12k.json"), "--quick", "--json"});
    INFO(said.err);
    REQUIRE(said.code == 0);
    const json row = rows_of(said).at(0);
    const double seconds = 4.0 / 24;
    // Centres: 0.12 m/s apart. Its bottom, a quarter of a metre below the centre, swings to the side beside that; what
    // lies under it hangs together with the lower body, which does not turn.
    CHECK(row.at("centre_m").get<double>() == Approx(0.12 * seconds).epsilon(1e-6));
    CHECK(row.at("drift_m").get<double>() ==
          Approx(std::hypot(0.12 * seconds, 0.25 * std::sin(seconds))).epsilon(0.01));
    CHECK(row.at("contacts") == 0);
}

TEST_CASE("bench contact: what lands is in contact, what comes out below all bones has fallen through",
          "[tools][contact]") {
    const TemporaryFolder folder;
    const std::string lands = write_graph(folder, flying(0.1), "lands.json");
    json open = flying(0.1);
    open["nodes"]["block"]["inputs"]["collisions"] = false;
    const std::string falls = write_graph(folder, open, "falls.json");
    const Said said = run_program({"bench", "contact", lands, falls, "--json"});
    CHECK(said.code == 3);
    const json rows = rows_of(said);
    CHECK(rows[0].at("frames") == 12);
    CHECK(rows[0].at("contacts").get<int>() >= 4);
    CHECK(rows[0].at("max_depth_m").get<double>() > 0);
    CHECK(rows[0].at("newton_per_frame").get<double>() > 0);
    CHECK(rows[0].at("fallen").empty());
    // Half a second from rest: 1.25 m, and the plate ends 0.25 m below where the cube began.
    CHECK(rows[1].at("fallen") == json({"block"}));
    CHECK(rows[1].at("contacts") == 0);
    CHECK(said.lines().at(0).at("summary").get<std::string>().find("falls: fell through: block") != std::string::npos);
    CHECK(run_program({"bench", "contact", lands, "--json"}).code == 0);
}

TEST_CASE("bench contact: an error ends its scene alone, and words that fit nothing are refused", "[tools][contact]") {
    const TemporaryFolder folder;
    json wrong = flying(0.1);
    wrong["nodes"]["tets"]["inputs"]["maxResolution"] = 1;
    write_graph(folder, wrong, "a_wrong.json");
    write_graph(folder, flying(0.1), "b_right.json");
    const Said said = run_program({"bench", "contact", folder.path().string(), "--quick", "--json"});
    CHECK(said.code == 3);
    const json rows = rows_of(said);
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].at("ended").get<std::string>().find("FE2") == 0);
    CHECK(rows[0].at("frames") == 0);
    CHECK(rows[1].at("ended") == "");
    CHECK(rows[1].at("frames") == 4);
    CHECK(run_program({"bench", "contact"}).code == 2);
    CHECK(run_program({"bench", "contact", folder.path().string(), "--only", "no such thing"}).code == 2);
    CHECK(run_program({"bench", "contact", folder.path().string(), "--n", "8"}).code == 2);
}

TEST_CASE("the scenes of graphs/bench have the tets and bodies that they are compared by", "[tools][contact]") {
    const std::string folder = std::string(SINEW_SOURCE_DIR) + "/graphs/bench";
    const Said said = run_program({"bench", "contact", folder, "--steps", "1", "--quick", "--json"});
    INFO(said.err);
    REQUIRE(said.code == 0);
    const std::vector<std::pair<std::string, int>> tets{
        {"a_tilt_24k", 24576},    {"a_tilt_6k", 6000},    {"b_stack_12k", 12000}, {"b_stack_49k", 49152},
        {"c_balls_10", 12550},    {"c_balls_20", 25100},  {"c_cubes_10", 12960},  {"c_cubes_20", 25920},
        {"d_squeeze_24k", 23352}, {"d_squeeze_6k", 6497}, {"e_cloth_100", 0},     {"e_cloth_50", 0},
        {"f_drag_30k", 30000},    {"f_drag_6k", 6480},    {"g_fast_6k", 6000},    {"g_thin_5.1", 384}};
    const json rows = rows_of(said);
    REQUIRE(rows.size() == tets.size());
    for (std::size_t k = 0; k < tets.size(); ++k) {
        CHECK(rows[k].at("scene") == tets[k].first);
        CHECK(rows[k].at("tets") == tets[k].second);
        CHECK(rows[k].at("unconverged") == 0);
        const bool cloth = tets[k].first[0] == 'e';
        CHECK(rows[k].at("crossings").is_null() == !cloth);
        CHECK(rows[k].at("max_stretch_percent").is_null() == !cloth);
        if (cloth) CHECK(rows[k].at("crossings") == 0);
        CHECK(rows[k].at("peer_s_median").is_null() == (tets[k].first[0] == 'g'));
    }
}
