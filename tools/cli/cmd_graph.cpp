// `sinew graph`: the graph itself, as a drawing or as a normalised file.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "tools/cli/arguments.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/json_text.h"
#include "tools/cli/open_graph.h"
#include "tools/cli/print.h"
#include "tools/cli/read_files.h"
#include "tools/cli/writable_folder.h"
#include "tools/viewer/graph_layout.h"

#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

namespace {

std::string quoted(const std::string& text) { return json_text(nlohmann::json(text)); }

std::string_view fill_of(const std::string& type) {
    if (type == "zSolver") return "#ffe9b8";
    if (type == "zBone") return "#f5efdc";
    if (type == "zTissue" || type == "zSubtissue") return "#f3c1b8";
    return type.starts_with("z") ? "#f8e3de" : "#e4ebf2";
}

void print_edge(const engine::Plug& from, const std::string& to, std::string_view attribute, std::ostream& out) {
    out << "  " << quoted(from.node) << " -> " << quoted(to)
        << " [label=" << quoted(from.attribute + " → " + std::string(attribute)) << "];\n";
}

void print_dot(const engine::Graph& graph, std::ostream& out) {
    out << "digraph sinew {\n  rankdir=LR;\n  node [shape=box, style=\"rounded,filled\", "
           "fontname=\"sans-serif\"];\n"
           "  edge [fontname=\"sans-serif\", fontsize=9, color=\"#707070\"];\n";
    for (const std::string& name : graph.node_names()) {
        const engine::Node& node = *graph.find(name);
        out << "  " << quoted(name) << " [label=" << quoted(name + "\n" + node.type_name) << ", fillcolor=\""
            << (node.type ? fill_of(node.type_name) : "#dddddd") << "\"];\n";
    }
    for (const std::string& name : graph.node_names())
        for (const auto& [attribute, binding] : graph.find(name)->inputs) {
            if (const auto* plug = std::get_if<engine::Plug>(&binding)) print_edge(*plug, name, attribute, out);
            if (const auto* list = std::get_if<std::vector<engine::Plug>>(&binding))
                for (const engine::Plug& plug : *list) print_edge(plug, name, attribute, out);
        }
    out << "}\n";
}

ExitCode show_graph(const Invocation& in) {
    const Departure departure(in.stop, "sinew graph", false); // --json is the graph, not events
    const auto svg = in.arguments.value("--svg");
    if (in.arguments.has("--dot") + in.arguments.has("--json") + svg.has_value() != 1)
        throw UsageError("choose one of --dot, --svg and --json.");
    const OpenGraph open = open_graph(in.arguments);
    if (svg) {
        open.graph->files().check(*svg, "--svg");
        check_writable_file(*svg, "--svg");
        ReadFiles read;
        read.add(*open.graph);
        read.check_kept(*svg, "--svg");
    }
    print_diagnostics(open.notes, false, in.out, in.err);
    if (svg) {
        write_file(*svg, viewer::to_svg(viewer::layout_graph(*open.graph)), open.graph->files());
        in.out << "wrote " << *svg << "\n";
    } else if (in.arguments.has("--dot")) {
        print_dot(*open.graph, in.out);
    } else {
        in.out << engine::write_graph(*open.graph);
    }
    return done;
}

} // namespace

Command graph_command() {
    return {
        "graph",
        "print a graph as a drawing (Graphviz) or as a normalised file",
        {{"GRAPH", "the graph file (JSON)"}},
        {{"--dot", "", "Graphviz source"},
         {"--svg", "FILE", "write the drawing that the viewer shows: types, values, connections"},
         {"--json", "", "the graph file as this program writes it: only what is not default, paths from its folder"},
         {"--set", "NODE.ATTR=JSON", "give an input another value", true},
         root_flag},
        "sinew graph graphs/scenes/arm.json --svg arm.svg\n"
        "sinew graph graphs/scenes/arm.json --dot | dot -Tpng > arm.png",
        show_graph};
}

} // namespace sinew::cli
