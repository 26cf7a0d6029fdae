// `sinew check`: everything that can be found wrong without simulating.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/idle_nodes.h"
#include "tools/cli/json_text.h"
#include "tools/cli/long_task.h"
#include "tools/cli/mesh_report.h"
#include "tools/cli/motion_range.h"
#include "tools/cli/open_graph.h"
#include "tools/cli/print.h"
#include "tools/cli/problems.h"
#include "tools/doubts/doubts.h"
#include "tools/embed/graph_walk.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

namespace {

/// Sub-steps of a solver that are looked at ahead.
constexpr int most_steps_ahead = 250;

struct Counts {
    std::size_t nodes = 0;
    std::int64_t bodies = 0, tets = 0;
};

/// From the solvers' reports at their start; they have been computed before.
Counts count(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator, std::stop_token stop) {
    const std::vector<std::string> all = graph->node_names();
    Counts out;
    out.nodes = all.size();
    for (const std::string& solver : simulations(*graph, all)) {
        const double frame = start_frame(*graph, {solver});
        const engine::Value value = evaluator.pull({graph, {solver, "outReport"}, frame, stop});
        out.bodies += value.as<nodes::SolveReport>().bodies;
        out.tets += value.as<nodes::SolveReport>().tets;
    }
    return out;
}

/// "1 body", "2 bodies".
std::string counted(std::int64_t count, const std::string& one, const std::string& several = {}) {
    return std::to_string(count) + " " + (count == 1 ? one : several.empty() ? one + "s" : several);
}

ExitCode check_file(const Invocation& in, const std::string& file) {
    const bool json = in.arguments.has("--json"), fast = in.arguments.has("--fast"),
               meshes = in.arguments.has("--meshes");
    {
        const LongTask task(in.err, "looking at " + file, json);
        if (const auto report = report_of_file(file, file_access(in.arguments))) {
            print_meshes({*report}, json, in.out);
            return done;
        }
    }
    OpenGraph open = open_graph(in.arguments, file);
    std::vector<engine::Diagnostic> found = std::move(open.notes);
    WarningCollector warnings(open.graph, open.graph->timing().start, json, in.err);
    engine::StorePolicy policy = store_policy(in.arguments, *open.graph);
    policy.keeps_frames = false; // it simulates nothing, and leaves nothing behind
    engine::Evaluator evaluator(policy, in.arguments.whole_number("--threads", 0, 1, most_threads), &warnings);
    const auto failures = engine::remember_failures();
    if (!fast)
        for (auto& problem : find_problems(open.graph, evaluator, open.graph->node_names(), in.stop, failures))
            found.push_back(std::move(problem));
    for (auto& warning : warnings.take()) found.push_back(std::move(warning));
    std::vector<MeshReport> reports;
    if (meshes) {
        const LongTask task(in.err, "looking at the meshes of " + file, json);
        reports = mesh_reports(open.graph, evaluator, in.stop, failures);
        for (auto& warning : features_off(*open.graph, reports)) found.push_back(std::move(warning));
    }
    const engine::Timing& timing = open.graph->timing();
    const int first_frame = start_frame(*open.graph, open.graph->node_names());
    const bool can_start = !fast && !has_error(found);
    // What nodes warn of at later frames is for a run to tell.
    if (can_start) {
        const LongTask task(in.err, "looking at the later frames of " + file, json);
        for (auto& problem :
             find_later_problems(open.graph, evaluator, timing.end, most_steps_ahead, in.stop, failures))
            found.push_back(std::move(problem));
    }
    if (can_start) { // else a tissue falls, say, because what holds it is wrong
        const LongTask task(in.err, "looking for what is hardly meant in " + file, json);
        for (auto& doubt : doubts::find_doubts(open.graph, evaluator, open.graph->node_names(), first_frame,
                                               doubts::Look::closely, in.stop, failures))
            found.push_back(std::move(doubt));
    } else if (!fast)
        for (auto& doubt :
             doubts::find_unit_doubts(open.graph, evaluator, open.graph->node_names(), first_frame, in.stop, failures))
            found.push_back(std::move(doubt));
    if (!has_error(found))
        for (auto& doubt : find_idle_nodes(*open.graph)) found.push_back(std::move(doubt));
    if (!fast) {
        const std::vector<std::string> all = open.graph->node_names();
        const int first = std::min(timing.start, first_frame);
        for (auto& doubt : find_motion_doubts(*open.graph, all, first, timing.end)) found.push_back(std::move(doubt));
    }
    refuse_unknown_types(found);
    sort_by_place(found);
    print_diagnostics(found, json, in.out, in.err);
    if (meshes) print_meshes(reports, json, in.out);
    if (has_error(found)) return graph_wrong;

    const Counts counts = fast ? Counts{open.graph->node_names().size()} : count(open.graph, evaluator, in.stop);
    if (json) {
        nlohmann::ordered_json line = {{"event", "checked"}, {"graph", open.graph->file()}, {"nodes", counts.nodes}};
        if (!fast) line["bodies"] = counts.bodies, line["tets"] = counts.tets;
        line["solvers"] = simulations(*open.graph, open.graph->node_names()).size();
        line["warnings"] = found.size();
        in.out << json_text(line) << "\n";
    } else {
        // All that is left are warnings, and after those nobody believes "right".
        in.out << open.graph->file() << ": "
               << (found.empty() ? "right" : "no errors, " + counted(static_cast<std::int64_t>(found.size()), "doubt"))
               << ", " << counted(static_cast<std::int64_t>(counts.nodes), "node");
        if (!fast) in.out << ", " << counted(counts.bodies, "body", "bodies") << ", " << counted(counts.tets, "tet");
        if (simulations(*open.graph, open.graph->node_names()).empty())
            in.out << "; it has no zSolver, so `sinew run` needs --pull NODE.PLUG";
        else if (embed::last_solvers(*open.graph, open.graph->node_names()).size() > 1)
            in.out << "; it has several solvers, none of which reads the others, so `sinew run` needs --pull NODE.PLUG";
        in.out << "\n";
    }
    return done;
}

ExitCode check(const Invocation& in) {
    const Departure departure(in.stop, "sinew check", in.arguments.has("--json"));
    if (in.arguments.has("--fast") && in.arguments.has("--meshes"))
        throw UsageError("--meshes looks at meshes, which --fast does not load.");
    const std::vector<std::string> files = in.arguments.operands_from(0);
    if (files.size() == 1) return check_file(in, files.front());
    if (in.arguments.has("--set")) throw UsageError("--set changes one graph, but several files are named.");
    ExitCode worst = done;
    for (const std::string& file : files) {
        try {
            worst = std::max(worst, check_file(in, file));
        } catch (const engine::Failure& e) { // the others are looked at too
            print_diagnostics(e.diagnostics(), in.arguments.has("--json"), in.out, in.err);
            worst = std::max(worst, dynamic_cast<const engine::SolveFailure*>(&e) ? solve_failed : graph_wrong);
        }
    }
    return worst;
}

} // namespace

Command check_command() {
    return {"check",
            "say everything that is wrong with a graph or hardly meant, without simulating",
            {{"FILE", "graph files (JSON), and mesh files to look at", true, true}},
            {{"--meshes", "",
              "say of every mesh whether it is closed, manifold and free of crossings, and what is off if not"},
             {"--fast", "", "read the file only; do not load meshes, build tets or place attachments"},
             {"--set", "NODE.ATTR=JSON", "give an input another value", true},
             {"--threads", "N", "default: all cores", false, 'j'},
             root_flag,
             memory_flag,
             cache_flag,
             no_cache_flag,
             cache_size_flag,
             {"--json", "", "one JSON object a line instead of text"}},
            "sinew check graphs/scenes/arm.json\n"
            "sinew check graphs/scenes/arm.json --meshes",
            check};
}

} // namespace sinew::cli
