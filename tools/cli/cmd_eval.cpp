// `sinew eval`: the value of one plug at one frame.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/json_text.h"
#include "tools/cli/open_graph.h"
#include "tools/cli/print.h"
#include "tools/cli/problems.h"

#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

namespace {

/// Frames may lie between whole ones; simulations refuse that themselves.
double frame_of(const Arguments& arguments, int otherwise) {
    const auto text = arguments.value("--frame");
    if (!text) return otherwise;
    const auto frame = to_number(*text);
    if (!frame) throw UsageError("--frame needs a number, not '" + *text + "'.");
    return *frame;
}

ExitCode evaluate(const Invocation& in) {
    const Departure departure(in.stop, "sinew eval", in.arguments.has("--json"));
    const bool json = in.arguments.has("--json");
    OpenGraph open = open_graph(in.arguments);
    print_diagnostics(open.notes, json, in.out, in.err);
    const engine::Plug plug = parse_plug(*open.graph, in.arguments.operand(1).value());
    const double frame = frame_of(in.arguments, open.graph->timing().start);
    WarningCollector warnings(open.graph, frame, json, in.err);
    engine::Evaluator evaluator(store_policy(in.arguments, *open.graph),
                                in.arguments.whole_number("--threads", 0, 1, most_threads), &warnings);
    const engine::Value value = evaluator.pull({open.graph, plug, frame, in.stop});
    print_diagnostics(warnings.take(), json, in.out, in.err);

    nlohmann::ordered_json description = describe_value(value);
    if (value.is<nodes::MeshList>()) { // by name, which the value itself does not know
        const auto labels = body_labels(*open.graph, plug, description.size());
        nlohmann::ordered_json named = nlohmann::ordered_json::object();
        for (std::size_t i = 0; i < labels.size(); ++i) named[labels[i].name] = description[i];
        description = std::move(named);
    }
    if (json) {
        const nlohmann::ordered_json line = {{"plug", plug.text()},
                                             {"frame", frame},
                                             {"type", value.type_name()},
                                             {"digest", value ? value.digest().hex() : ""},
                                             {"value", description}};
        in.out << json_text(line) << "\n";
    } else {
        in.out << plug.text() << " (" << value.type_name() << ")" << (description.is_object() ? "\n" : " = ")
               << as_text(description);
    }
    return done;
}

} // namespace

Command eval_command() {
    return {"eval",
            "print the value of a plug",
            {{"GRAPH", "the graph file (JSON)"}, {"NODE.PLUG", "an output, for example biceps.outBody"}},
            {{"--frame", "N", "default: the graph's first frame"},
             {"--set", "NODE.ATTR=JSON", "give an input another value", true},
             {"--threads", "N", "default: all cores", false, 'j'},
             root_flag,
             memory_flag,
             cache_flag,
             no_cache_flag,
             cache_size_flag,
             {"--json", "", "one JSON object instead of text"}},
            "sinew eval graphs/scenes/arm.json solver.outMeshes --frame 24",
            evaluate};
}

} // namespace sinew::cli
