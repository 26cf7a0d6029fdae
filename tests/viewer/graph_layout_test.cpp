// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tests/viewer/runs.h"
#include "tools/viewer/graph_layout.h"
#include "tools/viewer/graph_rows.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

using namespace sinew;
using namespace sinew::viewer;

namespace {

const GraphBox& box(const GraphDrawing& d, const std::string& name) {
    for (const GraphBox& b : d.boxes)
        if (b.name == name) return b;
    throw std::runtime_error(name);
}

std::string row(const GraphBox& b, const std::string& attribute) {
    for (const GraphRow& r : b.rows)
        if (r.attribute == attribute && !r.is_output) return r.text;
    return "no such row";
}

void check_places(const GraphDrawing& d) {
    for (const GraphWire& w : d.wires) {
        INFO(d.boxes[static_cast<std::size_t>(w.from)].name << " -> " << d.boxes[static_cast<std::size_t>(w.to)].name);
        const GraphBox &from = d.boxes[static_cast<std::size_t>(w.from)], &to = d.boxes[static_cast<std::size_t>(w.to)];
        CHECK(from.x + from.width < to.x);
    }
    for (std::size_t i = 0; i < d.boxes.size(); ++i)
        for (std::size_t j = i + 1; j < d.boxes.size(); ++j) {
            const GraphBox &a = d.boxes[i], &b = d.boxes[j];
            INFO(a.name << " and " << b.name);
            const bool apart =
                a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
            CHECK(apart);
        }
}

} // namespace

TEST_CASE("data flows from left to right and boxes do not overlap") {
    check_places(layout_graph(*test::muscle_graph()));
    const auto arm =
        engine::load_graph(nodes::make_registry(), std::string(SINEW_SOURCE_DIR) + "/graphs/scenes/arm.json");
    const GraphDrawing d = layout_graph(*arm.graph);
    check_places(d);
    CHECK(d.width / d.height > 1);
    CHECK(d.width / d.height < 4);
}

TEST_CASE("boxes show values with units, keys by their range, files by name") {
    const GraphDrawing d = layout_graph(*test::muscle_graph());
    CHECK(row(box(d, "flesh"), "youngsModulus") == "20 kPa");
    CHECK(row(box(d, "fibre"), "excitation") == "2 keys, 0 … 1");
    CHECK(row(box(d, "lowerMove"), "translate") == "0 -4.5 0");
    CHECK(row(box(d, "solver"), "bodies") == "[3]");
    CHECK(row(box(d, "off"), "attachmentMode") == "none");
    CHECK(box(d, "solver").family == "solver");
}

TEST_CASE("every node type is coloured by what it gives, one of an unknown type apart") {
    const std::map<std::string, std::vector<std::string>> families{
        {"solver", {"zSolver", "zEmbedder"}},
        {"body", {"zTissue", "zBone", "zCloth", "zSubtissue"}},
        {"matter", {"zMaterial", "zFiber"}},
        {"attachment", {"zAttachment", "zHold", "uniformField", "vortexField"}},
        {"geometry", {"meshFile", "tetMeshFile", "polyCube", "zIsoMesh", "zTet", "meshWriter"}},
        {"paint", {"weights", "endPoints", "combineWeights", "transferWeights"}},
        {"value", {"curve", "trackChannel", "transform", "aim"}},
        {"unknown", {"zSkin"}}};
    const auto registry = nodes::make_registry();
    for (const auto& [family, types] : families)
        for (const std::string& type : types) {
            INFO(type);
            CHECK((registry->find(type) == nullptr) == (family == "unknown"));
            CHECK(family_of(registry->find(type)) == family);
        }
}

TEST_CASE("places of the editor are used where every node has one") {
    const std::string text = R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 1}, "nodes": {
        "ball": {"type": "polySphere"}, "box": {"type": "polyCube"}},
        "editor": {"positions": {"ball": [500, 40], "box": [100, 400]}}})";
    const auto graph = engine::read_graph(nodes::make_registry(), text, "g.json").graph;
    const GraphDrawing d = layout_graph(*graph);
    CHECK(box(d, "ball").x - box(d, "box").x == 400);
    CHECK(box(d, "box").y - box(d, "ball").y == 360);
}

TEST_CASE("unknown types are drawn too, and names are escaped") {
    const std::string text = R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 1}, "nodes": {
        "a<b>&\"c\"": {"type": "zTeleport"}}})";
    const auto graph = engine::read_graph(nodes::make_registry(), text, "g.json").graph;
    const std::string svg = to_svg(layout_graph(*graph));
    CHECK(svg.find("a&lt;b&gt;&amp;&quot;c&quot;") != std::string::npos);
    CHECK(svg.find("f-unknown") != std::string::npos);
    CHECK(svg.find("a<b>") == std::string::npos);
}

TEST_CASE("an SVG names every node and every wire") {
    const GraphDrawing d = layout_graph(*test::muscle_graph());
    const std::string svg = to_svg(d);
    CHECK(svg.starts_with("<svg xmlns="));
    for (const GraphBox& b : d.boxes) CHECK(svg.find("data-node=\"" + b.name + "\"") != std::string::npos);
    CHECK(svg.find("data-from=\"holdTop\" data-to=\"solver\"") != std::string::npos);
    CHECK(d.wires.size() == 27);
}

TEST_CASE("an SVG file has plain colours for what knows no CSS variables") {
    const GraphDrawing d = layout_graph(*test::muscle_graph());
    const std::string file = to_svg(d), page = to_svg(d, SvgFor::page);
    CHECK(file.find("var(") == std::string::npos);
    CHECK(file.find("--") == std::string::npos);
    CHECK(file.find(".box{fill:#ffffff;stroke:#c9d0d8") != std::string::npos);
    CHECK(file.find(".f-solver .band{fill:#e0a300}") != std::string::npos);
    CHECK(page.find(".box{fill:var(--g-box,#ffffff);") != std::string::npos);
    // Nothing but the style differs.
    CHECK(file.substr(file.find("</style>")) == page.substr(page.find("</style>")));
}

TEST_CASE("what feeds a muscle stands beside it, also in a graph of a hundred nodes") {
    const auto graph =
        engine::load_graph(nodes::make_registry(), std::string(SINEW_SOURCE_DIR) + "/graphs/scenes/arm.json").graph;
    const GraphDrawing d = layout_graph(*graph);
    REQUIRE(d.boxes.size() > 100);
    double sum = 0;
    for (const GraphWire& w : d.wires) {
        const GraphBox &from = d.boxes[static_cast<std::size_t>(w.from)], &to = d.boxes[static_cast<std::size_t>(w.to)];
        sum += std::abs(from.y + from.height / 2 - to.y - to.height / 2);
    }
    // A box is about 100 high; at random a wire would climb a third of the drawing.
    CHECK(sum / static_cast<double>(d.wires.size()) < 0.15 * d.height);
}
