// Tissues, fibres and attachments: what they hand to the solver, and every rule across their inputs.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include "nodes/painted_volume.h"
#include "tests/support/side_fibres.h"

#include <algorithm>
#include <cmath>

using namespace bench;

namespace {

// A beam of 4 x 1 x 1 along x with a bone block at its -x end, and maps of both ends.
const std::string beam = R"(
    "beam": {"type": "polyCube", "inputs": {"width": 4, "subdivisionsWidth": 8, "subdivisionsHeight": 2, "subdivisionsDepth": 2}},
    "block": {"type": "polyCube"},
    "place": {"type": "transform", "inputs": {"mesh": {"from": "block.outMesh"}, "translate": [-2.5, 0, 0]}},
    "bone": {"type": "zBone", "inputs": {"mesh": {"from": "place.outMesh"}}},
    "flesh": {"type": "zMaterial"}, "top": {"type": "zMaterial", "inputs": {"youngsModulus": {"preset": "fat"}, "envelope": 0.5}},
    "left": {"type": "weights", "inputs": {"mesh": {"from": "beam.outMesh"}, "mode": "ramp", "start": -1.99, "end": -2}},
    "right": {"type": "weights", "inputs": {"mesh": {"from": "beam.outMesh"}, "mode": "ramp", "start": 1.99, "end": 2}},
    "ends": {"type": "endPoints", "inputs": {"mesh": {"from": "beam.outMesh"}, "source": {"from": "left.outWeights"}, "sink": {"from": "right.outWeights"}}},
    "fiber": {"type": "zFiber", "inputs": {"endPoints": {"from": "ends.outEndPoints"}, "excitation": {"keys": [[1, 0], [11, 1]]}}},
    )";

std::string tissue(const std::string& inputs) {
    return beam + R"("t": {"type": "zTissue", "inputs": {"mesh": {"from": "beam.outMesh"}, )" + inputs + "}}";
}

const std::string layers = R"("materials": [{"from": "flesh.outMaterial"}, {"from": "top.outMaterial"}])";

std::string attached(const std::string& inputs) {
    return tissue(layers) + R"(, "a": {"type": "zAttachment", "inputs": {)" + inputs + "}}";
}

const std::string both = R"("source": {"from": "t.outBody"}, "target": {"from": "bone.outBody"})";

const solver::TissueRest& rest_of(const nodes::Body& body) {
    return *std::get<std::shared_ptr<const solver::TissueRest>>(body.rest->data);
}

/// Counts how often a node said that it is meshing.
class MeshingCounter : public engine::Observer {
  public:
    void progress(const std::string&, double, std::string_view what) override { meshings += what == "meshing"; }
    void computed(const std::string& node, double, double) override { computes += node == "t"; }
    int meshings = 0, computes = 0;
};

} // namespace

TEST_CASE("a tissue carries its layers, the first one everywhere", "[nodes]") {
    Session s(tissue(layers));
    const auto body = s.get<nodes::Body>("t", "outBody");
    const solver::TissueRest& t = rest_of(body);
    REQUIRE(t.layer_weights.size() == 2);
    CHECK(t.layer_weights[0] == std::vector<double>(t.tets.tets.size(), 1.0));
    CHECK(t.layer_weights[1] == std::vector<double>(t.tets.tets.size(), 1.0));
    const auto& values = std::get<solver::TissueInputs>(body.values);
    CHECK(values.layers[0].youngs_modulus == 12e3);
    CHECK(values.layers[1].youngs_modulus == 3e3);
    CHECK(values.layers[1].envelope == 0.5);
    CHECK(values.compression_resistance == 20000);
    CHECK(t.law == solver::ElasticLaw::stvk);
    CHECK(t.embedding.size() == t.surface.size());
}

TEST_CASE("envelope and weights of the first layer change nothing", "[nodes]") {
    Session s(tissue(R"("materials": [{"from": "flesh.outMaterial"}])"));
    const engine::Digest before = s.pull("t", "outBody").digest();
    s.set("flesh", "envelope", "0.5");
    s.set("flesh", "weights", "[0.25]");
    CHECK(s.pull("t", "outBody").digest() == before);
}

TEST_CASE("fibres that begin on a whole side of a muscle run as the exact field does", "[nodes]") {
    const auto error = [](const std::string& inputs) {
        Session s(R"("strip": {"type": "polyCube", "inputs": {"width": 4, "subdivisionsWidth": 32,
                "subdivisionsHeight": 8, "subdivisionsDepth": 8}},
            "below": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "ramp", "axis": "y",
                "start": -0.49, "end": -0.5}},
            "above": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "ramp", "axis": "y",
                "start": -0.5, "end": -0.49}},
            "end": {"type": "weights", "inputs": {"mesh": {"from": "strip.outMesh"}, "mode": "ramp",
                "start": 1.99, "end": 2}},
            "right": {"type": "combineWeights", "inputs": {"weights": [{"from": "above.outWeights"},
                {"from": "end.outWeights"}], "mode": "multiply"}},
            "ends": {"type": "endPoints", "inputs": {"mesh": {"from": "strip.outMesh"},
                "source": {"from": "below.outWeights"}, "sink": {"from": "right.outWeights"}}},
            "fiber": {"type": "zFiber", "inputs": {"endPoints": {"from": "ends.outEndPoints"}}},
            "flesh": {"type": "zMaterial"},
            "tets": {"type": "zTet", "inputs": {"mesh": {"from": "strip.outMesh"}, )" +
                  inputs + R"(}},
            "t": {"type": "zTissue", "inputs": {"mesh": {"from": "strip.outMesh"}, "tets": {"from": "tets.outTets"},
                "materials": [{"from": "flesh.outMaterial"}], "fibers": [{"from": "fiber.outFiber"}]}})");
        const auto body = s.get<nodes::Body>("t", "outBody");
        return test::side_fibre_error(rest_of(body).tets, rest_of(body).fibers.at(0).directions);
    };
    // Fibres found on the tets themselves are 15 to 32 degrees off.
    CHECK(error(R"("tetSize": 1)") < 5);
    CHECK(error(R"("tetSize": 0.7)") < 5);
    CHECK(error(R"("tetSize": 0.7, "element": "quadratic")") < 5);
    CHECK(error(R"("tetSize": 0.6)") < 5);
}

TEST_CASE("paint of another mesh is refused by the node that made it", "[nodes]") {
    const std::string more = R"(, "plane": {"type": "polyPlane", "inputs": {}},
        "stray": {"type": "weights", "inputs": {"mesh": {"from": "plane.outMesh"}}})";
    Session s(tissue(layers) + more);
    s.set("top", "weights", R"({"from": "stray.outWeights"})");
    const std::size_t painted = s.get<engine::NumberList>("stray", "outWeights").size();
    std::string text;
    CHECK(codes([&] { s.pull("t", "outBody"); }, &text) == Codes{"FE204"});
    CHECK(text.find("weights of top, made by stray: " + std::to_string(painted) + " numbers for a mesh of ") !=
          std::string::npos);
    CHECK(text.find("stray may be made for another mesh: let what paints it read this one.") != std::string::npos);
    Session held(attached(both + R"(, "weights": {"from": "stray.outWeights"})") + more);
    CHECK(codes([&] { held.pull("a", "outAttachment"); }, &text) == Codes{"FE204"});
    CHECK(text.find("weights for t, made by stray: ") != std::string::npos);
}

TEST_CASE("a painted layer is extended into the volume within its range", "[nodes]") {
    Session s(tissue(layers));
    s.set("top", "weights", R"({"from": "right.outWeights"})");
    const auto body = s.get<nodes::Body>("t", "outBody");
    const solver::TissueRest& t = rest_of(body);
    double at_left = 0, at_right = 0;
    for (std::size_t e = 0; e < t.tets.tets.size(); ++e) {
        const double w = t.layer_weights[1][e];
        CHECK((w >= 0 && w <= 1));
        double x = 0;
        for (const int v : t.tets.tets[e]) x += t.tets.vertices[static_cast<std::size_t>(v)].x() / 4;
        if (x < 0) at_left = std::max(at_left, w);
        if (x > 1.2) at_right = std::max(at_right, w);
    }
    CHECK(at_left < 0.05);
    CHECK(at_right > 0.3);
}

TEST_CASE("fibres run from source to sink", "[nodes]") {
    Session s(tissue(layers + R"(, "fibers": [{"from": "fiber.outFiber"}])"));
    const auto body = s.get<nodes::Body>("t", "outBody");
    const solver::TissueRest& t = rest_of(body);
    REQUIRE(t.fibers.size() == 1);
    REQUIRE(t.fibers[0].directions.size() == t.tets.tets.size());
    double along = 0;
    for (std::size_t e = 0; e < t.tets.tets.size(); ++e) {
        CHECK(t.fibers[0].directions[e].norm() == Approx(1).margin(1e-12));
        along += t.fibers[0].directions[e].x() / static_cast<double>(t.tets.tets.size());
    }
    CHECK(along > 0.95);
    CHECK(t.fibers[0].weights == std::vector<double>(t.tets.tets.size(), 1.0));
}

TEST_CASE("fibres turn round when their end points are painted the other way in the same session", "[nodes]") {
    Session s(tissue(layers + R"(, "fibers": [{"from": "fiber.outFiber"}])"));
    const auto directions = [&] { return rest_of(s.get<nodes::Body>("t", "outBody")).fibers[0].directions; };
    const solver::Points before = directions();
    s.set("ends", "source", R"({"from": "right.outWeights"})");
    s.set("ends", "sink", R"({"from": "left.outWeights"})");
    const solver::Points after = directions();
    REQUIRE(before.size() == after.size());
    for (std::size_t e = 0; e < before.size(); ++e) CHECK(before[e].dot(after[e]) == Approx(-1).epsilon(1e-9));
}

TEST_CASE("end points count as painted from 0.9 and up to 0.1, those ends included", "[nodes]") {
    CHECK((nodes::is_sink(0.9) && nodes::is_sink(1) && !nodes::is_sink(std::nextafter(0.9, 0))));
    CHECK((nodes::is_source(0.1) && nodes::is_source(0) && !nodes::is_source(std::nextafter(0.1, 1))));
}

TEST_CASE("a layer painted anew in the same session weighs anew", "[nodes]") {
    Session s(tissue(layers));
    s.set("top", "weights", "[0.25]");
    const auto weight = [&] { return rest_of(s.get<nodes::Body>("t", "outBody")).layer_weights[1][0]; };
    CHECK(weight() == 0.25);
    s.set("top", "weights", "[0.75]");
    CHECK(weight() == 0.75);
}

TEST_CASE("keyed values change the body but mesh it only once", "[nodes]") {
    MeshingCounter counter;
    engine::Evaluator evaluator({}, 1, &counter);
    const auto g = graph(tissue(layers + R"(, "fibers": [{"from": "fiber.outFiber"}])"));
    const auto body = [&](double frame) { return evaluator.pull({g, {"t", "outBody"}, frame}).as<nodes::Body>(); };
    const nodes::Body first = body(1), later = body(6);
    CHECK(std::get<solver::TissueInputs>(first.values).fibers[0].excitation == 0);
    CHECK(std::get<solver::TissueInputs>(later.values).fibers[0].excitation == 0.5);
    CHECK(first.rest == later.rest);
    CHECK(counter.computes == 2);
    CHECK(counter.meshings == 1);
    SECTION("and dropping the kept mesh changes no bit") {
        evaluator.drop_scratch();
        evaluator.drop_values();
        const nodes::Body again = body(6);
        CHECK(counter.meshings == 2);
        CHECK(nodes::id_of(again) == nodes::id_of(later));
        CHECK(rest_of(again).fibers[0].weights == rest_of(later).fibers[0].weights);
        CHECK(rest_of(again).embedding.barycentric == rest_of(later).embedding.barycentric);
        CHECK(rest_of(again).fibers[0].directions == rest_of(later).fibers[0].directions);
    }
}

TEST_CASE("a tissue without material, with misfit maps or without fibre ends is refused by name", "[nodes]") {
    std::string text;
    CHECK(codes(tissue(R"("enable": true)"), "t", "outBody", &text) == Codes{"FE206"});
    Session s(tissue(layers + R"(, "fibers": [{"from": "fiber.outFiber"}])"));
    s.set("top", "weights", "[1, 0, 1]");
    CHECK(codes([&] { s.pull("t", "outBody"); }, &text) == Codes{"FE204"});
    CHECK(text.find("weights of top: 3 numbers for a mesh of") != std::string::npos);
    s.set("top", "weights", "[]");
    s.set("fiber", "weights", "[1, 0]");
    CHECK(codes([&] { s.pull("t", "outBody"); }, &text) == Codes{"FE204"});
    CHECK(text.find("weights of fiber") != std::string::npos);
    s.set("fiber", "weights", "[]");
    s.set("fiber", "endPoints", "[0, 1, 0.5]");
    CHECK(codes([&] { s.pull("t", "outBody"); }, &text) == Codes{"FE204"});
    s.set("fiber", "endPoints", "[]");
    CHECK(codes([&] { s.pull("t", "outBody"); }, &text) == Codes{"FE205"});
    CHECK(text.find("fiber have no end points") != std::string::npos);
    CHECK(text.find("t.fibers") != std::string::npos);
    s.set("fiber", "endPoints",
          R"({"from": "left.outWeights"})"); // 0 and 1, but then inverted below: only ones
    CHECK(codes([&] { s.pull("t", "outBody"); }).empty());
    s.set("left", "offset", "0.5");
    CHECK(codes([&] { s.pull("t", "outBody"); }, &text) == Codes{"FE205"});
    CHECK(text.find("no source") != std::string::npos);
}

TEST_CASE("a tissue may bring its own tets", "[nodes]") {
    Session s(tissue(layers + R"(, "tets": {"from": "z.outTets"})") +
              R"(, "z": {"type": "zTet", "inputs": {"mesh": {"from": "beam.outMesh"}, "tetSize": 0.5}})");
    const auto body = s.get<nodes::Body>("t", "outBody");
    CHECK(rest_of(body).tets.tets == s.get<nodes::TetMeshValue>("z", "outTets").mesh->tets);
}

TEST_CASE("vertices outside of a tissue's own tets are counted in a warning", "[nodes]") {
    // Tets of a beam that is half as long as the one that they carry.
    Session s(tissue(layers + R"(, "tets": {"from": "z.outTets"})") +
              R"(, "z": {"type": "zTet", "inputs": {"mesh": {"from": "beam.outMesh"}, "tetSize": 0.5}})");
    s.get<nodes::Body>("t", "outBody");
    CHECK(s.counter.warnings.empty());
    s.graph = bench::graph(
        tissue(layers + R"(, "tets": {"from": "z.outTets"})") +
        R"(, "short": {"type": "transform", "inputs": {"mesh": {"from": "beam.outMesh"}, "scale": [0.5, 1, 1]}},
        "z": {"type": "zTet", "inputs": {"mesh": {"from": "short.outMesh"}, "tetSize": 0.25}})");
    const auto body = s.get<nodes::Body>("t", "outBody");
    REQUIRE(s.counter.warnings.size() == 1);
    const engine::Diagnostic& d = s.counter.warnings[0];
    CHECK(d.code == "FE246");
    CHECK(d.node == "t");
    CHECK(d.attribute == "tets");
    // The count, by the tets' own bounding box.
    const solver::TissueRest& rest = rest_of(body);
    double reach = 0;
    for (const solver::Vec3& v : rest.tets.vertices) reach = std::max(reach, v.x());
    const auto outside =
        std::count_if(rest.surface.begin(), rest.surface.end(), [&](const auto& p) { return std::abs(p.x()) > reach; });
    REQUIRE(outside > 0);
    CHECK(d.message.starts_with(std::to_string(outside) + " of " + std::to_string(rest.surface.size()) + " vertices"));
}

TEST_CASE("an attachment hands on weights for every vertex", "[nodes]") {
    Session s(
        attached(both + R"(, "weights": {"from": "left.outWeights"}, "stiffness": {"value": 1, "unit": "N/cm^3"})"));
    const auto a = s.get<nodes::Attachment>("a", "outAttachment");
    CHECK(a.rest.source_weights == s.get<engine::NumberList>("left", "outWeights"));
    CHECK(a.rest.target_weights == std::vector<double>(8, 1.0));
    CHECK(a.values.mode() == solver::AttachmentMode::fixed);
    CHECK(a.rest.correspondence == solver::Correspondence::closest_point);
    CHECK(a.rest.maintain_offset);
    CHECK(a.values.stiffness == Approx(1e6));
    CHECK(a.source_body == nodes::id_of(s.get<nodes::Body>("t", "outBody")));
    CHECK(s.counter.warnings.empty());
}

TEST_CASE("an attachment hands on its values, and what each end is painted on", "[nodes]") {
    Session s(attached(both + R"(, "stiffness": 2e5, "envelope": 0.25, "damping": 30, "maxDistance": 3,
        "maintainOffset": false, "targetWeightsOn": "faces", "targetWeights": [1])"));
    const auto a = s.get<nodes::Attachment>("a", "outAttachment");
    CHECK((a.values.stiffness == 2e5 && a.values.envelope == 0.25 && a.values.damping == 30));
    CHECK((a.rest.max_distance == 3 && !a.rest.maintain_offset));
    CHECK(a.rest.source_painted == solver::PaintedOn::vertices);
    CHECK(a.rest.target_painted == solver::PaintedOn::faces);
    s.set("a", "targetWeightsOn", "\"vertices\"");
    s.set("a", "weightsOn", "\"faces\"");
    const auto other = s.get<nodes::Attachment>("a", "outAttachment");
    CHECK(other.rest.source_painted == solver::PaintedOn::faces);
    CHECK(other.rest.target_painted == solver::PaintedOn::vertices);
}

TEST_CASE("attachments that cannot hold are refused", "[nodes]") {
    std::string text;
    CHECK(codes(attached(both + R"(, "weights": [1, 1, 0])"), "a", "outAttachment", &text) == Codes{"FE204"});
    CHECK(text.find("weights for t: 3 numbers") != std::string::npos);
    CHECK(codes(attached(both + R"(, "targetWeights": [1, 1, 0])"), "a", "outAttachment", &text) == Codes{"FE204"});
    CHECK(text.find("targetWeights for bone: 3 numbers for a mesh of 8") != std::string::npos);
    CHECK(codes(attached(both + R"(, "weights": [0])"), "a", "outAttachment") == Codes{"FE212"});
    CHECK(codes(attached(both + R"(, "targetWeights": [0])"), "a", "outAttachment") == Codes{"FE212"});
    CHECK(codes(attached(both + R"(, "correspondence": "vertexID")"), "a", "outAttachment") == Codes{"FE217"});
    CHECK(codes(attached(R"("source": {"from": "t.outBody"}, "target": {"from": "t.outBody"})"), "a",
                "outAttachment") == Codes{"FE219"});
    CHECK(codes(attached(both + R"(, "attachmentMode": "none", "weights": [0])"), "a", "outAttachment").empty());
}

TEST_CASE("an attachment between two bones warns and does nothing", "[nodes]") {
    Session s(attached(R"("source": {"from": "bone.outBody"}, "target": {"from": "other.outBody"})") +
              R"(, "other": {"type": "zBone", "inputs": {"mesh": {"from": "beam.outMesh"}}})");
    CHECK(s.get<nodes::Attachment>("a", "outAttachment").values.mode() == solver::AttachmentMode::none);
    REQUIRE(s.counter.warnings.size() == 1);
    CHECK(s.counter.warnings[0].code == "FE207");
    CHECK(s.counter.warnings[0].node == "a");
}

TEST_CASE("a bone follows its matrix and is the same body wherever it is", "[nodes]") {
    Session s(
        R"("cube": {"type": "polyCube"}, "m": {"type": "transform", "inputs": {"translate": {"keys": [[1, [0, 0, 0]], [3, [2, 0, 0]]]}}},
                 "b": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}, "matrix": {"from": "m.outMatrix"}}})");
    const auto one = s.get<nodes::Body>("b", "outBody", 1), two = s.get<nodes::Body>("b", "outBody", 2);
    CHECK(one.rest->digest == two.rest->digest);
    CHECK(nodes::id_of(one) != nodes::id_of(two));
    CHECK((*std::get<nodes::Mesh>(two.values).points)[0] ==
          (*std::get<nodes::Mesh>(one.values).points)[0] + solver::Vec3(1, 0, 0));
}
