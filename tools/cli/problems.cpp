// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/problems.h"

#include "tools/cli/open_graph.h"

#include <algorithm>
#include <climits>
#include <set>
#include <utility>

namespace sinew::cli {

using engine::Diagnostic;

void WarningCollector::warning(const Diagnostic& d) {
    const std::lock_guard lock(mutex_);
    warnings_.push_back(d);
}

std::vector<Diagnostic> WarningCollector::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(warnings_, {});
}

std::vector<Diagnostic> find_problems(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator,
                                      const std::vector<std::string>& nodes, std::stop_token stop,
                                      const std::shared_ptr<engine::Failures>& failures) {
    const double frame = start_frame(*graph, nodes);
    std::vector<Diagnostic> found;
    for (const std::string& name : nodes) {
        const engine::Node* node = graph->find(name);
        // The reader has warned of unknown types; they are errors where something needs them.
        if (!node || !node->type || node->type->outputs.empty()) continue;
        try {
            // One output is enough: a node computes all of them at once.
            evaluator.pull({graph, {name, std::string(node->type->outputs.front().name)}, frame, stop, failures});
        } catch (const engine::Failure& failure) {
            found.insert(found.end(), failure.diagnostics().begin(), failure.diagnostics().end());
        }
    }
    sort_by_place(found);
    return found;
}

void sort_by_place(std::vector<Diagnostic>& diagnostics) {
    std::set<std::string> said;
    std::erase_if(diagnostics, [&](const Diagnostic& d) { return !said.insert(engine::to_json(d)).second; });
    const auto place = [](const Diagnostic& d) {
        const bool known = d.spot && d.spot->line > 0;
        return std::pair(known ? d.spot->line : INT_MAX, known ? d.spot->column : INT_MAX);
    };
    std::stable_sort(diagnostics.begin(), diagnostics.end(),
                     [&](const Diagnostic& a, const Diagnostic& b) { return place(a) < place(b); });
}

bool has_error(const std::vector<Diagnostic>& diagnostics) {
    return std::any_of(diagnostics.begin(), diagnostics.end(),
                       [](const Diagnostic& d) { return d.severity == engine::Severity::error; });
}

} // namespace sinew::cli
