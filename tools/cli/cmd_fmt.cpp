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
#include "tools/cli/open_graph.h"
#include "tools/cli/print.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <span>

namespace sinew::cli {

namespace {

/// The prefix of an included graph that the wire at a pointer comes from; empty if it comes from none.
std::string included_source(const std::string& text, const std::string& pointer) {
    using Json = nlohmann::json;
    const Json graph = Json::parse(text, nullptr, false, true);
    const Json::json_pointer at(pointer);
    if (!graph.contains(at)) return "";
    const Json& wire = graph.at(at);
    const Json& from = wire.is_object() && wire.contains("from") ? wire.at("from") : wire;
    if (!from.is_string()) return "";
    const std::string plug = from.get<std::string>(), prefix = plug.substr(0, plug.find('.'));
    const auto includes = graph.find("includes");
    return includes != graph.end() && includes->contains(prefix) ? prefix : "";
}

/// Whether other files are what is wrong: meshes and included graphs that are not there, what included graphs say, or
/// have not. How a text is laid out does not hang on them.
bool is_of_other_files(const engine::Diagnostic& d, const std::string& text) {
    if (!d.spot) return false;
    if (!d.spot->included_by.empty() || d.code.starts_with("IO") || d.code == "DG135") return true;
    const std::string& pointer = d.spot->pointer;
    if (pointer.starts_with("/includes/") && pointer.find("/overrides/") != std::string::npos) return d.code != "DG134";
    const bool is_of_wire = d.code == "DG022" || d.code == "DG023" || d.code == "DG024";
    return is_of_wire && !included_source(text, pointer).empty();
}

/// Inputs that are missing are right in a file that others include.
bool concerns_layout(const engine::Diagnostic& d, const std::string& text) {
    if (d.severity != engine::Severity::error || is_of_other_files(d, text)) return false;
    return d.code != "DG019" && d.code != "DG021" && d.code != "FE290";
}

/// What is wrong with the text itself. Types that the program does not know are errors only beside others.
std::vector<engine::Diagnostic> wrong_in_text(std::span<const engine::Diagnostic> all, const std::string& text) {
    std::vector<engine::Diagnostic> wrong;
    for (const engine::Diagnostic& d : all)
        if (concerns_layout(d, text)) wrong.push_back(d);
    const bool is_readable =
        std::all_of(wrong.begin(), wrong.end(), [](const engine::Diagnostic& d) { return d.code == "DG010"; });
    return is_readable ? std::vector<engine::Diagnostic>() : wrong;
}

/// Throws Failure with what is wrong with the file.
std::string right_text(const std::shared_ptr<const engine::Registry>& registry, const std::string& file,
                       const engine::FileAccess& files) {
    engine::GraphText read = engine::graph_text(file, files);
    if (!read.code.empty()) {
        engine::Diagnostic d;
        d.code = read.code;
        d.spot = engine::SourceSpot{file, "", 0, 0};
        d.message = std::move(read.message);
        d.hint = std::move(read.hint);
        throw engine::Failure(std::move(d));
    }
    try {
        engine::read_graph(registry, read.text, file, files);
    } catch (const engine::Failure& e) {
        std::vector<engine::Diagnostic> wrong = wrong_in_text(e.diagnostics(), read.text);
        if (!wrong.empty()) throw engine::Failure(std::move(wrong));
    }
    return std::move(read.text);
}

ExitCode format(const Invocation& in) {
    const bool only_checks = in.arguments.has("--check"), json = in.arguments.has("--json");
    const Departure departure(in.stop, "sinew fmt", json);
    const auto registry = nodes::make_registry();
    const engine::FileAccess files = file_access(in.arguments);
    // Of --check 1 is the answer "laid out otherwise", so a file that cannot be read is told apart from it.
    const ExitCode unreadable = only_checks ? wrong_usage : graph_wrong;
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
            const std::string old = right_text(registry, file, files), laid_out = engine::laid_out(old);
            if (laid_out == old) continue;
            if (only_checks) {
                tell("would change", "would change ", file);
                worst = std::max(worst, graph_wrong);
            } else {
                const auto rights = std::filesystem::status(file).permissions();
                write_file(file, laid_out, files);
                std::error_code ignored; // on a disk without them there is nothing to keep
                std::filesystem::permissions(file, rights, ignored);
                tell("changed", "changed ", file);
            }
        } catch (const engine::Failure& e) { // the others are written all the same
            print_diagnostics(e.diagnostics(), json, in.out, in.err);
            worst = std::max(worst, unreadable);
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
              "spelled stay; a file with errors is left as it is. Meshes and included graphs need not be there",
              true, true}},
            {{"--check", "",
              "write nothing; name the files that would change. Exit code 0: none would, 1: some would, 2: a file "
              "cannot be "
              "read as a graph"},
             root_flag,
             {"--json", "", "one JSON object a line instead of text"}},
            "sinew fmt my_graph.json\n"
            "sinew fmt --check graphs/*/*.json     # exit code 1 if one is laid out otherwise",
            format};
}

} // namespace sinew::cli
