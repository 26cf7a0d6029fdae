// Painted maps: each rule of the weights node on a mesh whose answer is known, and the ends of fibres.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

using namespace bench;
using engine::NumberList;

namespace {

// A line of vertices at x = 0, 1, 2, 3, 4 (each twice, at y = 0 and 1), as a strip of quads.
const std::string strip =
    R"("line": {"type": "polyPlane", "inputs": {"width": 4, "height": 1, "subdivisionsWidth": 4, "subdivisionsHeight": 1}},
    "strip": {"type": "transform", "inputs": {"mesh": {"from": "line.outMesh"}, "translate": [2, 0, 0]}},)";

std::string weights(const std::string& inputs) {
    return strip + R"("w": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, )" + inputs + "}}";
}

/// The weight at each x = 0…4, after checking that both rows agree.
std::vector<double> by_x(const std::string& inputs, const std::string& more = "") {
    Session s(weights(inputs) + more);
    const auto w = s.get<NumberList>("w", "outWeights");
    const auto mesh = s.get<nodes::Mesh>("strip", "outMesh");
    REQUIRE(w.size() == mesh.points->size());
    std::vector<double> out(5, -1);
    for (std::size_t i = 0; i < w.size(); ++i) {
        double& slot = out[static_cast<std::size_t>(std::lround((*mesh.points)[i].x()))];
        CHECK((slot == -1 || slot == Approx(w[i])));
        slot = w[i];
    }
    return out;
}

using Line = std::vector<double>;

} // namespace

TEST_CASE("a constant map is adjusted by invert, scale and offset and kept within 0 and 1", "[nodes]") {
    CHECK(by_x(R"("value": 0.25)") == Line(5, 0.25));
    CHECK(by_x(R"("value": 0.25, "invert": true)") == Line(5, 0.75));
    CHECK(by_x(R"("value": 0.25, "scale": 2, "offset": 0.125)") == Line(5, 0.625));
    // Invert first, then scale, then offset: (1 - 0.25) 0.5 + 0.125.
    CHECK(by_x(R"("value": 0.25, "invert": true, "scale": 0.5, "offset": 0.125)") == Line(5, 0.5));
    CHECK(by_x(R"("value": 7)") == Line(5, 1));
    CHECK(by_x(R"("offset": -3)") == Line(5, 0));
}

TEST_CASE("numbers of a map that are cut off at 0 and 1 are told of", "[nodes]") {
    const auto said = [](const std::string& inputs) {
        Session s(weights(inputs));
        s.get<NumberList>("w", "outWeights");
        std::string out;
        for (const engine::Diagnostic& d : s.counter.warnings) out += d.attribute + ": " + d.message + " | " + d.hint;
        return out;
    };
    const std::string list = R"("mode": "list", "values": [0, 0, 0, 0, 0, 0, 0, 0, )";
    CHECK(said(list + "100, 50]") ==
          "values: 2 of 10 weights are not between 0 and 1 and are cut off there: they go from 0 to 100 | if they are "
          "percent, write \"scale\": 0.01");
    CHECK(said(list + "1, -0.5]") == "values: 1 of 10 weights are not between 0 and 1 and are cut off there: they go "
                                     "from -0.5 to 1 | scale them where they are made");
    CHECK(said(R"("value": 1e50)").starts_with("value: 10 of 10 weights are not between 0 and 1 "));
    CHECK(said(list + "1.0000001, 1]").empty());
    CHECK(said(list + "100, 50], \"scale\": 0.01").empty());
    CHECK(said(list + "3, 2], \"scale\": 2").empty()); // a ramp that is to be steeper
}

TEST_CASE("a ramp rises between two coordinates, straight or smooth, either way", "[nodes]") {
    CHECK(by_x(R"("mode": "ramp", "start": 0, "end": 4)") == Line{0, 0.25, 0.5, 0.75, 1});
    CHECK(by_x(R"("mode": "ramp", "start": 3, "end": 1)") == Line{1, 1, 0.5, 0, 0});
    CHECK(by_x(R"("mode": "ramp", "start": 0, "end": 4, "smooth": true)") == Line{0, 0.15625, 0.5, 0.84375, 1});
    CHECK(codes(weights(R"("mode": "ramp", "start": 2, "end": 2)"), "w", "outWeights") == Codes{"DG110"});
}

TEST_CASE("a sphere is full inside its radius and fades over its falloff", "[nodes]") {
    CHECK(by_x(R"("mode": "sphere", "center": [0, 0, 0], "radius": 1.5)") == Line{1, 1, 0, 0, 0});
    const Line w = by_x(R"("mode": "sphere", "center": [0, 0, 0], "radius": 1.2, "falloff": 10)");
    CHECK(w[0] == 1);
    CHECK(w[1] == 1);
    CHECK((1 > w[2] && w[2] > w[3] && w[3] > w[4] && w[4] > 0));
    // Flat at both ends: 1 - 3 s^2 + 2 s^3 at the share s of the falloff.
    Session s(weights(R"("mode": "sphere", "center": [0, 0, 0], "radius": 1, "falloff": 4)"));
    const auto map = s.get<NumberList>("w", "outWeights");
    const auto points = *s.get<nodes::Mesh>("strip", "outMesh").points;
    for (std::size_t i = 0; i < map.size(); ++i) {
        const double share = std::max(0.0, (points[i].norm() - 1) / 4);
        CHECK(map[i] == Approx(1 - 3 * share * share + 2 * share * share * share).margin(1e-15));
    }
}

TEST_CASE("near falls with the distance to another mesh, and counts its inside as touching", "[nodes]") {
    // A box whose faces lie at x = -0.5 and x = 0.5.
    const std::string box = R"(, "box": {"type": "polyCube", "inputs": {"height": 9, "depth": 9}})";
    const std::string near = R"("mode": "near", "otherMesh": {"from": "box.outMesh"}, )";
    CHECK(by_x(near + R"("innerDistance": 0.5, "outerDistance": 2.5)", box) == Line{1, 1, 0.5, 0, 0});
    CHECK(by_x(near + R"("innerDistance": 0.1, "outerDistance": 0.1)", box) == Line{1, 0, 0, 0, 0});
    CHECK(codes(weights(near + R"("innerDistance": 2, "outerDistance": 1)") + box, "w", "outWeights") ==
          Codes{"DG110"});
    CHECK(codes(weights(R"("mode": "near")"), "w", "outWeights") == Codes{"DG110"});
}

TEST_CASE("lists and vertex numbers must fit the mesh", "[nodes]") {
    Session s(weights(R"("mode": "vertices", "vertices": [0, 9, 3])"));
    CHECK(s.get<NumberList>("w", "outWeights") == NumberList{1, 0, 0, 1, 0, 0, 0, 0, 0, 1});
    s.set("w", "vertices", "[10]");
    CHECK(codes([&] { s.pull("w", "outWeights"); }) == Codes{"FE203"});
    s.set("w", "vertices", "[-1]");
    CHECK(codes([&] { s.pull("w", "outWeights"); }) == Codes{"FE203"});
    s.set("w", "vertices", "[1.5]");
    CHECK(codes([&] { s.pull("w", "outWeights"); }) == Codes{"FE203"});
    s.set("w", "mode", "\"list\"");
    s.set("w", "values", "[0.5]");
    CHECK(s.get<NumberList>("w", "outWeights") == NumberList(10, 0.5));
    s.set("w", "values", "[0.5, 0.5]");
    std::string text;
    CHECK(codes([&] { s.pull("w", "outWeights"); }, &text) == Codes{"FE204"});
    CHECK(text.find("2 numbers for a mesh of 10") != std::string::npos);
    s.set("w", "values", "[]");
    CHECK(codes([&] { s.pull("w", "outWeights"); }) == Codes{"FE204"});
}

TEST_CASE("a map may come from a JSON file, whole or by pointer, as numbers or vertices", "[nodes]") {
    const Folder folder;
    const std::string numbers = folder.write("n.json", "[0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]");
    const std::string sets =
        folder.write("s.json", R"({"attachments": [{"muscle": "a", "vertices": [2, 4]}, {"vertices": [99]}],
                                                        "word": ["x"]})");
    const auto file = [&](const std::string& path, const std::string& key) {
        return weights(R"("mode": "file", "file": ")" + path + R"(", "key": ")" + key + "\"");
    };
    Session a(file(numbers, ""));
    CHECK(a.get<NumberList>("w", "outWeights")[9] == 0.9);
    const NumberList two{0, 0, 1, 0, 1, 0, 0, 0, 0, 0};
    CHECK(Session(file(sets, "/attachments/0/vertices")).get<NumberList>("w", "outWeights") == two);
    CHECK(Session(file(sets, "/attachments/0")).get<NumberList>("w", "outWeights") == two);
    CHECK(codes(file(sets, "/attachments/1"), "w", "outWeights") == Codes{"FE203"});
    CHECK(codes(file(sets, "/attachments/7/vertices"), "w", "outWeights") == Codes{"IO403"});
    CHECK(codes(file(sets, "no pointer"), "w", "outWeights") == Codes{"IO403"});
    CHECK(codes(file(sets, "/word"), "w", "outWeights") == Codes{"IO403"});
    CHECK(codes(weights(R"("mode": "file")"), "w", "outWeights") == Codes{"DG110"});
}

TEST_CASE("end points mark source and sink, which must not meet", "[nodes]") {
    const std::string maps =
        strip +
        R"("from": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "vertices", "vertices": [0]}},
        "to": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "vertices", "vertices": [4, 9]}},)";
    const auto ends = [&](const std::string& from, const std::string& to) {
        return maps + R"("e": {"type": "endPoints", "inputs": {"mesh": {"from": "strip.outMesh"}, "source": )" + from +
               R"(, "sink": )" + to + "}}";
    };
    Session s(ends(R"({"from": "from.outWeights"})", R"({"from": "to.outWeights"})"));
    CHECK(s.get<NumberList>("e", "outEndPoints") == NumberList{0, 0.5, 0.5, 0.5, 1, 0.5, 0.5, 0.5, 0.5, 1});
    CHECK(codes(ends(R"({"from": "to.outWeights"})", R"({"from": "to.outWeights"})"), "e", "outEndPoints") ==
          Codes{"DG110"});
    CHECK(codes(ends(R"([1, 0, 0])", R"({"from": "to.outWeights"})"), "e", "outEndPoints") == Codes{"FE204"});
}

TEST_CASE("a painted map is carried over to an iso mesh, and one that does not fit is refused", "[nodes]") {
    const std::string graph = R"("ball": {"type": "polySphere"}, "iso": {"type": "zIsoMesh", "inputs": {
            "meshes": [{"from": "ball.outMesh"}], "resolution": 64, "triangleSize": 2}},
        "paint": {"type": "weights", "inputs": {"mesh": {"from": "ball.outMesh"}, "mode": "ramp", "axis": "y", "start": -1, "end": 1}},
        "moved": {"type": "transferWeights", "inputs": {"oldMesh": {"from": "ball.outMesh"}, "newMesh": {"from": "iso.outMesh"},
            "weights": {"from": "paint.outWeights"}}})";
    Session s(graph);
    const auto mesh = s.get<nodes::Mesh>("iso", "outMesh");
    const auto linear = s.get<NumberList>("moved", "outWeights");
    REQUIRE(linear.size() == mesh.points->size());
    for (std::size_t v = 0; v < linear.size(); ++v)
        CHECK(linear[v] == Approx(0.5 + 0.5 * (*mesh.points)[v].y()).margin(0.02));
    s.set("moved", "mode", "\"endPoints\"");
    for (const double end : s.get<NumberList>("moved", "outWeights")) CHECK((end == 0 || end == 0.5 || end == 1));
    s.set("moved", "weights", "[0.25]");
    for (const double w : s.get<NumberList>("moved", "outWeights")) CHECK(w == 0.5);
    s.set("moved", "weights", "[1, 0]");
    std::string text;
    CHECK(codes([&] { s.pull("moved", "outWeights"); }, &text) == Codes{"FE204"});
    CHECK(text.find("moved.weights") != std::string::npos);
    s.set("moved", "weights", "[]");
    CHECK(codes([&] { s.pull("moved", "outWeights"); }) == Codes{"FE204"});
}

TEST_CASE("transferred weights stay between 0 and 1", "[nodes]") {
    Session s(R"("ball": {"type": "polySphere"}, "cube": {"type": "polyCube"},
        "moved": {"type": "transferWeights", "inputs": {"oldMesh": {"from": "ball.outMesh"},
            "newMesh": {"from": "cube.outMesh"}, "weights": [7]}})");
    for (const double w : s.get<NumberList>("moved", "outWeights")) CHECK(w == 1);
    s.set("moved", "weights", "[-1]");
    for (const double w : s.get<NumberList>("moved", "outWeights")) CHECK(w == 0);
    s.set("moved", "weights", "[0.25]");
    for (const double w : s.get<NumberList>("moved", "outWeights")) CHECK(w == 0.25);
}

TEST_CASE("maps are combined and inverted and smoothed", "[nodes]") {
    const std::string two = strip + R"(
      "a": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "ramp", "start": 0, "end": 4}},
      "b": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "vertices", "vertices": [1, 2, 3]}},
      "w": {"type": "combineWeights", "inputs": {"weights": [{"from": "a.outWeights"}, {"from": "b.outWeights"}]}})";
    Session s(two);
    // Vertices 0…4 lie at x = 0…4 in the first row; b is 1 at 1, 2 and 3 of it.
    const auto row = [&] {
        const auto all = s.get<NumberList>("w", "outWeights");
        REQUIRE(all.size() == 10);
        return Line(all.begin(), all.begin() + 5);
    };
    CHECK(row() == Line{0, 0.25, 0.5, 0.75, 0});
    s.set("w", "mode", "\"min\"");
    CHECK(row() == Line{0, 0.25, 0.5, 0.75, 0});
    s.set("w", "mode", "\"max\"");
    CHECK(row() == Line{0, 1, 1, 1, 1});
    s.set("w", "invert", "true");
    CHECK(row() == Line{1, 0, 0, 0, 0});
    // One list alone, smoothed once: half of itself and half of the mean of those along the edges.
    Session one(
        strip +
        R"("w0": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "vertices", "vertices": [0]}},
      "w": {"type": "combineWeights", "inputs": {"weights": [{"from": "w0.outWeights"}], "smooth": 1, "mesh": {"from": "strip.outMesh"}}},
      "f0": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "faces", "faces": [1]}},
      "f": {"type": "combineWeights", "inputs": {"weights": [{"from": "f0.outWeights"}], "smooth": 1, "on": "faces", "mesh": {"from": "strip.outMesh"}}})");
    // 0 has neighbours 1 and 5; 1 has 0, 2 and 6; 5 has 0 and 6.
    CHECK(one.get<NumberList>("w", "outWeights") == NumberList{0.5, 0.5 / 3, 0, 0, 0, 0.25, 0, 0, 0, 0});
    CHECK(one.get<NumberList>("f", "outWeights") == NumberList{0.5, 0.5, 0.25, 0});
    one.set("w", "smooth", "1000"); // all the same in the end, somewhere between
    const auto even = one.get<NumberList>("w", "outWeights");
    for (const double w : even) CHECK(w == Approx(even.front()).margin(1e-9));
    CHECK((even.front() > 0 && even.front() < 1));
}

TEST_CASE("maps that do not fit together are refused", "[nodes]") {
    const std::string maps = strip + R"("v": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}}},
      "f": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "faces", "faces": [1]}},)";
    std::string text;
    CHECK(
        codes(
            maps +
                R"("w": {"type": "combineWeights", "inputs": {"weights": [{"from": "v.outWeights"}, {"from": "f.outWeights"}]}})",
            "w", "outWeights", &text) == Codes{"FE204"});
    CHECK(text.find("f gives 4 numbers, the maps before it 10") != std::string::npos);
    CHECK(
        codes(maps +
                  R"("w": {"type": "combineWeights", "inputs": {"weights": [{"from": "v.outWeights"}], "smooth": 1}})",
              "w", "outWeights") == Codes{"DG110"});
    CHECK(
        codes(
            maps +
                R"("w": {"type": "combineWeights", "inputs": {"weights": [{"from": "f.outWeights"}], "smooth": 1, "mesh": {"from": "strip.outMesh"}}})",
            "w", "outWeights") == Codes{"FE204"});
    CHECK(codes(maps + R"("w": {"type": "combineWeights", "inputs": {"weights": []}})", "w", "outWeights") ==
          Codes{"DG021"});
}
