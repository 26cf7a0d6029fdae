// zIsoMesh tells what it lost, through the command line.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>
#include <fstream>

using namespace sinew::test;
using nlohmann::json;

namespace {

/// A ball on a rod of 3, both 4 cm to 1 m thick, wrapped at 0.
std::string graph(const TemporaryFolder& folder) {
    return write_graph(folder, json::parse(R"({"format": "sinew 1", "nodes": {
      "ball": {"type": "polySphere", "inputs": {"radius": 0.5}},
      "rod": {"type": "polyCylinder", "inputs": {"radius": 0.02, "height": 3}},
      "skin": {"type": "zIsoMesh", "inputs": {"meshes": [{"from": "ball.outMesh"}, {"from": "rod.outMesh"}],
        "resolution": 32, "triangleSize": 2}}}})"));
}

json diagnostic(const Said& said) {
    for (const json& line : said.lines())
        if (line.at("event") == "diagnostic") return line;
    return {};
}

} // namespace

TEST_CASE("what a remeshed surface has lost is warned about with its place and the cure", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = graph(folder);
    const Said said = run_program({"check", file, "--json", "--no-cache"});
    CHECK(said.code == 0);
    const json d = diagnostic(said);
    REQUIRE(d.contains("code"));
    CHECK(d.at("code") == "FE253");
    CHECK(d.at("severity") == "warning");
    CHECK(d.at("node") == "skin");
    // The rod's ends lie 1.5 from the middle; the ball, which is kept, ends at 0.5.
    const auto message = d.at("message").get<std::string>();
    const std::string off = "is off by up to ";
    REQUIRE(message.find(off) != std::string::npos);
    CHECK(std::stod(message.substr(message.find(off) + off.size())) == Approx(1.0).margin(0.02));
    // Triangles so large cut more than a twentieth off the ball, too.
    CHECK(message.starts_with("the new surface encloses 9"));
    CHECK(d.at("hint") == "Choose a higher resolution and a smaller triangleSize.");
    const Said fine = run_program(
        {"check", file, "--json", "--no-cache", "--set", "skin.resolution=256", "--set", "skin.triangleSize=0.4"});
    CHECK(diagnostic(fine).is_null());
}

TEST_CASE("lost volume is warned about and can be asked for", "[tools]") {
    const TemporaryFolder folder;
    const std::string spring = std::string(SINEW_SOURCE_DIR) + "/graphs/learn/07_delaunay_spring.json";
    const Said coarse =
        run_program({"eval", spring, "skin.outVolumeRatio", "--set", "skin.resolution=16", "--no-cache"});
    CHECK(coarse.code == 0);
    CHECK(coarse.err.find("warning [FE253]") != std::string::npos);
    CHECK(coarse.err.find("of the polygons' volume") != std::string::npos);
    const auto ratio = [](const Said& said) { return std::stod(said.out.substr(said.out.find('=') + 1)); };
    CHECK((ratio(coarse) > 0.4 && ratio(coarse) < 0.7));
    // Above a twentieth it is said, too.
    const Said fair = run_program({"eval", spring, "skin.outVolumeRatio", "--set", "skin.resolution=48", "--no-cache"});
    CHECK((ratio(fair) > 0.9 && ratio(fair) < 0.95));
    CHECK(fair.err.find("warning [FE253]") != std::string::npos);
    const Said fine =
        run_program({"eval", spring, "skin.outVolumeRatio", "--set", "skin.triangleSize=0.5", "--no-cache"});
    CHECK((ratio(fine) > 0.98 && ratio(fine) < 1.01));
    CHECK(fine.err.find("FE253") == std::string::npos);
    const Said place = run_program({"eval", spring, "skin.outDistance", "--no-cache"});
    CHECK((ratio(place) > 0 && ratio(place) < 0.05));
}

TEST_CASE("a pancake keeps its volume, or is refused where triangles cannot follow it", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = write_graph(folder, json::parse(R"({"format": "sinew 1", "nodes": {
      "pancake": {"type": "polyCylinder", "inputs": {"radius": 50, "height": 1, "subdivisionsAxis": 60}},
      "skin": {"type": "zIsoMesh", "inputs": {"meshes": [{"from": "pancake.outMesh"}], "resolution": 64}}}})"));
    const Said kept = run_program({"eval", file, "skin.outVolumeRatio", "--set", "pancake.height=5", "--no-cache"});
    CHECK(std::stod(kept.out.substr(kept.out.find('=') + 1)) == Approx(1).margin(0.02));
    CHECK(kept.err.find("FE253") == std::string::npos);
    const Said thin = run_program({"eval", file, "skin.outVolumeRatio", "--set", "pancake.height=0.1", "--no-cache"});
    CHECK(thin.code == 1);
    CHECK(thin.err.find("error [FE231]") != std::string::npos);
    CHECK(thin.err.find("a sheet too thin for the triangles") != std::string::npos);
}
