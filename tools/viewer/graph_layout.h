// A node graph as a drawing: boxes in columns, data flowing from left to right, and its SVG. The page and
// `sinew graph --svg` show the same drawing.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <array>
#include <string>
#include <vector>

namespace sinew::viewer {

/// One line of a box: an input that the file sets, or an output that somebody uses.
struct GraphRow {
    std::string attribute, text; ///< "strength", "18.4 kPa"; wires have no text
    bool is_output = false;
};

struct GraphBox {
    std::string name, type;
    std::string family; ///< "solver", "body", "matter", "attachment", "geometry", "paint", "value", "unknown"
    std::vector<GraphRow> rows;
    double x = 0, y = 0, width = 0, height = 0;
};

struct GraphWire {
    int from = -1, to = -1; ///< boxes
    std::size_t from_row = 0, to_row = 0;
};

struct GraphDrawing {
    std::vector<GraphBox> boxes; ///< in file order
    std::vector<GraphWire> wires;
    double width = 0, height = 0;
};

/// Positions of the graph's editor are used where every node has one; otherwise columns are made so that a
/// node stands just left of what uses it, and rows so that few wires cross.
GraphDrawing layout_graph(const engine::Graph& graph);

/// Whom a drawing is for: a file of its own, or the page, whose CSS variables --g-… and --c-… give the colours.
enum class SvgFor { file, page };

/// One <svg> element. Boxes are <g class="node" data-node="NAME">, wires <path data-from data-to>.
std::string to_svg(const GraphDrawing& drawing, SvgFor place = SvgFor::file);

} // namespace sinew::viewer
