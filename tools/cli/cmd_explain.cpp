// `sinew explain`: would this run, and why? Never computes anything.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/json_text.h"
#include "tools/cli/long_task.h"
#include "tools/cli/open_graph.h"
#include "tools/cli/print.h"

#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

namespace {

std::string_view word_of(engine::Readiness readiness) {
    switch (readiness) {
    case engine::Readiness::ready:
        return "ready";
    case engine::Readiness::would_run:
        return "would run";
    case engine::Readiness::undecided:
        break;
    }
    return "undecided";
}

ExitCode explain(const Invocation& in) {
    const Departure departure(in.stop, "sinew explain", in.arguments.has("--json"));
    const bool json = in.arguments.has("--json");
    OpenGraph open = open_graph(in.arguments);
    print_diagnostics(open.notes, json, in.out, in.err);
    const engine::Timing timing = open.graph->timing();
    constexpr int farthest = 999'999'999; // frames lie within a billion
    const int frame = in.arguments.whole_number("--frame", timing.end, -farthest, farthest);
    const engine::Request request{open.graph, parse_plug(*open.graph, in.arguments.operand(1).value()),
                                  static_cast<double>(frame), in.stop};
    const engine::Evaluator evaluator(store_policy(in.arguments, *open.graph));
    const LongTask task(
        in.err, "looking at frames " + std::to_string(timing.start) + " to " + std::to_string(timing.end), json);
    const engine::Verdict verdict = evaluator.explain(request);
    nlohmann::ordered_json description = {{"plug", request.plug.text()},
                                          {"frame", frame},
                                          {"readiness", word_of(verdict.readiness)},
                                          {"because", verdict.because}};
    if (!verdict.changed_plugs.empty()) description["changed_plugs"] = verdict.changed_plugs;
    if (!verdict.first_plug.empty()) description["first_plug"] = verdict.first_plug;
    if (verdict.readiness == engine::Readiness::would_run &&
        !simulations(*open.graph, upstream_of(*open.graph, {request.plug.node})).empty())
        description["steps"] = {{"first_frame", verdict.first_frame}, {"last_frame", verdict.last_frame}};
    description["valid_frames"] = nlohmann::ordered_json::array();
    for (const auto& [first, last] : evaluator.valid_frames(request, timing.start, timing.end))
        description["valid_frames"].push_back(std::to_string(first) + "-" + std::to_string(last));
    if (json)
        in.out << json_text(description) << "\n";
    else
        in.out << as_text(description);
    return done;
}

} // namespace

Command explain_command() {
    return {"explain",
            "say whether a plug would have to be computed, and why",
            {{"GRAPH", "the graph file (JSON)"}, {"NODE.PLUG", "an output, for example solver.outMeshes"}},
            {{"--frame", "N", "default: the graph's last frame"},
             {"--set", "NODE.ATTR=JSON", "give an input another value", true},
             root_flag,
             cache_flag,
             no_cache_flag,
             cache_size_flag,
             {"--json", "", "one JSON object instead of text"}},
            "sinew explain graphs/scenes/arm.json solver.outMeshes --frame 80",
            explain};
}

} // namespace sinew::cli
