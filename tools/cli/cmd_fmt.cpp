// `sinew fmt`: graph files in the layout that Sinew writes; nothing of what they say changes.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "engine/format/graph_text.h"
#include "engine/format/layout.h"
#include "nodes/register_all.h"
#include "tools/cli/arguments.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/json_text.h"
#include "tools/cli/long_task.h"
#include "tools/cli/print.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

namespace {

/// Inputs that are missing are right in a file that others include, and so is what is wrong in files that it includes.
bool concerns_layout(const engine::Diagnostic& d) {
    if (d.severity != engine::Severity::error || (d.spot && !d.spot->included_by.empty())) return false;
    return d.code != "DG019" && d.code != "DG021" && d.code != "FE290";
}

/// Throws Failure with what is wrong with the file.
std::string right_text(const std::shared_ptr<const engine::Registry>& registry, const std::string& file) {
    engine::GraphText read = engine::graph_text(file);
    if (!read.code.empty()) {
        engine::Diagnostic d;
        d.code = read.code;
        d.spot = engine::SourceSpot{file, "", 0, 0};
        d.message = std::move(read.message);
        throw engine::Failure(std::move(d));
    }
    try {
        engine::read_graph(registry, read.text, file);
    } catch (const engine::Failure& e) {
        std::vector<engine::Diagnostic> wrong;
        std::copy_if(e.diagnostics().begin(), e.diagnostics().end(), std::back_inserter(wrong), concerns_layout);
        if (!wrong.empty()) throw engine::Failure(std::move(wrong));
    }
    return std::move(read.text);
}

ExitCode format(const Invocation& in) {
    const bool only_checks = in.arguments.has("--check"), json = in.arguments.has("--json");
    const Departure departure(in.stop, "sinew fmt", json);
    const auto registry = nodes::make_registry();
    ExitCode worst = done;
    const auto tell = [&](const char* event, const char* words, const std::string& file) {
        if (json)
            in.out << json_text(nlohmann::ordered_json{{"event", event}, {"graph", file}}) << "\n";
        else
            in.out << words << file << "\n";
    };
    for (const std::string& file : in.arguments.operands_from(0)) {
        if (in.stop.stop_requested()) throw engine::Cancelled();
        const LongTask task(in.err, "reading " + file, json);
        try {
            const std::string old = right_text(registry, file), laid_out = engine::laid_out(old);
            if (laid_out == old) continue;
            if (only_checks) {
                tell("would change", "would change ", file);
                worst = std::max(worst, graph_wrong);
            } else {
                const auto rights = std::filesystem::status(file).permissions();
                write_file(file, laid_out);
                std::error_code ignored; // on a disk without them there is nothing to keep
                std::filesystem::permissions(file, rights, ignored);
                tell("changed", "changed ", file);
            }
        } catch (const engine::Failure& e) { // the others are written all the same
            print_diagnostics(e.diagnostics(), json, in.out, in.err);
            worst = std::max(worst, graph_wrong);
        }
    }
    return worst;
}

} // namespace

Command fmt_command() {
    return {"fmt",
            "lay graph files out in one way: indentation, line breaks, blanks",
            {{"FILE",
              "graph files (JSON). Comments, the order of keys, single blank lines, and how numbers are "
              "spelled stay; a file with errors is left as it is",
              true, true}},
            {{"--check", "", "write nothing; name the files that would change, and end with 1 if there are some"},
             {"--json", "", "one JSON object a line instead of text"}},
            "sinew fmt my_graph.json\n"
            "sinew fmt --check graphs/*/*.json     # exit code 1 if one is laid out otherwise",
            format};
}

} // namespace sinew::cli
