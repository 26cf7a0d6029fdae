// Contact on the command line: bodies come to rest on each other, the report says how hard they press, and what is
// switched off falls through.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <sstream>

using namespace sinew::test;
using Catch::Detail::Approx;
using nlohmann::json;

namespace {

/// A cube of one metre, in lattice tets that its surface cuts, above the flat top of a bone at y = 0; a second tissue
/// on it where asked for.
json falling(bool two) {
    json graph = json::parse(R"({
      "format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 40},
      "nodes": {
        "slab": {"type": "polyCube", "inputs": {"width": 6, "height": 1, "depth": 6}},
        "slabPlace": {"type": "transform", "inputs": {"mesh": {"from": "slab.outMesh"}, "translate": [0, -0.5, 0]}},
        "ground": {"type": "zBone", "inputs": {"mesh": {"from": "slabPlace.outMesh"}}},
        "cube": {"type": "polyCube", "inputs": {"subdivisionsWidth": 4, "subdivisionsHeight": 4, "subdivisionsDepth": 4}},
        "place": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0, 0.51, 0]}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "place.outMesh"}, "tetSize": 0.37}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e6, "massDensity": 1000}},
        "block": {"type": "zTissue", "inputs": {
          "mesh": {"from": "place.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "solver": {"type": "zSolver", "inputs": {
          "bodies": [{"from": "ground.outBody"}, {"from": "block.outBody"}],
          "collisionDetection": true, "maxNewtonIterations": 40, "scale": 1, "stiffnessDamping": 0.01}}
      }})");
    if (two) {
        graph["nodes"]["upperPlace"] = json::parse(
            R"({"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0, 1.52, 0], "scale": [0.5, 1, 0.5]}})");
        graph["nodes"]["upper"] = json::parse(
            R"({"type": "zTissue", "inputs": {"mesh": {"from": "upperPlace.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}})");
        graph["nodes"]["solver"]["inputs"]["bodies"].push_back({{"from", "upper.outBody"}});
    }
    return graph;
}

json last_frame(const json& graph, std::vector<std::string> more = {}) {
    const TemporaryFolder folder;
    std::vector<std::string> words{"run", write_graph(folder, graph), "--report", (folder / "report.json").string()};
    words.insert(words.end(), more.begin(), more.end());
    const Said said = run_program(words);
    INFO(said.err);
    REQUIRE(said.code == 0);
    return json::parse(read_text(folder / "report.json")).at("frames").back();
}

} // namespace

TEST_CASE("a frame that converges with bodies deep in each other is warned about, also when nothing is simulated",
          "[tools][contact]") {
    const TemporaryFolder folder;
    const std::string report = (folder / "report.json").string(), cache = (folder / "cache").string();
    json graph = falling(false);
    for (const char* body : {"ground", "block"}) graph["nodes"][body]["inputs"]["contactStiffness"] = 50000;
    graph["nodes"]["solver"]["inputs"]["massDamping"] = 5;
    const std::vector<std::string> words{"run", write_graph(folder, graph), "--report", report, "--cache", cache};
    const Said said = run_program(words);
    REQUIRE(said.code == 0);
    // It rests where 50 kPa a metre carry a metre of water: 0.196 m deep, more than 3/4 of the cube's volume by its
    // area.
    const json frames = json::parse(read_text(report)).at("frames");
    int deep = 0;
    for (const json& f : frames) {
        if (!f.at("where").contains("deep_contact")) continue;
        ++deep;
        const json& where = f.at("where").at("deep_contact");
        CHECK(std::set<std::string>{where.at("body"), where.at("in")} == std::set<std::string>{"block", "ground"});
        CHECK(where.at("depth_m").get<double>() > 0.75 / 6);
    }
    CHECK(frames.back().at("where").at("deep_contact").at("depth_m").get<double>() == Approx(0.196).epsilon(0.1));
    REQUIRE(deep > 0);
    CHECK(deep < 40); // not while it falls
    CHECK(said.err.find("warning [FE307] solver.collisionDetection: the frame ends with ") != std::string::npos);
    CHECK(said.err.find("ends with block and ground 0.1") != std::string::npos);
    CHECK(said.err.find("Raise contactStiffness of block and ground to 1e+07 N/m^3 or more.") != std::string::npos);
    const std::string counted = "  " + std::to_string(deep) + " frames converged with bodies DEEP in each other; ";
    CHECK(said.out.find(counted + "the worst is frame ") != std::string::npos);
    CHECK(said.out.find(", block in ground, ") != std::string::npos);
    const auto times_told = [](const Said& s) {
        std::size_t n = 0;
        for (std::size_t at = s.err.find("[FE307]"); at != std::string::npos; at = s.err.find("[FE307]", at + 1)) ++n;
        return n;
    };
    CHECK(times_told(said) == 1); // the summary counts the rest
    // What makes several outputs of the frame says it once.
    CHECK(times_told(run_program({"snapshot", words[1], "--frames", "40", "--cache", cache, "--size", "32x32", "-o",
                                  (folder / "s.png").string()})) == 1);
    // The same said of what is only looked up.
    const Said again = run_program(words);
    CHECK(again.out.find("40 reused") != std::string::npos);
    CHECK(again.out.find(counted) != std::string::npos);
    CHECK(run_program({"run", words[1], "--json", "--cache", cache}).lines().back().at("deep") == deep);
    // Held where it touched it is as deep; a soft body on a firm one is the one to blame.
    graph["nodes"]["block"]["inputs"]["contactSliding"] = false;
    CHECK(last_frame(graph).at("where").contains("deep_contact"));
    graph["nodes"]["block"]["inputs"].erase("contactSliding");
    graph["nodes"]["ground"]["inputs"]["contactStiffness"] = 1e9;
    graph["nodes"]["block"]["inputs"]["contactStiffness"] = 25000;
    CHECK(run_program({"run", write_graph(folder, graph)}).err.find("Raise contactStiffness of block to 1e+07") !=
          std::string::npos);
    // Not with a tenth of what is advised; but the same depth is nearly half of a thin plate.
    for (const char* body : {"ground", "block"}) graph["nodes"][body]["inputs"]["contactStiffness"] = 1e6;
    CHECK_FALSE(last_frame(graph).at("where").contains("deep_contact"));
    graph["nodes"]["slab"]["inputs"]["height"] = 0.02, graph["nodes"]["slabPlace"]["inputs"]["translate"][1] = -0.01;
    // What counts is the part where they touch: thin panels that stand far away make no thin floor.
    std::string panels, faces;
    const auto add_box = [&](int first) {
        for (const std::array<int, 4>& f :
             {std::array{1, 2, 3, 4}, {8, 7, 6, 5}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 8, 4}, {4, 8, 5, 1}}) {
            faces += "f";
            for (const int v : f) faces += " " + std::to_string(first + v);
            faces += "\n";
        }
    };
    for (int k = 0; k < 19; ++k) {
        for (const double y : {-1.0, 7.0})
            for (const auto& [x, z] : {std::pair(20.0 + k, -3.0), {20.01 + k, -3.0}, {20.01 + k, 3.0}, {20.0 + k, 3.0}})
                panels += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
        add_box(8 * k);
    }
    panels += "v -3 -1 -3\nv 3 -1 -3\nv 3 -1 3\nv -3 -1 3\nv -3 0 -3\nv 3 0 -3\nv 3 0 3\nv -3 0 3\n";
    add_box(8 * 19);
    write_text(folder / "panels.obj", panels + faces);
    json parts = graph;
    parts["nodes"]["slab"] = {{"type", "meshFile"}, {"inputs", {{"file", (folder / "panels.obj").string()}}}};
    parts["nodes"]["slabPlace"]["inputs"]["translate"][1] = 0;
    CHECK_FALSE(last_frame(parts).at("where").contains("deep_contact"));
    const json thin = last_frame(graph);
    CHECK(thin.at("where").at("deep_contact").at("depth_m").get<double>() == Approx(9800 / 1e6).epsilon(0.1));
}

TEST_CASE("frames of another solver with bodies deep in each other are counted with its name", "[tools][contact]") {
    json graph = falling(true);
    for (const char* body : {"ground", "block"}) graph["nodes"][body]["inputs"]["contactStiffness"] = 50000;
    graph["nodes"]["solver"]["inputs"]["bodies"].erase(2);
    graph["nodes"]["shape"] =
        json::parse(R"({"type": "pickMesh", "inputs": {"meshes": {"from": "solver.outMeshes"}, "body": "block"}})");
    graph["nodes"]["carrier"] = json::parse(R"({"type": "zBone", "inputs": {"mesh": {"from": "shape.outMesh"}}})");
    graph["nodes"]["later"] = json::parse(R"({"type": "zSolver", "inputs": {
        "bodies": [{"from": "carrier.outBody"}, {"from": "upper.outBody"}], "scale": 1, "gravity": [0, 0, 0]}})");
    const TemporaryFolder folder;
    const std::string path = write_graph(folder, graph);
    const auto counted = [](const std::string& out) {
        const std::size_t at = out.find(" frames converged with bodies DEEP in each other"),
                          line = out.rfind('\n', at) + 1;
        return at == out.npos ? "" : out.substr(line, out.find('\n', at) - line);
    };
    const std::string alone = counted(run_program({"run", path, "--pull", "solver.outMeshes"}).out),
                      both = counted(run_program({"run", path}).out);
    REQUIRE(alone.find("; the worst is frame ") != std::string::npos);
    CHECK(alone.ends_with(" mm"));
    CHECK(both == alone.substr(0, alone.find(';')) + ", in solver");
    graph["nodes"]["ground"]["inputs"]["contactStiffness"] = graph["nodes"]["block"]["inputs"]["contactStiffness"] =
        1e7;
    CHECK(counted(run_program({"run", write_graph(folder, graph)}).out).empty());
}

TEST_CASE("sheets of which everything is in reach of everything are refused before memory is full",
          "[tools][contact]") {
    json graph = json::parse(R"({
      "format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 2},
      "nodes": {
        "plane": {"type": "polyPlane", "inputs": {"width": 1, "height": 1, "subdivisionsWidth": 60, "subdivisionsHeight": 60}},
        "raised": {"type": "transform", "inputs": {"mesh": {"from": "plane.outMesh"}, "translate": [0, 0.3, 0]}},
        "weave": {"type": "zMaterial"},
        "lower": {"type": "zCloth", "inputs": {
          "mesh": {"from": "plane.outMesh"}, "materials": [{"from": "weave.outMaterial"}], "thickness": 0.5}},
        "upper": {"type": "zCloth", "inputs": {
          "mesh": {"from": "raised.outMesh"}, "materials": [{"from": "weave.outMaterial"}], "thickness": 0.5}},
        "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "lower.outBody"}, {"from": "upper.outBody"}],
          "collisionDetection": true, "scale": 1, "stepHalvings": 0, "maxNewtonIterations": 60}}
      }})");
    const TemporaryFolder folder;
    const Said said = run_program({"run", write_graph(folder, graph)});
    CHECK(said.err.find("[FE308] solver.bodies: more than 10000000 pairs of points and faces") != std::string::npos);
    CHECK(said.code != 0);
}

TEST_CASE("a tissue rests on a bone with its weight, and a second one on it with its own", "[tools][contact]") {
    const json one = last_frame(falling(false));
    CHECK(one.at("converged") == true);
    CHECK(one.at("inverted") == 0);
    CHECK(one.at("terms").at("contact").at("force_N").get<double>() == Approx(9800).epsilon(0.002));
    CHECK(one.at("terms").at("contact").at("max_depth_m").get<double>() == Approx(9800 / 1e6).epsilon(0.1));
    // What presses is the ground's reaction to both and what the upper one presses with.
    const json two = last_frame(falling(true));
    CHECK(two.at("converged") == true);
    CHECK(two.at("terms").at("contact").at("force_N").get<double>() == Approx(9800 + 2 * 0.25 * 9800).epsilon(0.005));
}

TEST_CASE("contact is there where it is switched on alone", "[tools][contact]") {
    const json off = last_frame(falling(false), {"--frames", "1-6", "--set", "solver.collisionDetection=false"});
    CHECK_FALSE(off.at("terms").contains("contact"));
    const json none = last_frame(falling(false), {"--frames", "1-6", "--set", "block.collisions=false"});
    CHECK(none.at("terms").at("contact").at("contacts") == 0);
    const json apart = last_frame(falling(false), {"--frames", "1-6", "--set", "block.collisionSets=\"1\"", "--set",
                                                   "ground.collisionSets=\"2 3\""});
    CHECK(apart.at("terms").at("contact").at("contacts") == 0);
}

TEST_CASE("contacts that maxContactLength drops are told", "[tools][contact]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, falling(false)), report = (folder / "report.json").string(),
                      words = "contacts dropped as deeper than maxContactLength ";
    CHECK(run_program({"run", graph}).out.find(words) == std::string::npos);
    const Said said = run_program({"run", graph, "--set", "solver.maxContactLength=0.002", "--report", report});
    double dropped = 0;
    const json frames = json::parse(read_text(report)).at("frames");
    for (const json& f : frames)
        if (f.at("terms").contains("contact")) dropped += f.at("terms").at("contact").at("dropped").get<double>();
    REQUIRE(dropped > 0);
    CHECK(said.out.find(words + std::to_string(static_cast<int>(dropped))) != std::string::npos);
}

TEST_CASE("edges that cross away from all vertices meet with collisionSubdivision, and without pass through each other",
          "[tools][contact]") {
    const std::string graph = std::string(SINEW_SOURCE_DIR) + "/graphs/learn/28_edge_to_edge.json";
    const auto lowest_after = [&](const char* subdivision, int frames) {
        const TemporaryFolder folder;
        const std::string set = std::string("solver.collisionSubdivision=") + subdivision;
        const Said said =
            run_program({"run", graph, "--set", set, "--frames", "1-" + std::to_string(frames), "--out",
                         (folder / "out").string(), "--format", "obj", "--no-cache", "--quiet", "--strict"});
        INFO(said.err);
        REQUIRE(said.code == 0);
        std::istringstream file(read_text(folder / "out" / "obj" / ("upper.00" + std::to_string(frames) + ".obj")));
        double lowest = 1e9;
        for (std::string line; std::getline(file, line);) {
            double x = 0, y = 0, z = 0;
            std::istringstream words(line);
            if (std::string v; words >> v >> x >> y >> z && v == "v") lowest = std::min(lowest, y);
        }
        return lowest;
    };
    // Edges across edges, at right angles: half of the diagonal of 0.5 squared is the height of those below.
    const double edge = 0.5 / std::sqrt(2.0), begins = 1 - edge;
    const double rests = lowest_after("true", 24);
    CHECK(rests < edge + 0.05);
    CHECK(rests > edge - 0.1);
    double v = 0, falls = begins;
    for (int frame = 2; frame <= 24; ++frame) v += 9.8 / 24, falls -= v / 24;
    CHECK(lowest_after("false", 24) == Approx(falls).epsilon(1e-5));
}

TEST_CASE("a run writes the contacts of each frame, and the report says which bodies are deepest and where",
          "[tools][contact]") {
    json graph = falling(true);
    graph["nodes"]["table"] = json::parse(
        R"({"type": "contactWriter", "inputs": {"contacts": {"from": "solver.outContacts"}, "format": "json"}})");
    const TemporaryFolder folder;
    const std::string out = (folder / "out").string(), report = (folder / "report.json").string();
    const std::string file = write_graph(folder, graph);
    const Said said = run_program({"run", file, "--pull", "table.outFile", "--out", out, "--report", report});
    INFO(said.err);
    REQUIRE(said.code == 0);
    const auto contacts_at = [&](const char* number) {
        return json::parse(read_text(folder / "out" / (std::string("table.") + number + ".json"))).at("contacts");
    };
    CHECK(contacts_at("0001").empty());
    const json frame = json::parse(read_text(report)).at("frames").back(), contacts = contacts_at("0040");
    CHECK(frame.at("terms").at("contact").at("contacts") == contacts.size());
    // In the order of zSolver.bodies: the ground carries both, the block the upper one.
    double on_block = 0, between = 0, deepest = 0;
    json at;
    for (const json& c : contacts) {
        const int source = c.at("source"), target = c.at("target");
        const double up = c.at("force_N")[1];
        if (source == 1 && target == 0)
            on_block += up;
        else if (source == 2 && target == 1)
            between += up;
        else if (source == 1 && target == 2)
            between -= up;
        else
            FAIL("no such pair: " << c.dump());
        CHECK(c.at("sliding") == true);
        if (c.at("depth_m") > deepest) deepest = c.at("depth_m"), at = c;
    }
    CHECK(on_block == Approx(9800 * 1.25).epsilon(0.005));
    CHECK(between == Approx(0.25 * 9800).epsilon(0.01));
    const json where = frame.at("where").at("max_depth_m");
    const std::vector<std::string> names{"ground", "block", "upper"};
    CHECK(where.at("body") == names.at(at.at("source").get<std::size_t>()));
    CHECK(where.at("in") == names.at(at.at("target").get<std::size_t>()));
    CHECK(where.at("depth_m").get<double>() == Approx(frame.at("terms").at("contact").at("max_depth_m").get<double>()));
    CHECK(where.at("at") == at.at("at"));

    // By pairs, for people.
    const Said eval = run_program({"eval", file, "solver.outContacts", "--frame", "40", "--json"});
    REQUIRE(eval.code == 0);
    const json pairs = json::parse(eval.out).at("value");
    CHECK(pairs.at(0).at("source") == 1);
    CHECK(pairs.at(0).at("target") == 0);
    CHECK(pairs.at(0).at("force_N")[1].get<double>() == Approx(9800 * 1.25).epsilon(0.005));
    std::size_t all = 0;
    for (const json& pair : pairs) all += pair.at("contacts").get<std::size_t>();
    CHECK(all == contacts.size());
}

TEST_CASE("a plate catches a cube that comes down by four of its lengths a frame, wherever in the frame it meets it",
          "[tools][contact]") {
    constexpr double side = 0.05, density = 1000, g = 9.81, stiffness = 1e8; // of graphs/bench/g_thin_5.1.json
    const std::string graph = std::string(SINEW_SOURCE_DIR) + "/graphs/bench/g_thin_5.1.json";
    for (const double height : {5.0, 5.05, 5.1, 5.15, 5.2}) {
        const TemporaryFolder folder;
        const double top = 5.1 - height;
        const std::string at = "plate.matrix=[1,0,0,0, 0,1,0,0, 0,0,1," + std::to_string(top) + ", 0,0,0,1]";
        const Said said = run_program({"run", graph, "--set", at, "--out", (folder / "out").string(), "--format", "obj",
                                       "--report", (folder / "report.json").string(), "--no-cache", "--quiet"});
        INFO("from " << height << " m: " << said.err);
        REQUIRE(said.code == 0);
        const json frames = json::parse(read_text(folder / "report.json")).at("frames");
        double lowest = 1e9;
        for (const json& frame : frames) {
            CHECK(frame.at("converged") == true);
            CHECK(frame.at("inverted") == 0);
            const std::string number = std::to_string(10000 + frame.at("frame").get<int>()).substr(1);
            std::istringstream file(read_text(folder / "out" / "obj" / ("cube." + number + ".obj")));
            for (std::string line; std::getline(file, line);) {
                double x = 0, y = 0, z = 0;
                std::istringstream words(line);
                if (std::string v; words >> v >> x >> y >> z && v == "v") lowest = std::min(lowest, z - top);
            }
        }
        // Were it rigid, all that it gains by falling would be in the contact, 1/2 k A d^2; flesh takes up most of it.
        CHECK(lowest < 0);
        CHECK(lowest > -std::sqrt(2 * g * height * density * side / stiffness));
        CHECK(frames.back().at("terms").at("contact").at("force_N").get<double>() ==
              Approx(density * side * side * side * g).epsilon(1e-4));
    }
}

TEST_CASE("what touches stays the same set once all motion has died away", "[tools][contact]") {
    // A ball with friction between two plates: one comes down and aside for half a second, and stops.
    json graph = json::parse(R"({
      "format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 32},
      "nodes": {
        "slab": {"type": "polyCube", "inputs": {"width": 6, "height": 1, "depth": 6}},
        "slabPlace": {"type": "transform", "inputs": {"mesh": {"from": "slab.outMesh"}, "translate": [0, -0.5, 0]}},
        "ground": {"type": "zBone", "inputs": {"mesh": {"from": "slabPlace.outMesh"}}},
        "lidMove": {"type": "transform", "inputs": {
          "translate": {"keys": [[1, [0, 1.5, 0]], [13, [0.1, 1.2, 0]]], "interp": "linear"}}},
        "lid": {"type": "zBone", "inputs": {"mesh": {"from": "slab.outMesh"}, "matrix": {"from": "lidMove.outMatrix"}}},
        "sphere": {"type": "polySphere", "inputs": {"radius": 0.5, "subdivisionsAxis": 16, "subdivisionsHeight": 12}},
        "place": {"type": "transform", "inputs": {"mesh": {"from": "sphere.outMesh"}, "translate": [0, 0.5, 0]}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "place.outMesh"}, "tetSize": 0.2}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e5, "massDensity": 1000}},
        "ball": {"type": "zTissue", "inputs": {
          "mesh": {"from": "place.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "solver": {"type": "zSolver", "inputs": {
          "bodies": [{"from": "ground.outBody"}, {"from": "lid.outBody"}, {"from": "ball.outBody"}],
          "collisionDetection": true, "maxNewtonIterations": 40, "scale": 1, "stiffnessDamping": 0.02}},
        "table": {"type": "contactWriter", "inputs": {"contacts": {"from": "solver.outContacts"}, "format": "json"}}
      }})");
    for (const char* body : {"ground", "lid", "ball"}) {
        graph["nodes"][body]["inputs"]["contactStiffness"] = 1e7;
        graph["nodes"][body]["inputs"]["contactFriction"] = 0.3;
    }
    const TemporaryFolder folder;
    const std::string out = (folder / "out").string();
    const Said said = run_program({"run", write_graph(folder, graph), "--pull", "table.outFile", "--out", out});
    INFO(said.err);
    REQUIRE(said.code == 0);
    using Touching = std::set<std::array<int, 3>>;
    const auto touching_at = [&](int frame) {
        const std::string number = std::to_string(10000 + frame).substr(1);
        Touching set;
        const json table = json::parse(read_text(folder / "out" / ("table." + number + ".json")));
        for (const json& c : table.at("contacts"))
            set.insert({c.at("source").get<int>(), c.at("target").get<int>(), c.at("point").get<int>()});
        return set;
    };
    const Touching at_rest = touching_at(22);
    CHECK(at_rest.size() > 40);
    CHECK(touching_at(13) != at_rest); // while it moves, and just after
    CHECK(touching_at(14) != at_rest);
    for (int frame = 23; frame <= 32; ++frame) {
        INFO("frame " << frame);
        CHECK(touching_at(frame) == at_rest);
    }
}
