// `sinew diff`: in what two graphs differ by meaning.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/evaluator.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/graph_diff.h"
#include "tools/cli/json_text.h"
#include "tools/cli/open_graph.h"
#include "tools/cli/print.h"

#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

namespace {

/// Long lists and keys are shortened for people; --json has all.
std::string shown(const std::string& json, const std::string& unit) {
    constexpr std::size_t most = 200;
    if (json.empty()) return "nothing";
    std::string out = json.size() > most ? json.substr(0, json.find_last_of(",} ", most)) + " …" : json;
    for (std::size_t at = 0; (at = out.find('\n', at)) != std::string::npos;) {
        const std::size_t end = out.find_first_not_of(' ', at + 1);
        out.replace(at, std::min(end, out.size()) - at, " ");
    }
    const bool is_number =
        !json.starts_with('"') && !json.starts_with("{ \"from\"") && !json.starts_with("[ {") && json != "[]";
    return unit.empty() || unit == "1" || !is_number ? out : out + " " + unit;
}

void print(const Difference& d, std::ostream& out) {
    using Kind = Difference::Kind;
    switch (d.kind) {
    case Kind::timing:
        out << "timing." << d.attribute << ": " << d.before << " → " << d.after << "\n";
        return;
    case Kind::added:
        out << "+ " << d.node << " (" << d.after << ")\n";
        return;
    case Kind::removed:
        out << "- " << d.node << " (" << d.before << ")\n";
        return;
    case Kind::renamed:
        out << d.before << " is called " << d.after << "\n";
        return;
    case Kind::prefix:
        out << "the include " << d.before << " is called " << d.after << "\n";
        return;
    case Kind::type:
        out << d.node << ": type " << d.before << " → " << d.after << "\n";
        return;
    case Kind::input:
        out << d.node << (d.attribute.empty() ? "" : "." + d.attribute) << ": " << shown(d.before, d.unit) << " → "
            << shown(d.after, d.unit) << "\n";
        return;
    }
}

nlohmann::ordered_json as_json(const Difference& d) {
    static constexpr const char* kinds[] = {"timing", "added", "removed", "renamed", "type", "input", "prefix"};
    nlohmann::ordered_json out = {{"event", "difference"}, {"kind", kinds[static_cast<int>(d.kind)]}};
    if (!d.node.empty()) out["node"] = d.node;
    if (!d.attribute.empty()) out["attribute"] = d.attribute;
    const bool is_json = d.kind == Difference::Kind::input || d.kind == Difference::Kind::timing;
    const auto side = [&](const char* name, const std::string& text) {
        if (text.empty())
            out[name] = nullptr;
        else if (is_json)
            out[name] = nlohmann::ordered_json::parse(text, nullptr, false, true);
        else
            out[name] = text;
    };
    side("before", d.before);
    side("after", d.after);
    if (!d.unit.empty()) out["unit"] = d.unit;
    return out;
}

ExitCode compare(const Invocation& in) {
    const bool json = in.arguments.has("--json");
    const Departure departure(in.stop, "sinew diff", json);
    const std::string first = *in.arguments.operand(0), second = *in.arguments.operand(1);
    // 1 is the answer "different", so a graph that is wrong is told apart from it.
    ExitCode code = done;
    const engine::FileAccess files = file_access(in.arguments);
    const auto read = [&](const std::string& file) -> std::shared_ptr<const engine::Graph> {
        try {
            OpenGraph open = open_graph(file, files);
            print_diagnostics(open.notes, json, in.out, in.err);
            return open.graph;
        } catch (const engine::Failure& e) {
            print_diagnostics(e.diagnostics(), json, in.out, in.err);
            code = wrong_usage;
            return nullptr;
        }
    };
    const auto a = read(first), b = read(second);
    if (!a || !b) return code;
    std::vector<Difference> found;
    try {
        found = differences(*a, *b);
    } catch (const engine::Failure& e) { // numbered files, of which one leads out of the root
        print_diagnostics(e.diagnostics(), json, in.out, in.err);
        return wrong_usage;
    }
    for (const Difference& d : found) {
        if (json)
            in.out << json_text(as_json(d)) << "\n";
        else
            print(d, in.out);
    }
    if (json)
        in.out << json_text(nlohmann::ordered_json{
                      {"event", "compared"}, {"same", found.empty()}, {"differences", found.size()}})
               << "\n";
    return found.empty() ? done : graph_wrong;
}

} // namespace

Command diff_command() {
    return {"diff",
            "say in what two graphs differ for those who run them",
            {{"A", "a graph file (JSON)"},
             {"B", "another one. Order, comments, spelling and defaults written out are no difference; included graphs "
                   "are in both. Exit code 0: the same, 1: different, 2: a graph is wrong"}},
            {root_flag, {"--json", "", "one JSON object a line instead of text"}},
            "sinew diff graphs/scenes/arm.json graphs/scenes/arm_refined.json\n"
            "sinew diff old.json new.json && echo the same",
            compare};
}

} // namespace sinew::cli
