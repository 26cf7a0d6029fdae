// `sinew docs`: writes the reference pages from the declarations, so that they cannot disagree with the program.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/diagnostics.h"
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tools/cli/arguments.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/commands.h"
#include "tools/cli/node_facts.h"
#include "tools/cli/open_graph.h"

#include <filesystem>
#include <ostream>
#include <sstream>

namespace sinew::cli {

namespace {

/// Text that stands in a cell of a Markdown table.
std::string cell(std::string_view text) {
    std::string out;
    for (const char c : text)
        if (c == '|')
            out += "\\|";
        else
            out += c == '\n' ? ' ' : c;
    return out;
}

std::string nodes_page(const engine::Registry& registry) {
    std::ostringstream out;
    out << "# Node types\n\nMade by `sinew docs`; `sinew nodes TYPE` prints the same. A number may be keyed where it "
           "says "
           "keyable, and any value may be connected to an output of the same type.\n";
    for (const std::string& name : registry.names()) {
        const engine::NodeType& type = *registry.find(name);
        out << "\n## " << type.name << "\n\n" << type.doc << "\n\n| input | takes | meaning |\n|---|---|---|\n";
        for (const auto& a : type.inputs)
            out << "| `" << a.name << "` | " << cell(facts(a)) << " | " << cell(a.doc) << " |\n";
        out << "\n| output | is | meaning |\n|---|---|---|\n";
        for (const auto& a : type.outputs)
            out << "| `" << a.name << "` | " << cell(facts(a)) << " | " << cell(a.doc) << " |\n";
    }
    return out.str();
}

std::string codes_page() {
    std::ostringstream out;
    out << "# Diagnostic codes\n\nMade by `sinew docs`. DG0xx the graph file, DG1xx evaluation, hosts and includes, "
           "FE2xx meshes and "
           "set-up, FE3xx "
           "the solve, IO4xx files. A code keeps its meaning for ever.\n\n| code | what is wrong | what to do "
           "|\n|---|---|---|\n";
    for (const engine::CodeInfo& c : engine::all_codes())
        out << "| " << c.code << " | " << cell(c.title) << " | " << cell(c.remedy) << " |\n";
    return out.str();
}

ExitCode write_docs(const Invocation& in) {
    const std::filesystem::path folder = *in.arguments.operand(0);
    const engine::FileAccess files = file_access(in.arguments);
    for (const char* name : {"nodes.md", "codes.md", "graph.schema.json"}) // all or none
        files.check(folder / name, "the folder");
    const auto registry = nodes::make_registry();
    write_file(folder / "nodes.md", nodes_page(*registry), files);
    write_file(folder / "codes.md", codes_page(), files);
    write_file(folder / "graph.schema.json", engine::graph_schema(*registry) + "\n", files);
    in.out << "wrote nodes.md, codes.md and graph.schema.json in " << folder.string() << "\n";
    return done;
}

} // namespace

Command docs_command() {
    return {"docs",
            "write the reference pages: node types, diagnostic codes, JSON Schema",
            {{"FOLDER", "where to; made if it is not there"}},
            {root_flag},
            "sinew docs docs/reference",
            write_docs};
}

} // namespace sinew::cli
