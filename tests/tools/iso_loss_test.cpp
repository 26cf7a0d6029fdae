// zIsoMesh tells what it lost, through the command line.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <array>
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

TEST_CASE("a closed part inside another is a hollow where it faces the other way, and told of where not", "[tools]") {
    const TemporaryFolder folder;
    // Boxes of 2 and 1, the inner one facing out or in.
    const auto box = [](double half, int first, bool faces_in) {
        std::string out;
        for (int i = 0; i < 8; ++i)
            out += "v " + std::to_string(i & 1 ? half : -half) + " " + std::to_string(i & 2 ? half : -half) + " " +
                   std::to_string(i & 4 ? half : -half) + "\n";
        for (const std::array<int, 4>& f :
             {std::array{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}}) {
            out += "f";
            for (std::size_t k = 0; k < 4; ++k) out += " " + std::to_string(first + f[faces_in ? 3 - k : k]);
            out += "\n";
        }
        return out;
    };
    write_text(folder / "solid.obj", box(1, 0, false) + box(0.5, 8, false));
    write_text(folder / "hollow.obj", box(1, 0, false) + box(0.5, 8, true));
    write_text(folder / "inside_out.obj", box(1, 0, true) + box(0.5, 8, true));
    write_text(folder / "apart.obj", box(1, 0, false));
    const auto said =
        [&](const std::string& mesh) {
            const std::string file = write_graph(folder, json::parse(R"({"format": "sinew 1", "nodes": {
          "box": {"type": "meshFile", "inputs": {"file": ")" + mesh + R"("}},
          "skin": {"type": "zIsoMesh", "inputs": {"meshes": [{"from": "box.outMesh"}], "resolution": 64}}}})"));
            return run_program({"check", file, "--no-cache", "--json"});
        };
    for (const char* filled : {"solid.obj", "inside_out.obj"}) {
        const json d = diagnostic(said(filled));
        INFO(filled << d.dump());
        REQUIRE(d.contains("code"));
        CHECK(d.at("code") == "FE274");
        CHECK(d.at("severity") == "warning");
        CHECK(d.at("attribute") == "meshes");
        CHECK(d.at("message") ==
              "a closed part lies inside another that faces the same way and bounds no hollow there: "
              "the inside is filled");
    }
    CHECK(diagnostic(said("hollow.obj")).is_null());
    CHECK(diagnostic(said("apart.obj")).is_null());
}
