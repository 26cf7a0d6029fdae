// Layers that a closed mesh bounds: what they hand to the solver, what they warn of, and that nothing is made twice.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "solver/term/layered_surfaces.h"

using namespace bench;

namespace {

// A bar of 4 x 1 x 1 with a box in the middle of it, 1.3 long, that reaches beyond its sides.
const std::string bar = R"(
    "bar": {"type": "polyCube", "inputs": {"width": 4, "subdivisionsWidth": 8}},
    "box": {"type": "polyCube", "inputs": {"width": 1.3, "height": 3, "depth": 3}},
    "place": {"type": "transform", "inputs": {"mesh": {"from": "box.outMesh"}, "translate": [0.1, 0, 0]}},
    "tets": {"type": "zTet", "inputs": {"mesh": {"from": "bar.outMesh"}, "tetSize": 0.7}},
    "flesh": {"type": "zMaterial"},
    "core": {"type": "zMaterial", "inputs": {"youngsModulus": 1e6, "mesh": {"from": "place.outMesh"},
             "envelope": {"keys": [[1, 1], [11, 0.5]]}}},
    "t": {"type": "zTissue", "inputs": {"mesh": {"from": "bar.outMesh"}, "tets": {"from": "tets.outTets"},
          "materials": [{"from": "flesh.outMaterial"}, {"from": "core.outMaterial"}]}},
    "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "t.outBody"}]}})";

const solver::TissueRest& rest_of(const nodes::Body& body) {
    return *std::get<std::shared_ptr<const solver::TissueRest>>(body.rest->data);
}

/// Volume of the second layer's part of the solid.
double layer_volume(const solver::TissueRest& t) {
    double sum = 0;
    for (std::size_t e = 0; e < t.tets.tets.size(); ++e) {
        const auto corner = [&](std::size_t c) { return t.tets.vertices[static_cast<std::size_t>(t.tets.tets[e][c])]; };
        sum +=
            t.layer_weights[1][e] * t.tets.coverage[e] * solver::tet_volume(corner(0), corner(1), corner(2), corner(3));
    }
    return sum;
}

Codes warned(const Session& s) {
    Codes out;
    for (const engine::Diagnostic& d : s.counter.warnings) out.push_back(d.code + " " + d.node + "." + d.attribute);
    return out;
}

/// Counts how often a node said what it is doing.
class Listener : public engine::Observer {
  public:
    void progress(const std::string& node, double, std::string_view what) override {
        ++said[node + " " + std::string(what)];
    }
    void computed(const std::string& node, double, double) override { ++computes[node]; }
    std::map<std::string, int> said, computes;
};

} // namespace

TEST_CASE("a layer with a mesh holds the volume that mesh and tissue share", "[nodes]") {
    for (const char* element : {"\"linear\"", "\"quadratic\""}) {
        Session s(bar);
        s.set("tets", "element", element);
        const solver::TissueRest& whole = rest_of(s.get<nodes::Body>("t", "outBody"));
        // Tets that are hardly touched keep a least share of the solid (lattice.h).
        CHECK(layer_volume(whole) == Approx(1.3).epsilon(1e-3));
        CHECK(whole.layer_weights[0] == std::vector<double>(whole.tets.tets.size(), 1.0));
        std::size_t inside = 0, outside = 0;
        for (const double w : whole.layer_weights[1]) inside += w > 1 - 1e-9, outside += w < 1e-9;
        CHECK(inside > 10);
        CHECK(outside > 20);
        CHECK(inside + outside < whole.tets.tets.size());
        // Painted weights multiply it.
        s.set("core", "weights", "[0.25]");
        const solver::TissueRest& quarter = rest_of(s.get<nodes::Body>("t", "outBody"));
        for (std::size_t e = 0; e < whole.tets.tets.size(); ++e)
            CHECK(quarter.layer_weights[1][e] == Approx(0.25 * whole.layer_weights[1][e]).margin(1e-15));
        CHECK(s.counter.warnings.empty());
    }
}

TEST_CASE("a layer's mesh is part of what a tissue is made from", "[nodes]") {
    Session s(bar);
    const auto digest = [&] { return s.get<nodes::Body>("t", "outBody").rest->digest; };
    const engine::Digest before = digest(), material = s.pull("core", "outMaterial").digest();
    s.set("place", "translate", "[0.2, 0, 0]");
    CHECK(s.pull("core", "outMaterial").digest() != material);
    CHECK(digest() != before);
    CHECK(layer_volume(rest_of(s.get<nodes::Body>("t", "outBody"))) == Approx(1.3).epsilon(1e-3));
    s.set("place", "translate", "[1.5, 0, 0]");
    CHECK(layer_volume(rest_of(s.get<nodes::Body>("t", "outBody"))) == Approx(1.15).epsilon(1e-3));
    s.set("place", "translate", "[0.1, 0, 0]");
    CHECK(digest() == before);
    s.set("box", "subdivisionsWidth", "2");
    CHECK(digest() != before);
    CHECK(layer_volume(rest_of(s.get<nodes::Body>("t", "outBody"))) == Approx(1.3).epsilon(1e-3));
}

TEST_CASE("tets are split along a layer's border, and fibres given for each tet go to its parts", "[nodes]") {
    Session s(bar);
    const auto given = s.get<nodes::TetMeshValue>("tets", "outTets").mesh;
    // Along z left of the layer and along y right of it; the border lies at -0.55 and 0.75.
    std::string list;
    for (const solver::Tet& t : given->tets) {
        double x = 0;
        for (const int v : t) x += given->vertices[static_cast<std::size_t>(v)].x() / 4;
        list += (list.empty() ? "" : ", ") + std::string(x < 0.1 ? "0, 0, 1" : "0, 2, 0");
    }
    s.graph = bench::graph(bar + R"(, "fibre": {"type": "zFiber", "inputs": {"excitation": 1, "directions": [)" + list +
                           "]}}");
    s.set("t", "fibers", R"([{"from": "fibre.outFiber"}])");
    const solver::TissueRest& t = rest_of(s.get<nodes::Body>("t", "outBody"));
    CHECK(t.tets.tets.size() > given->tets.size() + 10);
    REQUIRE(t.fibers[0].directions.size() == t.tets.tets.size());
    REQUIRE(t.layer_weights[1].size() == t.tets.tets.size());
    std::size_t left = 0, right = 0;
    for (std::size_t e = 0; e < t.tets.tets.size(); ++e) {
        double x = 0;
        for (const int v : t.tets.tets[e]) x += t.tets.vertices[static_cast<std::size_t>(v)].x() / 4;
        left += x<-0.4, right += x> 0.6;
        if (x < -0.4) CHECK(t.fibers[0].directions[e] == solver::Vec3::UnitZ());
        if (x > 0.6) CHECK(t.fibers[0].directions[e] == solver::Vec3::UnitY());
        if (x < -0.55 || x > 0.75) CHECK((t.layer_weights[1][e] < 1e-9 || t.tets.coverage[e] < 0.05));
    }
    CHECK(left > 100);
    CHECK(right > 100);
    CHECK(s.counter.warnings.empty());
}

TEST_CASE("shares are found once, whatever values are keyed", "[nodes]") {
    Listener listener;
    const auto graph = bench::graph(bar);
    engine::Evaluator evaluator({}, 1, &listener);
    for (const double frame : {1.0, 4.0, 7.0}) evaluator.pull({graph, {"t", "outBody"}, frame});
    CHECK(listener.computes["t"] == 3);
    CHECK(listener.computes["core"] == 3);
    CHECK(listener.said["t meshing"] == 1);
    const int prepared = listener.said["core preparing the surface"];
    CHECK(prepared > 0);
    evaluator.pull({graph, {"t", "outBody"}, 10});
    CHECK(listener.said["core preparing the surface"] == prepared);
}

TEST_CASE("a mesh on the first layer, and one that holds nothing of the tissue, are warned of", "[nodes]") {
    Session first(bar);
    first.set("flesh", "mesh", R"({"from": "place.outMesh"})");
    const auto with = first.get<nodes::Body>("t", "outBody");
    CHECK(warned(first) == Codes{"FE243 t.materials"});
    CHECK(first.counter.warnings.front().message.find("flesh") != std::string::npos);
    CHECK(with.rest->digest == Session(bar).get<nodes::Body>("t", "outBody").rest->digest);

    Session away(bar);
    away.set("place", "translate", "[30, 0, 0]");
    const auto none = away.get<nodes::Body>("t", "outBody");
    CHECK(layer_volume(rest_of(none)) == 0);
    CHECK(warned(away) == Codes{"FE244 t.materials"});
    CHECK(away.counter.warnings.front().message.find("core") != std::string::npos);
}

TEST_CASE("an open mesh cannot bound a layer", "[nodes]") {
    std::string text;
    const std::string open = bar + R"(, "sheet": {"type": "polyPlane"},
        "thin": {"type": "zMaterial", "inputs": {"mesh": {"from": "sheet.outMesh"}}})";
    CHECK(codes(open, "thin", "outMaterial", &text) == Codes{"FE230"});
    CHECK(text.find("thin") != std::string::npos);
    CHECK(text.find("mesh") != std::string::npos);
    CHECK(text.find("open at 40 edges") != std::string::npos);
}

TEST_CASE("a layer's mesh may not change over time", "[nodes]") {
    Session s(bar);
    s.set("place", "translate", R"({"keys": [[1, [0.1, 0, 0]], [9, [0.5, 0, 0]]]})");
    CHECK(codes([&] { s.pull("solver", "outMeshes", 3); }) == Codes{"FE211"});
}

TEST_CASE("pressure and surface tension of a layer with a mesh act at the vertices in it", "[nodes]") {
    Session s(bar);
    s.set("box", "width", "1");
    s.set("place", "translate", "[0, 0, 0]"); // ends on rows of vertices, which count
    s.set("core", "pressure", "300");
    s.set("core", "surfaceTension", "2");
    s.set("core", "weights", "[0.5]");
    const auto body = s.get<nodes::Body>("t", "outBody");
    REQUIRE(body.forces.size() == 2);
    for (const nodes::Force& f : body.forces) {
        const auto& layers = dynamic_cast<const solver::SurfaceLayers&>(*f.rest).layers;
        REQUIRE(layers.size() == 2);
        CHECK(layers[0].weights.empty());
        const solver::Points& points = rest_of(body).surface;
        REQUIRE(layers[1].weights.size() == points.size());
        for (std::size_t v = 0; v < points.size(); ++v)
            CHECK(layers[1].weights[v] == (std::abs(points[v].x()) < 0.6 ? 0.5 : 0));
    }
    // Painted vertex by vertex: each weight where the mesh is.
    const std::size_t count = rest_of(body).surface.size();
    std::string each;
    const auto weight = [](std::size_t v) { return 0.25 + 0.5 * static_cast<double>(v % 2); };
    for (std::size_t v = 0; v < count; ++v) each += (v ? ", " : "[") + std::to_string(weight(v));
    s.set("core", "weights", each + "]");
    const auto painted = s.get<nodes::Body>("t", "outBody");
    for (const nodes::Force& f : painted.forces) {
        const auto& layer = dynamic_cast<const solver::SurfaceLayers&>(*f.rest).layers[1];
        for (std::size_t v = 0; v < count; ++v)
            CHECK(layer.weights[v] == (std::abs(rest_of(painted).surface[v].x()) < 0.6 ? weight(v) : 0));
    }
    s.set("core", "weights", "[0.5]");
    const engine::Digest before = body.forces[0].digest;
    s.set("place", "translate", "[0.5, 0, 0]");
    CHECK(s.get<nodes::Body>("t", "outBody").forces[0].digest != before);
    // Where nothing is painted either, it is the mesh alone.
    s.set("core", "weights", "[]");
    const auto moved = s.get<nodes::Body>("t", "outBody");
    const auto& layer = dynamic_cast<const solver::SurfaceLayers&>(*moved.forces[0].rest).layers[1];
    for (std::size_t v = 0; v < layer.weights.size(); ++v) {
        const double x = rest_of(moved).surface[v].x();
        CHECK(layer.weights[v] == (x > -0.1 && x < 1.1 ? 1 : 0));
    }
}
