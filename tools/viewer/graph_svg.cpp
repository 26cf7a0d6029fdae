// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/graph_layout.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace sinew::viewer {

namespace {

constexpr double head = 38, row_height = 17;

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else if (static_cast<unsigned char>(c) >= 0x20)
            out += c;
    }
    return out;
}

/// Colours by name. The page gives its own; a file has these, written out, because not all that shows SVG knows CSS
/// variables.
struct Colour {
    std::string_view variable, value;
};
constexpr Colour colours[] = {{"--g-box", "#ffffff"},      {"--g-line", "#c9d0d8"},   {"--g-text", "#1d2630"},
                              {"--g-soft", "#6a7683"},     {"--g-wire", "#93a0ad"},   {"--c-solver", "#e0a300"},
                              {"--c-body", "#c8553d"},     {"--c-matter", "#8a63c9"}, {"--c-attachment", "#2c8fb5"},
                              {"--c-geometry", "#5c6f82"}, {"--c-paint", "#3f9166"},  {"--c-value", "#b0713a"},
                              {"--c-unknown", "#999999"}};

std::string colour(std::string_view variable, SvgFor place) {
    for (const Colour& c : colours)
        if (c.variable == variable)
            return place == SvgFor::page ? "var(" + std::string(variable) + "," + std::string(c.value) + ")"
                                         : std::string(c.value);
    throw std::logic_error("no colour " + std::string(variable));
}

std::string style(SvgFor place) {
    const auto of = [&](std::string_view variable) { return colour(variable, place); };
    const auto rule = [](const std::string& selector, const std::string& declarations) {
        return ".sinew-graph " + selector + "{" + declarations + "}\n";
    };
    std::string out = "<style>\n.sinew-graph{font-family:Inter,\"Segoe UI\",\"Helvetica Neue\",Arial,sans-serif}\n";
    out += rule(".box", "fill:" + of("--g-box") + ";stroke:" + of("--g-line") + ";stroke-width:1");
    out += rule(".name", "font-size:12.5px;font-weight:600;fill:" + of("--g-text"));
    out += rule(".type", "font-size:10px;fill:" + of("--g-soft"));
    out += rule(".attr", "font-size:10.5px;fill:" + of("--g-soft"));
    out += rule(".val", "font-size:10.5px;fill:" + of("--g-text") + ";text-anchor:end");
    out += rule(".out", "font-size:10.5px;fill:" + of("--g-soft") + ";text-anchor:end");
    out += rule(".port", "fill:" + of("--g-box") + ";stroke:" + of("--g-wire") + ";stroke-width:1.4");
    out += rule(".wire", "fill:none;stroke:" + of("--g-wire") + ";stroke-width:1.4;opacity:.7");
    for (const char* family : {"solver", "body", "matter", "attachment", "geometry", "paint", "value", "unknown"})
        out += rule(".f-" + std::string(family) + " .band", "fill:" + of("--c-" + std::string(family)));
    return out + "</style>\n";
}

double row_y(const GraphBox& box, std::size_t row) {
    return box.y + head + row_height * (static_cast<double>(row) + 0.5);
}

void draw_wire(std::ostream& out, const GraphDrawing& d, const GraphWire& w) {
    const GraphBox &from = d.boxes[static_cast<std::size_t>(w.from)], &to = d.boxes[static_cast<std::size_t>(w.to)];
    const double x0 = from.x + from.width, y0 = row_y(from, w.from_row), x1 = to.x, y1 = row_y(to, w.to_row);
    const double bend = std::max(30.0, std::min(160.0, 0.5 * (x1 - x0)));
    out << "<path class=\"wire\" data-from=\"" << escaped(from.name) << "\" data-to=\"" << escaped(to.name)
        << "\" d=\"M" << x0 << " " << y0 << "C" << x0 + bend << " " << y0 << " " << x1 - bend << " " << y1 << " " << x1
        << " " << y1 << "\"/>\n";
}

void draw_row(std::ostream& out, const GraphBox& box, std::size_t i) {
    const GraphRow& row = box.rows[i];
    const double y = head + row_height * (static_cast<double>(i) + 0.5);
    const bool is_wire = row.is_output || row.text.empty() || row.text.front() == '[';
    if (is_wire)
        out << "<circle class=\"port\" cx=\"" << (row.is_output ? box.width : 0) << "\" cy=\"" << y << "\" r=\"3.2\"/>";
    if (row.is_output)
        out << "<text class=\"out\" x=\"" << box.width - 10 << "\" y=\"" << y + 3.5 << "\">" << escaped(row.attribute)
            << "</text>";
    else
        out << "<text class=\"attr\" x=\"10\" y=\"" << y + 3.5 << "\">" << escaped(row.attribute) << "</text>";
    if (!row.text.empty())
        out << "<text class=\"val\" x=\"" << box.width - 10 << "\" y=\"" << y + 3.5 << "\">" << escaped(row.text)
            << "</text>";
}

void draw_box(std::ostream& out, const GraphBox& box) {
    out << "<g class=\"node f-" << box.family << "\" data-node=\"" << escaped(box.name) << "\" transform=\"translate("
        << box.x << " " << box.y << ")\">"
        << "<rect class=\"box\" width=\"" << box.width << "\" height=\"" << box.height << "\" rx=\"7\"/>"
        << "<path class=\"band\" d=\"M0 7a7 7 0 0 1 7-7h" << box.width - 14
        << "a7 7 0 0 1 7 7z\" transform=\"scale(1 .6)\"/>"
        << "<text class=\"name\" x=\"10\" y=\"19\">" << escaped(box.name) << "</text>"
        << "<text class=\"type\" x=\"10\" y=\"32\">" << escaped(box.type) << "</text>";
    for (std::size_t i = 0; i < box.rows.size(); ++i) draw_row(out, box, i);
    out << "</g>\n";
}

} // namespace

std::string to_svg(const GraphDrawing& d, SvgFor place) {
    std::ostringstream out;
    out << "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"sinew-graph\" width=\"" << d.width << "\" height=\""
        << d.height << "\" viewBox=\"0 0 " << d.width << " " << d.height << "\">\n"
        << style(place) << "<g class=\"wires\">\n";
    for (const GraphWire& wire : d.wires) draw_wire(out, d, wire);
    out << "</g>\n<g class=\"nodes\">\n";
    for (const GraphBox& box : d.boxes) draw_box(out, box);
    out << "</g>\n</svg>\n";
    return out.str();
}

} // namespace sinew::viewer
