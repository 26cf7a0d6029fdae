// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/problems.h"

#include "tools/cli/open_graph.h"
#include "tools/embed/graph_walk.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <set>
#include <tuple>
#include <utility>

namespace sinew::cli {

using engine::Diagnostic;

WarningCollector::WarningCollector(std::shared_ptr<const engine::Graph> graph, double frame, bool is_quiet,
                                   std::ostream& err)
    : progress_(is_quiet ? ProgressStyle::quiet : ProgressStyle::lines, std::move(graph), 1, err, err) {
    progress_.begin_frame(static_cast<int>(frame));
}

void WarningCollector::warning(const Diagnostic& d) {
    const std::lock_guard lock(mutex_);
    // Outputs that are made one after the other say the same.
    if (texts_.insert(engine::to_json(d)).second) warnings_.push_back(d);
}

std::vector<Diagnostic> WarningCollector::take() {
    const std::lock_guard lock(mutex_);
    texts_.clear();
    return std::exchange(warnings_, {});
}

namespace {

/// Calls `take` with the name of each node that a node reads.
template <class Take>
void for_sources(const engine::Node& node, Take take) {
    for (const auto& [attribute, binding] : node.inputs) {
        const engine::AttributeInfo* info = node.type ? node.type->find_input(attribute) : nullptr;
        if (!info || info->affects == engine::Affects::nothing) continue;
        if (const auto* plug = std::get_if<engine::Plug>(&binding)) take(plug->node);
        if (const auto* list = std::get_if<std::vector<engine::Plug>>(&binding))
            for (const engine::Plug& plug : *list) take(plug.node);
    }
}

/// Nodes that nothing among `nodes` reads, then the others; both in the given order.
std::vector<std::string> ends_first(const engine::Graph& graph, const std::vector<std::string>& nodes) {
    std::set<std::string> read;
    for (const std::string& name : nodes)
        if (const engine::Node* node = graph.find(name))
            for_sources(*node, [&](const std::string& source) { read.insert(source); });
    std::vector<std::string> out = nodes;
    std::stable_partition(out.begin(), out.end(), [&](const std::string& name) { return !read.contains(name); });
    return out;
}

/// Adds a node that was evaluated at `frame` and all that was evaluated there for it.
void add_upstream(const engine::Graph& graph, const std::string& name, double frame, std::set<std::string>& sound) {
    std::vector<std::string> open{name};
    while (!open.empty()) {
        const std::string at = open.back();
        open.pop_back();
        if (!sound.insert(at).second) continue;
        const engine::Node* node = graph.find(at);
        if (!node) continue;
        // A simulation that starts elsewhere reads its inputs there.
        if (node->type && node->type->simulation && start_frame(graph, {at}) != frame) continue;
        for_sources(*node, [&](const std::string& source) { open.push_back(source); });
    }
}

} // namespace

std::vector<Diagnostic> find_problems(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator,
                                      const std::vector<std::string>& nodes, std::stop_token stop,
                                      const std::shared_ptr<engine::Failures>& failures) {
    const double frame = start_frame(*graph, nodes);
    std::vector<Diagnostic> found;
    // Ends first: where one can be had, so can all that it needs, and each node is looked at once however long the
    // chains are. What fails is then looked at node by node.
    std::set<std::string> sound;
    for (const std::string& name : ends_first(*graph, nodes)) {
        if (sound.contains(name)) continue;
        const engine::Node* node = graph->find(name);
        // The reader has warned of unknown types; they are errors where something needs them.
        if (!node || !node->type || node->type->outputs.empty()) continue;
        try {
            // One output is enough: a node computes all of them at once.
            evaluator.pull({graph, {name, std::string(node->type->outputs.front().name)}, frame, stop, failures});
            add_upstream(*graph, name, frame, sound);
        } catch (const engine::Failure& failure) {
            found.insert(found.end(), failure.diagnostics().begin(), failure.diagnostics().end());
        }
    }
    sort_by_place(found);
    return found;
}

namespace {

/// A literal, as substeps cannot be keyed.
int substeps_of(const engine::Node& solver) {
    const std::string_view attribute = solver.type->simulation->substeps_input;
    const auto given = solver.inputs.find(attribute);
    const auto* value = given == solver.inputs.end() ? nullptr : std::get_if<engine::Value>(&given->second);
    return value && value->is<std::int64_t>() ? static_cast<int>(value->as<std::int64_t>()) : 1;
}

/// Frames after `start` up to `last`, rising: at most `most` of those at which something that the solver reads has a
/// key, and as many others.
std::vector<int> frames_ahead(const engine::Graph& graph, const std::string& solver, int start, int last, int most) {
    std::set<int> out;
    for (const std::string& name : embed::upstream_of(graph, {solver}))
        for (const auto& [attribute, binding] : graph.find(name)->inputs)
            if (const auto* curve = std::get_if<engine::Curve>(&binding))
                for (const engine::Key& key : curve->keys)
                    if (const double frame = std::ceil(key.frame); frame > start && frame <= last)
                        out.insert(static_cast<int>(frame));
    while (out.size() > static_cast<std::size_t>(most)) out.erase(std::prev(out.end()));
    const int count = std::min(most, last - start);
    for (int i = 1; i <= count; ++i) out.insert(start + static_cast<int>(std::int64_t{i} * (last - start) / count));
    return {out.begin(), out.end()};
}

} // namespace

std::vector<Diagnostic> find_later_problems(const std::shared_ptr<const engine::Graph>& graph,
                                            engine::Evaluator& evaluator, int last, int most, std::stop_token stop,
                                            const std::shared_ptr<engine::Failures>& failures) {
    std::vector<Diagnostic> found;
    for (const std::string& solver : simulations(*graph, graph->node_names())) {
        if (simulations(*graph, embed::upstream_of(*graph, {solver})).size() > 1) continue;
        const int start = start_frame(*graph, {solver}), frames = std::max(1, most / substeps_of(*graph->find(solver)));
        try {
            evaluator.rehearse({graph, {solver, ""}, static_cast<double>(start), stop, failures},
                               frames_ahead(*graph, solver, start, last, frames));
        } catch (const engine::Failure& failure) {
            found.insert(found.end(), failure.diagnostics().begin(), failure.diagnostics().end());
        }
    }
    return found;
}

void refuse_unknown_types(std::vector<Diagnostic>& diagnostics) {
    std::set<std::string> unknown;
    for (Diagnostic& d : diagnostics)
        if (d.code == "DG010") {
            d.severity = engine::Severity::error;
            unknown.insert(d.node);
        }
    std::erase_if(diagnostics, [&](const Diagnostic& d) {
        return d.code == "DG101" && unknown.contains(d.node) && d.attribute.empty();
    });
}

void sort_by_place(std::vector<Diagnostic>& diagnostics) {
    std::set<std::string> said;
    std::erase_if(diagnostics, [&](const Diagnostic& d) { return !said.insert(engine::to_json(d)).second; });
    const auto place = [](const Diagnostic& d) {
        // The graph's own file first, then included ones.
        const bool known = d.spot && d.spot->line > 0;
        return std::tuple(known && !d.spot->included_by.empty() ? d.spot->file : std::string(),
                          known ? d.spot->line : INT_MAX, known ? d.spot->column : INT_MAX);
    };
    std::stable_sort(diagnostics.begin(), diagnostics.end(),
                     [&](const Diagnostic& a, const Diagnostic& b) { return place(a) < place(b); });
}

bool has_error(const std::vector<Diagnostic>& diagnostics) {
    return std::any_of(diagnostics.begin(), diagnostics.end(),
                       [](const Diagnostic& d) { return d.severity == engine::Severity::error; });
}

} // namespace sinew::cli
